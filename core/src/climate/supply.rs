//! Transfers into volumes before the flows of a step are solved: components that supply, and free water.

use super::Climate;
use super::buffers::Running;
use super::step::Stepped;
use super::volume::{self, Contents};
use crate::component::{Block, Volumes};
use crate::fluid::books::{Accounts, Books, Outside};
use crate::fluid::medium::{GAS_CONSTANTS_J_KG_K, LIQUID, Parts, VAPOUR, dot};
use crate::fluid::stream::Stored;
use crate::{Network, NodeKind};

/// Lets the components that supply act on their volumes, and free water evaporate or fog condense. All of it follows
/// from the state of the volumes at the end of the last step; masses from outside have the temperature of their volume.
pub(crate) fn supply<E>(network: &Network<'_, E>, at: Stepped<'_>, running: &mut Running<'_>) {
    let climate = &network.climate;
    let Running { state, work } = running;
    let step = climate.context(at.step_s, at.inputs);
    let volumes = Volumes { figures: work.figures, fractions: work.fractions };
    let Books { net, lost } = &mut work.books;
    let mut accounts = Accounts::new(Books { net, lost }, Outside(state.outside.0));
    for table in climate.tables {
        let kind = table.kind();
        if let [true, _] = kind.acts() {
            let blocks = own_blocks(table, state.components, work.scratch);
            kind.supply(climate.placed_of(table), &step, volumes, blocks, &mut accounts);
        }
    }
    accounts.close();
    for (node, volume) in climate.volumes.iter().enumerate() {
        let held = network.nodes.get(node).is_some_and(|node| node.kind == NodeKind::Boundary);
        let wets = volume.contents == Contents::Air && !held;
        if let (true, Some(figures), Some(fractions)) =
            (wets, work.figures.get(node), work.fractions.get(node))
        {
            let vapour = volume::evaporated_kg(
                volume,
                figures,
                fractions,
                &climate.air,
                climate.reference_k,
                at.step_s,
            );
            work.books.add(node, [VAPOUR, LIQUID], [vapour, -vapour]);
        }
    }
}

/// State and scratch of a table's components.
#[inline]
pub(super) fn own_blocks<'b>(
    table: &crate::component::Table,
    state: &'b mut [f32],
    scratch: &'b mut [f32],
) -> Block<'b> {
    let state = state.get_mut(table.range.state()).unwrap_or_default();
    Block { state, scratch: scratch.get_mut(table.range.scratch()).unwrap_or_default() }
}

/// What a step has brought into all volumes; nothing without a climate.
#[derive(Clone, Copy, Default)]
pub(crate) struct Supplied<'s> {
    masses: &'s [Stored],
    fractions: &'s [Parts],
}

impl<'s> Supplied<'s> {
    pub(crate) fn of(running: &'s Running<'_>) -> Self {
        Self { masses: running.work.books.net, fractions: running.work.fractions }
    }

    /// As a flow into every volume [kg/s] of what it holds: so much of that would raise the pressure alike, Σ ṁᵢ·Rᵢ/R.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn flows_kg_s(self, climate: &Climate<'_>, step_s: f32) -> impl Iterator<Item = f32> {
        let per_step = 1.0 / step_s;
        let rows = self.masses.iter().zip(self.fractions).zip(climate.volumes);
        rows.map(move |((&[nitrogen, oxygen, carbon_dioxide, vapour, trace, ..], fractions), volume)| {
            let mass = match volume.contents {
                Contents::Air => {
                    let gases = [nitrogen, oxygen, carbon_dioxide, vapour, trace, 0.0];
                    dot(&gases, &GAS_CONSTANTS_J_KG_K) / dot(fractions, &GAS_CONSTANTS_J_KG_K)
                }
                Contents::Coolant => nitrogen,
            };
            mass * per_step
        })
    }
}
