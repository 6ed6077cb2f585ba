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
//! Branches of a tree go first: a node with one neighbour left needs no pattern. Nodes with two, the links of loops, follow by
//! records of what they change; the few that have more are left for the end.

use super::layout::{Port, Work, at};
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
        collect::<true>(plan, work);
        series::<true>(plan, work);
        core::<true>(plan, work);
        back_of_core::<true>(plan, work);
        back_of_series::<true>(plan, work);
        back_of_branches::<true>(plan, work);
        return;
    }
    branches_apart(plan, work);
    if plan.leaves.len() < plan.order.len() {
        loops_apart(plan, work);
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
fn loops_apart(plan: &Plan<'_>, work: &mut Work<'_>) {
    collect::<false>(plan, work);
    series::<false>(plan, work);
    if first_core(plan) < plan.order.len() {
        core_apart(plan, work);
    }
    back_of_series::<false>(plan, work);
}

/// Like [`branches_apart`].
#[inline(never)]
fn core_apart(plan: &Plan<'_>, work: &mut Work<'_>) {
    core::<false>(plan, work);
    back_of_core::<false>(plan, work);
}

/// First row with more than two later neighbours.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one addition")]
fn first_core(plan: &Plan<'_>) -> usize {
    plan.leaves.len() + plan.series.len()
}

/// Sums of a row before it is reduced: e, r and the diagonal, which begins with what is passed on.
#[derive(Clone, Copy)]
struct Row {
    held: f32,
    known: f32,
    /// Summed beside what is held, so that the division need not wait for one more addition.
    diagonal: f32,
}

/// Adds to a row what its lines bring, with the part of neighbours that are held or were eliminated as branches.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over rows")]
fn gather<const UNROLL: bool>(terms: &[[u32; 3]], mut row: Row, ports: &[Port], swept: &[[f32; 2]]) -> Row {
    every!(few UNROLL, terms.iter(), &[end, by, _] => {
        let [through, flow] = ports.get((end >> 1) as usize).copied().unwrap_or([0.0; 2]);
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
        let row = gather::<UNROLL>(plan.terms_of(node), start, ports, swept);
        let reciprocal = 1.0 / row.diagonal;
        *share = onward * reciprocal;
        if let Some(swept) = swept.get_mut(node as usize) {
            *swept = [row.held * reciprocal, row.known * reciprocal];
        }
    });
}

/// Sums of all other rows, by their nodes: what they hold and know, and what they exchange with one another.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn collect<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    work.entries.fill(0.0);
    let ports = &*work.ports;
    let first = plan.leaves.len() as u32;
    let sums = work.excess.iter().zip(work.known.iter());
    every!(UNROLL, plan.row_of.iter().zip(sums).enumerate(), (node, (&row, (held, known))) => {
        if row >= first && row != Plan::NOWHERE {
            let (mut held, mut known) = (*held, *known);
            every!(few UNROLL, plan.terms_of(node as u32).iter(), &[end, by, entry] => {
                let [through, flow] = ports.get((end >> 1) as usize).copied().unwrap_or([0.0; 2]);
                known += inward(flow, end);
                if let Some(exchange) = work.entries.get_mut(entry as usize) {
                    *exchange += through;
                } else {
                    // Held, or eliminated as a branch.
                    let [share, increment] = work.swept.get(by as usize).copied().unwrap_or([0.0; 2]);
                    held += through * share;
                    known += through * increment;
                }
            });
            if let Some(swept) = work.swept.get_mut(node) {
                *swept = [held, known];
            }
        }
    });
}

