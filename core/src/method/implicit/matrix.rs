//! Elimination of the nodes on a pattern that was fixed when the network was built.
//!
//! Every row is the balance of a node: what it holds, e, and what it exchanges, a ≥ 0, with others,
//!
//! ```text
//! (e + Σa)·c − Σ a·c_other = r
//! ```
//!
//! Eliminating a neighbour k of share `z_k = e_k/d_k` and increment `y_k` adds `a·z_k` to e, `a·y_k` to r and a·u to the
//! exchange with each later neighbour of k. The diagonal d = e + Σa is summed anew from what is left, so that nothing
//! is ever subtracted and every figure keeps its relative precision (Grassmann, Taksar and Heyman 1985, for chains
//! of states). There is no pivoting: the pattern decides the sequence of operations, the values do not.
//!
//! Branches of a tree go first: a node with one neighbour left needs no pattern. What has loops follows.

use super::layout::{Port, Work, at};
use super::small;
use crate::unroll::every;
use crate::{Network, Plan};

/// Turns the sign of what leaves at a line's inlet, the even ends.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one operation")]
pub(crate) fn inward(value: f32, end: u32) -> f32 {
    f32::from_bits(value.to_bits() ^ ((!end & 1) << 31))
}

/// Factorises and solves: afterwards `change` holds the corrections of all nodes.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn solve<E, const UNROLL: bool>(network: &Network<'_, E>, work: &mut Work<'_>) {
    let plan = &network.plan;
    if UNROLL {
        branches::<true>(plan, work);
    } else {
        branches_apart(plan, work);
    }
    if UNROLL {
        loops::<true>(plan, work);
        back_of_loops::<true>(plan, work);
        back_of_branches::<true>(plan, work);
        return;
    }
    if plan.leaves.len() < plan.order.len() {
        if small::fits(plan) {
            small::solve(plan, work);
        } else {
            loops_apart(plan, work);
        }
    }
    back_of_branches_apart(plan, work);
}

/// A function of its own, whose loop then has the processor's registers for itself.
#[inline(never)]
fn branches_apart(plan: &Plan<'_>, work: &mut Work<'_>) {
    branches::<false>(plan, work);
}

/// Like [`branches_apart`].
#[inline(never)]
fn back_of_branches_apart(plan: &Plan<'_>, work: &mut Work<'_>) {
    back_of_branches::<false>(plan, work);
}

/// Like [`branches_apart`].
#[inline(never)]
pub(super) fn loops_apart(plan: &Plan<'_>, work: &mut Work<'_>) {
    loops::<false>(plan, work);
    back_of_loops::<false>(plan, work);
}

/// Sums of a row before it is reduced: e, r and the diagonal, which begins with what is passed on.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) held: f32,
    pub(super) known: f32,
    /// Summed beside what is held, so that the division need not wait for one more addition.
    pub(super) diagonal: f32,
}

/// Adds to a row what its lines bring, with the part of neighbours that were eliminated as branches, and to the dense
/// row, whose first column is given, what they exchange with all others.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over rows")]
pub(super) fn gather<const UNROLL: bool, const LOOPS: bool>(
    terms: &[[u32; 3]],
    mut row: Row,
    ports: &[Port],
    swept: &[[f32; 2]],
    (dense, first): (&mut [f32], u32),
) -> Row {
    every!(few UNROLL, terms.iter(), &[end, by, other] => {
        let [through, flow] = ports.get((end >> 1) as usize).copied().unwrap_or([0.0; 2]);
        if LOOPS && let Some(slot) = dense.get_mut(other.wrapping_sub(first) as usize) {
            *slot += through;
        }
        let [share, increment] = swept.get(by as usize).copied().unwrap_or([0.0; 2]);
        let theirs = through * share;
        row.held += theirs;
        row.diagonal += theirs;
        row.known += through * increment + inward(flow, end);
    });
    row
}

/// Eliminates the nodes that have one neighbour left, or none.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn branches<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    let (ports, swept) = (&*work.ports, &mut *work.swept);
    let leaves = plan.order.iter().zip(plan.leaves).zip(work.onward.iter_mut());
    every!(UNROLL, leaves, ((&node, &[port, _]), share) => {
        let [onward, _] = ports.get(port as usize).copied().unwrap_or([0.0; 2]);
        let held = at(work.excess, node);
        let start = Row { held, known: at(work.known, node), diagonal: held + onward };
        let row = gather::<UNROLL, false>(plan.terms_of(node), start, ports, swept, (&mut [], 0));
        let reciprocal = 1.0 / row.diagonal;
        *share = onward * reciprocal;
        if let Some(swept) = swept.get_mut(node as usize) {
            *swept = [row.held * reciprocal, row.known * reciprocal];
        }
    });
}

