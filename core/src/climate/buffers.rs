//! Where the climate keeps its numbers: state and work buffer, cut into rows, for writing and for reading.

use super::volume::{Figures, Start};
use super::{Climate, ControlLoop, density};
use crate::Network;
use crate::component::Range;
use crate::fluid::books::{Books, LEDGER, Outside};
use crate::fluid::{PARTS, Parts, STORED, Stored};
use crate::method::common::Cut;

/// State of one loop: sensor, controller, actuator.
pub(super) const LOOP: usize = ControlLoop::STATE;

/// Lengths of the climate's parts of state and work buffer.
pub(crate) fn sizes<E>(network: &Network<'_, E>) -> (usize, usize) {
    let climate = &network.climate;
    if climate.is_none() {
        return (0, 0);
    }
    let (nodes, [own_state, own_scratch]) = (climate.volumes.len(), blocks(climate));
    let state = 4 * STORED * nodes + own_state + LOOP * climate.loops.len() + LEDGER * STORED;
    let work = nodes * (2 * STORED + PARTS + 6 + 2 + 2) + own_scratch + 2 * network.lines.len();
    (state, work + density::kept(network))
}

/// Lengths of state and scratch of all placed components.
fn blocks(climate: &Climate<'_>) -> [usize; 2] {
    let last = climate.tables.last().map_or(Range::default(), |table| table.range);
    [last.state().end, last.scratch().end]
}

/// State and work buffer of a climate, cut for one step.
pub(crate) struct Running<'p> {
    pub(super) state: State<'p>,
    pub(super) work: Work<'p>,
}

impl<'p> Running<'p> {
    /// Cuts the buffers; `None` for a network without a climate.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler may know")]
    pub(crate) fn of<E>(network: &Network<'_, E>, state: &'p mut [f32], work: &'p mut [f32]) -> Option<Self> {
        let climate = &network.climate;
        if climate.is_none() {
            return None;
        }
        Some(Self { state: State::of(climate, state), work: Work::of(network, work) })
    }

    /// Virtual temperatures of all nodes [K]; none where no line asks.
    pub(crate) fn virtual_k(&self) -> &[f32] {
        self.work.virtual_k
    }
}

/// The climate's part of the state.
pub(super) struct State<'s> {
    pub(super) value: &'s mut [Stored],
    pub(super) carry: &'s mut [Stored],
    pub(super) owed: &'s mut [Stored],
    pub(super) owed_carry: &'s mut [Stored],
    /// Of all placed components.
    pub(super) components: &'s mut [f32],
    pub(super) loops: &'s mut [[f32; LOOP]],
    pub(super) outside: Outside<'s>,
}

impl<'s> State<'s> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler may know")]
    pub(super) fn of(climate: &Climate<'_>, buffer: &'s mut [f32]) -> Self {
        let (nodes, [own, _]) = (climate.volumes.len(), blocks(climate));
        let cut = &mut Cut(buffer);
        Self {
            value: cut.take_rows(nodes),
            carry: cut.take_rows(nodes),
            owed: cut.take_rows(nodes),
            owed_carry: cut.take_rows(nodes),
            components: cut.take(own),
            loops: cut.take_rows(climate.loops.len()),
            outside: Outside(cut.take_rows(LEDGER)),
        }
    }
}

/// What a step derives anew.
pub(super) struct Work<'w> {
    pub(super) books: Books<'w>,
    pub(super) fractions: &'w mut [Parts],
    pub(super) figures: &'w mut [Figures],
    /// Mass that came in and went out in the last step [kg].
    pub(super) passed: &'w mut [[f32; 2]],
    /// Of all placed components.
    pub(super) scratch: &'w mut [f32],
    /// What every line had given before this step, and its carry [kg].
    pub(super) given: &'w mut [[f32; 2]],
    pub(super) start: &'w mut [Start],
    /// Virtual temperature of every node [K], see [`density`]; none where no line asks.
    pub(super) virtual_k: &'w mut [f32],
}

impl<'w> Work<'w> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler may know")]
    pub(super) fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let climate = &network.climate;
        let (nodes, [_, own]) = (climate.volumes.len(), blocks(climate));
        let cut = &mut Cut(buffer);
        Self {
            books: Books { net: cut.take_rows(nodes), lost: cut.take_rows(nodes) },
            fractions: cut.take_rows(nodes),
            figures: cut.take_rows(nodes),
            passed: cut.take_rows(nodes),
            scratch: cut.take(own),
            given: cut.take_rows(network.lines.len()),
            start: cut.take_rows(nodes),
            virtual_k: cut.take(density::kept(network)),
        }
    }
}

/// The same rows, read only.
pub(super) struct Seen<'o> {
    pub(super) value: &'o [Stored],
    pub(super) carry: &'o [Stored],
    pub(super) owed: &'o [Stored],
    pub(super) owed_carry: &'o [Stored],
    pub(super) components: &'o [f32],
    pub(super) loops: &'o [[f32; LOOP]],
    pub(super) ledger: &'o [Stored],
    pub(super) fractions: &'o [Parts],
    pub(super) figures: &'o [Figures],
    pub(super) passed: &'o [[f32; 2]],
    pub(super) scratch: &'o [f32],
}

/// Cuts a buffer for reading; parts that do not fit come out empty.
struct Look<'b>(&'b [f32]);

impl<'b> Look<'b> {
    fn words(&mut self, length: usize) -> &'b [f32] {
        let (part, rest) = self.0.split_at_checked(length).unwrap_or((&[], &[]));
        self.0 = rest;
        part
    }

    fn rows<const N: usize>(&mut self, rows: usize) -> &'b [[f32; N]] {
        self.words(rows * N).as_chunks().0
    }
}

impl<'o> Seen<'o> {
    pub(super) fn of(climate: &Climate<'_>, state: &'o [f32], work: &'o [f32]) -> Self {
        let (nodes, [own_state, own_scratch]) = (climate.volumes.len(), blocks(climate));
        let (state, work) = (&mut Look(state), &mut Look(work));
        let (value, carry) = (state.rows(nodes), state.rows(nodes));
        let (owed, owed_carry) = (state.rows(nodes), state.rows(nodes));
        let components = state.words(own_state);
        let loops = state.rows(climate.loops.len());
        let ledger = state.rows(LEDGER);
        let _: [&[Stored]; 2] = [work.rows(nodes), work.rows(nodes)];
        let (fractions, figures, passed) = (work.rows(nodes), work.rows(nodes), work.rows(nodes));
        let scratch = work.words(own_scratch);
        Self {
            value,
            carry,
            owed,
            owed_carry,
            components,
            loops,
            ledger,
            fractions,
            figures,
            passed,
            scratch,
        }
    }
}
