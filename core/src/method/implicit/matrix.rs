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
        branches(plan, work);
    } else {
        branches_apart(plan, work);
    }
    if plan.leaves.len() < plan.order.len() {
        loops(plan, work);
    }
    if UNROLL {
        back(plan, work);
    } else {
        back_apart(plan, work);
    }
}

/// A function of its own, whose loop then has the processor's registers for itself.
#[inline(never)]
fn branches_apart(plan: &Plan<'_>, work: &mut Work<'_>) {
    branches(plan, work);
}

/// Like [`branches_apart`].
#[inline(never)]
fn back_apart(plan: &Plan<'_>, work: &mut Work<'_>) {
    back(plan, work);
}

/// What a row has before it is reduced: e and r, with the part of neighbours that are branches. Calls `each` with
/// every port's conductance, the row of the neighbour if it is no branch, and what is added to e.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over rows")]
fn gather(
    terms: &[[u32; 3]],
    [mut held, mut known]: [f32; 2],
    ports: &[Port],
    swept: &[[f32; 2]],
    mut each: impl FnMut(f32, u32, f32),
) -> [f32; 2] {
    for &[end, by, row] in terms {
        let [through, flow] = ports.get((end >> 1) as usize).copied().unwrap_or([0.0; 2]);
        let [share, increment] = swept.get(by as usize).copied().unwrap_or([0.0; 2]);
        let theirs = through * share;
        held += theirs;
        known += through * increment + inward(flow, end);
        each(through, row, theirs);
    }
    [held, known]
}

/// Eliminates the nodes that have one neighbour left, or none.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn branches(plan: &Plan<'_>, work: &mut Work<'_>) {
    let (ports, swept) = (&*work.ports, &mut *work.swept);
    for ((&node, &[port, _]), share) in plan.order.iter().zip(plan.leaves).zip(work.onward.iter_mut()) {
        let [onward, _] = ports.get(port as usize).copied().unwrap_or([0.0; 2]);
        let own = at(work.excess, node);
        // Summed beside what is held, so that the division need not wait for one more addition.
        let mut diagonal = own + onward;
        let [held, known] =
            gather(plan.terms_of(node), [own, at(work.known, node)], ports, swept, |_, _, held| {
                diagonal += held;
            });
        let reciprocal = 1.0 / diagonal;
        *share = onward * reciprocal;
        if let Some(swept) = swept.get_mut(node as usize) {
            *swept = [held * reciprocal, known * reciprocal];
        }
    }
}

/// Eliminates the other nodes.
fn loops(plan: &Plan<'_>, work: &mut Work<'_>) {
    for row in plan.leaves.len()..plan.order.len() {
        let Some(&node) = plan.order.get(row) else { continue };
        let (lower, upper) = plan.sides(row);
        let columns = |range: core::ops::Range<usize>| plan.columns.get(range).unwrap_or(&[]);
        for &column in columns(lower.start..upper.end) {
            if let Some(slot) = work.dense.get_mut(column as usize) {
                *slot = 0.0;
            }
        }
        let mut dense = core::mem::take(&mut work.dense);
        let sums = [at(work.excess, node), at(work.known, node)];
        let [mut held, mut known] =
            gather(plan.terms_of(node), sums, work.ports, work.swept, |through, row, _| {
                if let Some(slot) = dense.get_mut(row as usize) {
                    *slot += through;
                }
            });
        for &by in columns(lower) {
            let exchange = at(dense, by);
            let of = plan.order.get(by as usize).copied().unwrap_or(Plan::NOWHERE);
            let Some(&[share, increment]) = work.swept.get(of as usize) else { continue };
            if (by as usize) < plan.leaves.len() {
                continue;
            }
            held += exchange * share;
            known += exchange * increment;
            let (_, theirs) = plan.sides(by as usize);
            let shares = work.entries.get(theirs.clone()).unwrap_or(&[]);
            for (&column, share) in columns(theirs).iter().zip(shares) {
                if let Some(slot) = dense.get_mut(column as usize) {
                    *slot += exchange * share;
                }
            }
        }
        let exchanged: f32 = columns(upper.clone()).iter().map(|&column| at(dense, column)).sum();
        let reciprocal = 1.0 / (held + exchanged);
        let entries = work.entries.get_mut(upper.clone()).unwrap_or(&mut []);
        for (&column, entry) in columns(upper).iter().zip(entries) {
            *entry = at(dense, column) * reciprocal;
        }
        if let Some(swept) = work.swept.get_mut(node as usize) {
            *swept = [held * reciprocal, known * reciprocal];
        }
        work.dense = core::mem::take(&mut dense);
    }
}

/// Substitutes from the last row to the first.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn back(plan: &Plan<'_>, work: &mut Work<'_>) {
    for row in (plan.leaves.len()..plan.order.len()).rev() {
        let Some(&node) = plan.order.get(row) else { continue };
        let (_, upper) = plan.sides(row);
        let shares = work.entries.get(upper.clone()).unwrap_or(&[]);
        let mut sum = work.swept.get(node as usize).map_or(0.0, |[_, increment]| *increment);
        for (&column, share) in plan.columns.get(upper).unwrap_or(&[]).iter().zip(shares) {
            let later = plan.order.get(column as usize).copied().unwrap_or(Plan::NOWHERE);
            sum += share * at(work.change, later);
        }
        if let Some(change) = work.change.get_mut(node as usize) {
            *change = sum;
        }
    }
    let rows = plan.order.iter().zip(plan.leaves).zip(work.onward.iter());
    for ((&node, &[_, later]), share) in rows.rev() {
        let increment = work.swept.get(node as usize).map_or(0.0, |[_, increment]| *increment);
        let value = increment + share * at(work.change, later);
        if let Some(change) = work.change.get_mut(node as usize) {
            *change = value;
        }
    }
}
