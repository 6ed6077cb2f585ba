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
    let mut dense = [[0.0f32; ROWS]; ROWS];
    // What a row holds and what it knows, side by side.
    let mut own = [[0.0f32; 2]; ROWS];
    for ((dense, own), &node) in dense.iter_mut().zip(&mut own).zip(rows) {
        let held = at(work.excess, node);
        let start = Row { held, known: at(work.known, node), diagonal: held };
        let terms = plan.terms_of(node);
        let gathered = gather::<false, true>(terms, start, work.ports, work.swept, (dense, first as u32));
        *own = [gathered.held, gathered.known];
    }
    // A row that is done goes into all later ones at once: none of these waits for another.
    let mut rest = (dense.as_mut_slice(), own.as_mut_slice());
    for place in 0..rows.len() {
        let (Some((dense, later_rows)), Some((own, later_own))) =
            (rest.0.split_first_mut(), rest.1.split_first_mut())
        else {
            break;
        };
        if let Some(done) = dense.get_mut(..=place) {
            done.fill(0.0);
        }
        let exchanged =
            dense.get(place + 1..rows.len()).unwrap_or(&[]).iter().fold(0.0, |sum, later| sum + later);
        let [held, known] = *own;
        let reciprocal = 1.0 / (held + exchanged);
        *dense = dense.map(|later| if later > 0.0 { later * reciprocal } else { 0.0 });
        *own = [held * reciprocal, known * reciprocal];
        let behind = rows.len() - place - 1;
        for (row, sums) in later_rows.iter_mut().zip(later_own.iter_mut()).take(behind) {
            let exchange = row.get(place).copied().unwrap_or(0.0);
            *sums = math::each(sums, own, |sum, own| sum + exchange * own);
            *row = math::each(row, dense, |own, share| own + exchange * share);
        }
        rest = (later_rows, later_own);
    }
    let mut changes = [0.0f32; ROWS];
    for (place, ((shares, [_, increment]), &node)) in dense.iter().zip(&own).zip(rows).enumerate().rev() {
        let parts = math::each(shares, &changes, |share, change| share * change);
        let behind = parts.get(place + 1..rows.len()).unwrap_or(&[]);
        let sum = behind.iter().fold(*increment, |sum, part| sum + part);
        if let (Some(own), Some(change)) = (changes.get_mut(place), work.change.get_mut(node as usize)) {
            (*own, *change) = (sum, sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::climate::Climate;
    use crate::element::{Pipe, StdElement};
    use crate::method::implicit::matrix;
    use crate::{Line, Network, Node, NodeKind, Segment};

    const NODES: usize = 5;
    /// Two loops over one node, so that some pairs exchange nothing: the triangles 0-1-4 and 2-3-4.
    const LINES: [[u32; 2]; 6] = [[0, 1], [1, 4], [4, 0], [2, 3], [3, 4], [4, 2]];

    /// Columns of the rows with themselves; nothing fills in.
    const PATTERN: [&[u32]; NODES] = [&[0, 1, 4], &[0, 1, 4], &[2, 3, 4], &[2, 3, 4], &[0, 1, 2, 3, 4]];

    #[test]
    fn a_dense_block_has_the_bits_of_the_pattern() {
        let node =
            Node { kind: NodeKind::Cabin { volume_m3: 1.0 }, start_gauge_pa: 0.0, temperature_k: 295.15 };
        let (mut columns, mut row_start, mut diagonal) = (std::vec![], std::vec![0u32], std::vec![]);
        for (row, pattern) in (0u32..).zip(PATTERN) {
            let place = pattern.iter().position(|&column| column == row).unwrap() as u32;
            diagonal.push(columns.len() as u32 + place);
            columns.extend_from_slice(pattern);
            row_start.push(columns.len() as u32);
        }
        let (mut ends, mut end_start, mut terms) = (std::vec![], std::vec![0u32], std::vec![]);
        for node in 0..NODES as u32 {
            for (line, [from, to]) in (0u32..).zip(LINES) {
                if from == node || to == node {
                    let end = 2 * line + u32::from(to == node);
                    ends.push(end);
                    terms.push([end, NODES as u32, if from == node { to } else { from }]);
                }
            }
            end_start.push(ends.len() as u32);
        }
        let lines = LINES.map(|[from, to]| Line {
            from,
            to,
            first_segment: 0,
            segments: 1,
            flow_segment: 0,
            laminar_below_pa: 1e-3,
            start_flow_kg_s: 0.0,
        });
        let pipe = StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 1.0 });
        let segment = Segment { element: pipe, inertance_per_m: 1.0, outlet_volume_m3: 0.0, first_input: 0 };
        let order: [u32; NODES] = core::array::from_fn(|index| index as u32);
        let plan = Plan {
            end_start: &end_start,
            ends: &ends,
            order: &order,
            row_start: &row_start,
            columns: &columns,
            diagonal: &diagonal,
            row_of: &order,
            terms: &terms,
            ..Plan::EMPTY
        };
        let network = Network {
            reference_pa: 0.0,
            nodes: &[node; NODES],
            lines: &lines,
            segments: &[segment; LINES.len()],
            active: &[],
            responsive: &[],
            inputs: &[],
            schedules: &[],
            points: &[],
            plan,
            climate: Climate::NONE,
        };
        let mut seed = 7u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        for _ in 0..1_000 {
            let mut filled = std::vec![0.0f32; 1_000];
            let work = Work::of(&network, &mut filled);
            for port in work.ports.iter_mut() {
                // Conductances over ten powers of ten.
                *port = [math::exp(23.0 * random() - 23.0), random() - 0.5];
            }
            for (excess, known) in work.excess.iter_mut().zip(work.known.iter_mut()) {
                (*excess, *known) = (math::exp(23.0 * random() - 23.0), random() - 0.5);
            }
            let mut other = filled.clone();
            solve(&network.plan, &mut Work::of(&network, &mut filled));
            matrix::loops_apart(&network.plan, &mut Work::of(&network, &mut other));
            let bits = |buffer: &mut [f32]| {
                let change = &Work::of(&network, buffer).change;
                core::array::from_fn::<u32, NODES, _>(|node| change[node].to_bits())
            };
            let (dense, sparse) = (bits(&mut filled), bits(&mut other));
            assert_eq!(dense, sparse);
            assert!(dense.iter().all(|bits| f32::from_bits(*bits).is_finite() && *bits != 0));
        }
    }
}
