//! The rows that remain behind the branches, where they are few: as one dense block, for a host that works on several
//! columns at once.
//!
//! The same operations in the same order as in [`super::matrix`]; what no pattern holds is 0 here, and adds nothing. The
//! same bits therefore as long as all numbers are finite; a step that leaves them ends the run either way.

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

/// The rows: what they exchange with all others, and beside it what they hold and what they know.
struct Block<'b> {
    exchanges: &'b mut [[f32; ROWS]; ROWS],
    own: &'b mut [[f32; 2]; ROWS],
    /// How many there are.
    rows: usize,
}

/// Eliminates these rows and substitutes from the last to the first.
#[inline(never)] // its loops have the processor's registers for themselves
pub(super) fn solve(plan: &Plan<'_>, work: &mut Work<'_>) {
    let first = plan.leaves.len();
    let rows = plan.order.get(first..).unwrap_or(&[]);
    let (mut exchanges, mut own) = ([[0.0; ROWS]; ROWS], [[0.0; 2]; ROWS]);
    let mut block = Block { exchanges: &mut exchanges, own: &mut own, rows: rows.len() };
    for ((exchanges, own), &node) in block.exchanges.iter_mut().zip(block.own.iter_mut()).zip(rows) {
        let held = at(work.excess, node);
        let start = Row { held, known: at(work.known, node), diagonal: held };
        let terms = plan.terms_of(node);
        let gathered = gather::<false, true>(terms, start, work.ports, work.swept, (exchanges, first as u32));
        *own = [gathered.held, gathered.known];
    }
    // Each by itself, so that the compiler knows its place.
    block.eliminate::<0>();
    block.eliminate::<1>();
    block.eliminate::<2>();
    block.eliminate::<3>();
    block.eliminate::<4>();
    block.eliminate::<5>();
    block.eliminate::<6>();
    block.eliminate::<7>();
    block.substitute::<7>();
    block.substitute::<6>();
    block.substitute::<5>();
    block.substitute::<4>();
    block.substitute::<3>();
    block.substitute::<2>();
    block.substitute::<1>();
    block.substitute::<0>();
    for ([_, increment], &node) in block.own.iter().zip(rows) {
        if let Some(change) = work.change.get_mut(node as usize) {
            *change = *increment;
        }
    }
}

impl Block<'_> {
    /// Eliminates the row at `PLACE`: it goes into all later ones at once, none of which waits for another. What stands
    /// in the columns before is never read again.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "its loops are known only here")]
    fn eliminate<const PLACE: usize>(&mut self) {
        if PLACE >= self.rows {
            return;
        }
        let mut exchanged = 0.0;
        for later in &self.exchanges[PLACE][PLACE + 1..] {
            exchanged += later;
        }
        let [held, known] = self.own[PLACE];
        let reciprocal = 1.0 / (held + exchanged);
        let shares = self.exchanges[PLACE].map(|later| if later > 0.0 { later * reciprocal } else { 0.0 });
        let own = [held * reciprocal, known * reciprocal];
        (self.exchanges[PLACE], self.own[PLACE]) = (shares, own);
        for place in PLACE + 1..ROWS {
            let exchange = self.exchanges[place][PLACE];
            // What exchanges nothing adds nothing; loops that do not touch each other are then solved side by side.
            if exchange != 0.0 {
                self.own[place] = math::each(&self.own[place], &own, |sum, own| sum + exchange * own);
                self.exchanges[place] =
                    math::each(&self.exchanges[place], &shares, |own, share| own + exchange * share);
            }
        }
    }

    /// Adds to the increment of the row at `PLACE` what those of later rows make of it.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "its loop is known only here")]
    fn substitute<const PLACE: usize>(&mut self) {
        let mut sum = self.own[PLACE][1];
        for later in PLACE + 1..ROWS {
            let share = self.exchanges[PLACE][later];
            if share != 0.0 {
                sum += share * self.own[later][1];
            }
        }
        self.own[PLACE][1] = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::climate::Climate;
    use crate::components::Pipe;
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
        let pipe = Pipe::new(1.0).into_any();
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
                // Conductances over ten powers of ten, and some that let nothing pass.
                let through = if random() < 0.2 { 0.0 } else { math::exp(23.0 * random() - 23.0) };
                *port = [through, random() - 0.5];
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