/// Eliminates the other nodes.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn loops<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    every!(UNROLL, plan.leaves.len()..plan.order.len(), row => {
        eliminate::<UNROLL>(plan, row, work);
    });
}

/// Columns of these entries.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over rows")]
fn columns<'p>(plan: &Plan<'p>, range: core::ops::Range<usize>) -> &'p [u32] {
    plan.columns.get(range).unwrap_or(&[])
}

/// Eliminates one row.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over rows")]
fn eliminate<const UNROLL: bool>(plan: &Plan<'_>, row: usize, work: &mut Work<'_>) {
    let Some(&node) = plan.order.get(row) else { return };
    let (lower, upper) = plan.sides(row);
    let dense = &mut *work.dense;
    every!(few UNROLL, columns(plan, lower.start..upper.end).iter(), &column => {
        if let Some(slot) = dense.get_mut(column as usize) {
            *slot = 0.0;
        }
    });
    let held = at(work.excess, node);
    let start = Row { held, known: at(work.known, node), diagonal: held };
    let terms = plan.terms_of(node);
    let Row { mut held, mut known, .. } =
        gather::<UNROLL, true>(terms, start, work.ports, work.swept, (dense, 0));
    every!(few UNROLL, columns(plan, lower).iter(), &by => {
        let of = plan.order.get(by as usize).copied().unwrap_or(Plan::NOWHERE);
        // What branches pass on was gathered.
        if let (Some(&[share, increment]), true) =
            (work.swept.get(of as usize), by as usize >= plan.leaves.len())
        {
            let exchange = at(dense, by);
            held += exchange * share;
            known += exchange * increment;
            let (_, theirs) = plan.sides(by as usize);
            let shares = work.entries.get(theirs.clone()).unwrap_or(&[]);
            every!(few UNROLL, columns(plan, theirs).iter().zip(shares), (&column, share) => {
                if let Some(slot) = dense.get_mut(column as usize) {
                    *slot += exchange * share;
                }
            });
        }
    });
    let mut exchanged = 0.0;
    every!(few UNROLL, columns(plan, upper.clone()).iter(), &column => {
        exchanged += at(dense, column);
    });
    let reciprocal = 1.0 / (held + exchanged);
    let entries = work.entries.get_mut(upper.clone()).unwrap_or(&mut []);
    every!(few UNROLL, columns(plan, upper).iter().zip(entries), (&column, entry) => {
        *entry = at(dense, column) * reciprocal;
    });
    if let Some(row) = work.swept.get_mut(node as usize) {
        *row = [held * reciprocal, known * reciprocal];
    }
}

/// Substitutes from the last row to the first that no branch eliminated.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn back_of_loops<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    every!(UNROLL, (plan.leaves.len()..plan.order.len()).rev(), row => {
        let node = plan.order.get(row).copied().unwrap_or(Plan::NOWHERE);
        let (_, upper) = plan.sides(row);
        let shares = work.entries.get(upper.clone()).unwrap_or(&[]);
        let mut sum = work.swept.get(node as usize).map_or(0.0, |[_, increment]| *increment);
        every!(few UNROLL, columns(plan, upper).iter().zip(shares), (&column, share) => {
            let later = plan.order.get(column as usize).copied().unwrap_or(Plan::NOWHERE);
            sum += share * at(work.change, later);
        });
        if let Some(change) = work.change.get_mut(node as usize) {
            *change = sum;
        }
    });
}

/// Substitutes from the last branch to the first.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn back_of_branches<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    let rows = plan.order.iter().zip(plan.leaves).zip(work.onward.iter());
    every!(UNROLL, rows.rev(), ((&node, &[_, later]), share) => {
        let increment = work.swept.get(node as usize).map_or(0.0, |[_, increment]| *increment);
        let value = increment + share * at(work.change, later);
        if let Some(change) = work.change.get_mut(node as usize) {
            *change = value;
        }
    });
}