/// Eliminates the rows that have two later neighbours at most, and adds to these what they leave.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn series<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    let (swept, entries) = (&mut *work.swept, &mut *work.entries);
    let rows = plan.series.iter().zip(work.shares.iter_mut());
    every!(UNROLL, rows, (&[node, own_a, own_b, of_a, of_b, a_b, b_a, a, b], shares) => {
        let [held, known] = swept.get(node as usize).copied().unwrap_or([0.0; 2]);
        let (to_a, to_b) = (at(entries, own_a), at(entries, own_b));
        let reciprocal = 1.0 / (held + (to_a + to_b));
        let (share, increment) = (held * reciprocal, known * reciprocal);
        let (onto_a, onto_b) = (to_a * reciprocal, to_b * reciprocal);
        *shares = [increment, onto_a, onto_b];
        let (from_a, from_b) = (at(entries, of_a), at(entries, of_b));
        if let Some([held, known]) = swept.get_mut(a as usize) {
            *held += from_a * share;
            *known += from_a * increment;
        }
        if let Some([held, known]) = swept.get_mut(b as usize) {
            *held += from_b * share;
            *known += from_b * increment;
        }
        if let Some(exchange) = entries.get_mut(a_b as usize) {
            *exchange += from_a * onto_b;
        }
        if let Some(exchange) = entries.get_mut(b_a as usize) {
            *exchange += from_b * onto_a;
        }
    });
}

/// Sets an entry.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one store")]
fn put(values: &mut [f32], index: u32, value: f32) {
    if let Some(slot) = values.get_mut(index as usize) {
        *slot = value;
    }
}

/// Eliminates the rows that are left.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn core<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    every!(UNROLL, first_core(plan)..plan.order.len(), row => {
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
    let (lower, upper) = plan.sides(row);
    let (dense, entries) = (&mut *work.dense, &mut *work.entries);
    let own = entries.get(lower.start..upper.end).unwrap_or(&[]);
    every!(few UNROLL, columns(plan, lower.start..upper.end).iter().zip(own), (&column, exchange) => {
        put(dense, column, *exchange);
    });
    let node = at_node(plan, row);
    let [mut held, mut known] = work.swept.get(node as usize).copied().unwrap_or([0.0; 2]);
    every!(few UNROLL, columns(plan, lower).iter(), &by => {
        // Earlier rows have passed their streams on already.
        if let (Some(&[share, increment]), true) =
            (work.swept.get(at_node(plan, by as usize) as usize), by as usize >= first_core(plan))
        {
            let exchange = at(dense, by);
            held += exchange * share;
            known += exchange * increment;
            let (_, theirs) = plan.sides(by as usize);
            let shares = entries.get(theirs.clone()).unwrap_or(&[]);
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
    let shares = entries.get_mut(upper.clone()).unwrap_or(&mut []);
    every!(few UNROLL, columns(plan, upper).iter().zip(shares), (&column, share) => {
        *share = at(dense, column) * reciprocal;
    });
    if let Some(swept) = work.swept.get_mut(node as usize) {
        *swept = [held * reciprocal, known * reciprocal];
    }
}

/// Substitutes from the last row to the first that has more than two later neighbours.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn back_of_core<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    every!(UNROLL, (first_core(plan)..plan.order.len()).rev(), row => {
        let (_, upper) = plan.sides(row);
        let shares = work.entries.get(upper.clone()).unwrap_or(&[]);
        let node = at_node(plan, row);
        let mut sum = work.swept.get(node as usize).map_or(0.0, |[_, increment]| *increment);
        every!(few UNROLL, columns(plan, upper).iter().zip(shares), (&column, share) => {
            sum += share * at(work.change, at_node(plan, column as usize));
        });
        put(work.change, node, sum);
    });
}

/// Node of a row.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one load")]
fn at_node(plan: &Plan<'_>, row: usize) -> u32 {
    plan.order.get(row).copied().unwrap_or(Plan::NOWHERE)
}

/// Substitutes in the rows with two later neighbours.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn back_of_series<const UNROLL: bool>(plan: &Plan<'_>, work: &mut Work<'_>) {
    let change = &mut *work.change;
    let rows = plan.series.iter().zip(work.shares.iter()).rev();
    every!(UNROLL, rows, (&[node, _, _, _, _, _, _, a, b], &[increment, onto_a, onto_b]) => {
        let sum = increment + (onto_a * at(change, a) + onto_b * at(change, b));
        put(change, node, sum);
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
