//! Where the climate keeps its numbers: state and work buffer, cut into rows, for writing and for reading.

use super::books::{Books, LEDGER, Outside};
use super::condenser::{CELLS, Cells, WallFigures, WallStates};
use super::exchanger::{SHOWN, STORES};
use super::medium::{PARTS, Parts};
use super::volume::{Figures, STORED, Start, Stored};
use super::{Climate, ControlLoop, density};
use crate::Network;
use crate::method::common::Cut;

/// State of one loop: sensor, controller, actuator.
pub(super) const LOOP: usize = ControlLoop::STATE;

/// Lengths of the climate's parts of state and work buffer.
pub(crate) fn sizes<E>(network: &Network<'_, E>) -> (usize, usize) {
    let climate = &network.climate;
    if climate.is_none() {
        return (0, 0);
    }
    let (nodes, exchangers) = (climate.volumes.len(), climate.exchangers.len());
    let state = 4 * STORED * nodes
        + exchangers * (4 * CELLS + STORES)
        + 2 * climate.walls.len()
        + LOOP * climate.loops.len()
        + LEDGER * STORED;
    let work =
        nodes * (2 * STORED + PARTS + 6 + 2 + 2) + exchangers * (3 * CELLS + SHOWN) + 2 * network.lines.len();
    (state, work + density::kept(network))
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
    pub(super) coils: &'s mut [WallStates],
    pub(super) stores: &'s mut [[f32; STORES]],
    pub(super) walls: &'s mut [[f32; 2]],
    pub(super) loops: &'s mut [[f32; LOOP]],
    pub(super) outside: Outside<'s>,
}

impl<'s> State<'s> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler may know")]
    pub(super) fn of(climate: &Climate<'_>, buffer: &'s mut [f32]) -> Self {
        let (nodes, exchangers) = (climate.volumes.len(), climate.exchangers.len());
        let cut = &mut Cut(buffer);
        Self {
            value: cut.take_rows(nodes),
            carry: cut.take_rows(nodes),
            owed: cut.take_rows(nodes),
            owed_carry: cut.take_rows(nodes),
            coils: cut.take_rows::<CELLS>(4 * exchangers).as_chunks_mut().0,
            stores: cut.take_rows(exchangers),
            walls: cut.take_rows(climate.walls.len()),
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
    pub(super) coils: &'w mut [WallFigures],
    pub(super) shown: &'w mut [[f32; SHOWN]],
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
        let (nodes, exchangers) = (climate.volumes.len(), climate.exchangers.len());
        let cut = &mut Cut(buffer);
        Self {
            books: Books { net: cut.take_rows(nodes), lost: cut.take_rows(nodes) },
            fractions: cut.take_rows(nodes),
            figures: cut.take_rows(nodes),
            passed: cut.take_rows(nodes),
            coils: cut.take_rows::<CELLS>(3 * exchangers).as_chunks_mut().0,
            shown: cut.take_rows(exchangers),
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
    pub(super) coils: &'o [WallStates],
    pub(super) stores: &'o [[f32; STORES]],
    pub(super) walls: &'o [[f32; 2]],
    pub(super) loops: &'o [[f32; LOOP]],
    pub(super) ledger: &'o [Stored],
    pub(super) fractions: &'o [Parts],
    pub(super) figures: &'o [Figures],
    pub(super) passed: &'o [[f32; 2]],
    pub(super) shown: &'o [[f32; SHOWN]],
}

/// Cuts a buffer for reading; parts that do not fit come out empty.
struct Look<'b>(&'b [f32]);

impl<'b> Look<'b> {
    fn rows<const N: usize>(&mut self, rows: usize) -> &'b [[f32; N]] {
        let (part, rest) = self.0.split_at_checked(rows * N).unwrap_or((&[], &[]));
        self.0 = rest;
        part.as_chunks().0
    }
}

impl<'o> Seen<'o> {
    pub(super) fn of(climate: &Climate<'_>, state: &'o [f32], work: &'o [f32]) -> Self {
        let (nodes, exchangers) = (climate.volumes.len(), climate.exchangers.len());
        let (state, work) = (&mut Look(state), &mut Look(work));
        let (value, carry) = (state.rows(nodes), state.rows(nodes));
        let (owed, owed_carry) = (state.rows(nodes), state.rows(nodes));
        let (coils, stores) = (state.rows::<CELLS>(4 * exchangers).as_chunks().0, state.rows(exchangers));
        let walls = state.rows(climate.walls.len());
        let loops = state.rows(climate.loops.len());
        let ledger = state.rows(LEDGER);
        let _: [&[Stored]; 2] = [work.rows(nodes), work.rows(nodes)];
        let (fractions, figures, passed) = (work.rows(nodes), work.rows(nodes), work.rows(nodes));
        let _: &[Cells] = work.rows(3 * exchangers);
        let shown = work.rows(exchangers);
        Self {
            value,
            carry,
            owed,
            owed_carry,
            coils,
            stores,
            walls,
            loops,
            ledger,
            fractions,
            figures,
            passed,
            shown,
        }
    }
}
