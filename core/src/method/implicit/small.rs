//! The rows that remain behind the branches, where they are few: as one dense block, for a host that works on several
//! columns at once.
//!
//! The same operations in the same order as in [`super::matrix`]; what no pattern holds is 0 here, and adds nothing.

use super::layout::{Work, at};
use super::matrix::{Row, gather};
use crate::{Plan, math};

/// Most rows: two vectors of four columns.
pub(super) const ROWS: usize = 8;

/// Whether the rows behind the branches fit.
#[inline(always)]
#[allow(clippy::inline_always, reason = "two comparisons")]
pub(super) fn fits(plan: &Plan<'_>) -> bool {
    math::VECTORS && plan.order.len().saturating_sub(plan.leaves.len()) <= ROWS
}

/// Eliminates these rows and substitutes from the last to the first.
#[inline(never)] // its loops have the processor's registers for themselves
pub(super) fn solve(plan: &Plan<'_>, work: &mut Work<'_>) {
    let first = plan.leaves.len();
    let rows = plan.order.get(first..).unwrap_or(&[]);
    let mut shares = [[0.0f32; ROWS]; ROWS];
    let mut swept = [[0.0f32; 2]; ROWS];
    for (place, &node) in rows.iter().enumerate().take(ROWS) {
        let mut dense = [0.0f32; ROWS];
        let held = at(work.excess, node);
        let start = Row { held, known: at(work.known, node), diagonal: held };
        let terms = plan.terms_of(node);
        let gathered =
            gather::<false, true>(terms, start, work.ports, work.swept, (&mut dense, first as u32));
        let Row { mut held, mut known, .. } = gathered;
        for ((earlier, theirs), [share, increment]) in shares.iter().enumerate().zip(&swept) {
            if earlier >= place {
                break;
            }
            let exchange = dense[earlier];
            held += exchange * share;
            known += exchange * increment;
            dense = math::each(&dense, theirs, |own, share| own + exchange * share);
        }
        let mut later = [0.0f32; ROWS];
        for (column, (later, own)) in later.iter_mut().zip(&dense).enumerate() {
            *later = if column > place { *own } else { 0.0 };
        }
        let exchanged = later.iter().fold(0.0, |sum, later| sum + later);
        let reciprocal = 1.0 / (held + exchanged);
        if let (Some(shares), Some(swept)) = (shares.get_mut(place), swept.get_mut(place)) {
            *shares = later.map(|later| if later > 0.0 { later * reciprocal } else { 0.0 });
            *swept = [held * reciprocal, known * reciprocal];
        }
    }
    let mut changes = [0.0f32; ROWS];
    let solved = shares.iter().zip(&swept).zip(rows).enumerate();
    for (place, ((shares, [_, increment]), &node)) in solved.rev() {
        let parts = math::each(shares, &changes, |share, change| share * change);
        let sum = parts.iter().fold(*increment, |sum, part| sum + part);
        if let (Some(own), Some(change)) = (changes.get_mut(place), work.change.get_mut(node as usize)) {
            (*own, *change) = (sum, sum);
        }
    }
}
