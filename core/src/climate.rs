//! Heat, moisture, gas composition and control on top of a network's flows.
//!
//! The flow method yields one mean flow per line and step; one conservative update moves masses and energy with it.
//! What leaves one volume enters the next as the same numbers. Temperatures and pressures follow from what volumes
//! hold ([`volume`]), and the pressures go back into the next step of the flow method.
//!
//! Like the rest of a network this is constant data, with a flat state and a step of fixed operations. A network
//! without volumes here has no climate and costs nothing.

mod buffers;
mod density;
mod lines;
pub mod monitor;
mod observe;
pub mod regulation;
mod step;
mod supply;
pub mod volume;

pub(crate) use buffers::{Running, sizes};
pub(crate) use density::virtual_k;
pub use observe::{Ledger, Readings};
pub(crate) use observe::{Observed, VolumeView};
pub use regulation::ControlLoop;
pub(crate) use step::{Given, Stepped, control, start, step, supply};
pub(crate) use supply::Supplied;
pub use volume::{Contents, Volume};

use crate::component::Element;
use crate::component::{AnyComponent, Passage, Placed, StepContext, Table};
use crate::fluid::medium::{Medium, dot};
use crate::parameter::{Carries, Place, StepBound};
use crate::parameter::{InputSpec, ParameterError};
use crate::{Fingerprint, Network, Node, NodeKind};

/// The description of everything beside the flows, borrowed.
#[derive(Debug, Clone, Copy)]
pub struct Climate<'a> {
    /// Temperature from which energies count [K].
    pub reference_k: f32,
    /// Air at the reference temperature.
    pub air: Medium,
    /// The coolant.
    pub coolant: Medium,
    /// One volume per node; none for a network of flows only.
    pub volumes: &'a [Volume],
    /// Placed components, those of one kind side by side.
    pub components: &'a [Placed],
    /// Their kinds.
    pub tables: &'a [Table],
    /// Passages of streams through components, in the order of the segments.
    pub passages: &'a [Passage],
    /// Control loops, in the order in which they act.
    pub loops: &'a [ControlLoop],
}

/// Why a climate was refused, with the index of the thing at fault.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ClimateError {
    /// There is not one volume per node.
    Volumes,
    /// A parameter of a volume.
    Volume(u32, ParameterError),
    /// A node of air has no volume of its own: junctions cannot hold air.
    Junction(u32),
    /// A line joins air and coolant.
    Media(u32),
    /// A line of coolant has a law of gases: a density that follows, or an opening with compressible flow.
    GasLaw(u32),
    /// A segment has a volume inside its line; with a climate volumes are nodes.
    InnerVolume(u32),
    /// A segment takes out a fixed share of its flow; with a climate condensers and removers do that.
    Removal(u32),
    /// A table of components does not follow the one before.
    Table(u32),
    /// A parameter of a placed component.
    Component(u32, ParameterError),
    /// A parameter of a placed component does not allow the step.
    ComponentStep(u32, StepBound),
    /// A placed component names no volume, one with the wrong contents, or a boundary.
    ComponentNode(u32),
    /// The walls of a placed component's volume conduct more within a step than the volume holds; the conductance that
    /// all of them may have [W/K].
    Conductance(u32, f32),
    /// A passage names a component that does not exist, is out of order, or leads through the wrong medium.
    Passage(u32),
    /// A placed component lacks the stream of its own side, or has two streams on one side.
    Sides(u32),
    /// A parameter of a control loop.
    Loop(u32, ParameterError),
    /// A control loop measures or drives what does not exist, or what something else drives.
    LoopTarget(u32),
    /// An input lies outside the network's inputs or starts out of its range.
    Input(u32),
}

impl Climate<'_> {
    /// No climate: flows only.
    pub const NONE: Climate<'static> = Climate {
        reference_k: 295.15,
        air: Medium::NONE,
        coolant: Medium::NONE,
        volumes: &[],
        components: &[],
        tables: &[],
        passages: &[],
        loops: &[],
    };

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.volumes.is_empty()
    }

    /// How much more the pressure of a volume of air rises with its mass than isothermally [1]: γ, because what comes
    /// brings its flow work. 1 without a climate, and for what is no gas.
    pub(crate) fn isentropic(&self, node: &Node) -> f32 {
        if self.is_none() || !matches!(node.kind, NodeKind::Cabin { .. }) { 1.0 } else { volume::GAMMA }
    }

    /// The most by which it may rise more than Rg·T/V of the description says, with the gas constant of what comes
    /// (nitrogen's is 1.034 of dry air's) and the highest temperature that is followed [1]; 1 without a climate.
    pub(crate) fn stiffening(&self, node: &Node) -> f32 {
        let hottest = volume::MOST_K;
        if self.is_none() { 1.0 } else { self.isentropic(node) * 1.034 * hottest / node.temperature_k }
    }

    pub(crate) fn holds(&self, node: u32, contents: Contents) -> bool {
        self.volumes.get(node as usize).is_some_and(|volume| volume.contents == contents)
    }

    /// Whether a control loop drives input `slot`.
    pub(crate) fn drives(&self, slot: usize) -> bool {
        self.loops.iter().any(|control| control.drives as usize == slot || control.opposite as usize == slot)
    }

    /// Placed components with their tables.
    fn placed(&self) -> impl Iterator<Item = (u32, &Table, &Placed)> {
        self.tables.iter().flat_map(|table| {
            let first = table.range.first;
            (first..).zip(self.placed_of(table)).map(move |(index, placed)| (index, table, placed))
        })
    }

    /// Components of a table.
    pub(crate) fn placed_of(&self, table: &Table) -> &[Placed] {
        let first = table.range.first as usize;
        self.components.get(first..first + table.range.count as usize).unwrap_or(&[])
    }

    /// Returns placed component `index` with its table.
    pub fn component(&self, index: u32) -> Option<(&Table, &Placed)> {
        let table = self.tables.iter().find(|table| {
            index.checked_sub(table.range.first).is_some_and(|place| place < table.range.count)
        })?;
        Some((table, self.components.get(index as usize)?))
    }

    /// Returns the components of kind `C` with their places, as their own type.
    pub fn components_of<C: crate::Component>(&self) -> impl Iterator<Item = (C, &Placed)> {
        let own = self.tables.iter().filter(|table| table.is::<C>());
        own.flat_map(|table| self.placed_of(table).iter().map(|placed| (C::from_row(&placed.row), placed)))
    }

    /// Gas that the components of a network bring into volumes at these inputs [kg/s], with the place of each.
    pub fn gas_sources<'i>(&'i self, inputs: &'i [f32]) -> impl Iterator<Item = (u32, u32, f32)> + 'i {
        self.placed().map(move |(index, table, placed)| {
            let own = inputs.get(placed.first_input as usize..).unwrap_or(&[]);
            (index, placed.node, table.kind().gas_kg_s(&placed.row, own))
        })
    }

    /// Quantities that are the same for all components in a step.
    pub(crate) fn context<'s>(&'s self, step_s: f32, inputs: &'s [f32]) -> StepContext<'s> {
        StepContext { step_s, reference_k: self.reference_k, air: &self.air, coolant: &self.coolant, inputs }
    }

    /// Name, unit and range of input `slot`, where it is the climate's.
    pub fn spec_of(&self, slot: usize) -> Option<InputSpec> {
        let slot = slot as u32;
        let mut found = self.placed().find_map(|(_, table, placed)| {
            let index = slot.checked_sub(placed.first_input)?;
            table.component(placed).input_spec(index as usize)
        });
        found = found.or_else(|| {
            self.loops.iter().find_map(|control| {
                let index = slot.checked_sub(control.first_input)?;
                ControlLoop::INPUTS.get(index as usize).copied()
            })
        });
        found
    }

    /// Finds the first thing wrong with the climate of a network whose own check passed, for a step of `step_us` [µs].
    pub fn check<E: Element>(&self, network: &Network<'_, E>, step_us: u32) -> Result<(), ClimateError> {
        if self.is_none() {
            return Ok(());
        }
        let step_s = step_us as f32 * 1e-6;
        if self.volumes.len() != network.nodes.len() {
            return Err(ClimateError::Volumes);
        }
        for ((index, volume), node) in (0u32..).zip(self.volumes).zip(network.nodes) {
            volume.check().map_err(|error| ClimateError::Volume(index, error))?;
            let fits = match node.kind {
                NodeKind::Cabin { .. } => volume.contents == Contents::Air,
                NodeKind::Liquid { .. } => volume.contents == Contents::Coolant,
                NodeKind::Boundary => true,
                NodeKind::Junction => false,
            };
            if !fits {
                return Err(ClimateError::Junction(index));
            }
        }
        for (index, line) in (0u32..).zip(network.lines) {
            let air = self.holds(line.from, Contents::Air);
            if air != self.holds(line.to, Contents::Air) {
                return Err(ClimateError::Media(index));
            }
            let segments = network.segments_of(line);
            let follows = network
                .responsive
                .iter()
                .any(|entry| entry.line == index && entry.reference_density_kg_m3 > 0.0);
            if !air && (follows || segments.iter().any(|segment| segment.element.needs_both_ends())) {
                return Err(ClimateError::GasLaw(index));
            }
            for (place, segment) in (line.first_segment..).zip(segments) {
                if segment.element.removal() > 0.0 {
                    return Err(ClimateError::Removal(place));
                }
                // The volume behind the last segment is the node's.
                if segment.outlet_volume_m3 > 0.0 && place + 1 < line.first_segment + line.segments {
                    return Err(ClimateError::InnerVolume(place));
                }
            }
        }
        self.check_components(network, step_s)?;
        self.check_passages(network)?;
        self.check_loops(network)
    }

    fn carries(&self, node: u32, carries: Carries) -> bool {
        match carries {
            Carries::Any => (node as usize) < self.volumes.len(),
            Carries::Air => self.holds(node, Contents::Air),
            Carries::Coolant => self.holds(node, Contents::Coolant),
        }
    }

    fn check_components<E: Element>(
        &self,
        network: &Network<'_, E>,
        step_s: f32,
    ) -> Result<(), ClimateError> {
        let mut before = None;
        for (index, table) in (0u32..).zip(self.tables) {
            let own = self.placed_of(table);
            let first = own.first().map(|placed| table.component(placed));
            let range = first.map(|first| Table::places(before, &first, table.range.count));
            if range != Some(table.range) || own.len() != table.range.count as usize {
                return Err(ClimateError::Table(index));
            }
            before = Some(table);
        }
        if before.map_or(0, |last| last.range.first + last.range.count) as usize != self.components.len() {
            return Err(ClimateError::Table(self.tables.len() as u32));
        }
        for (index, table, placed) in self.placed() {
            let component = table.component(placed);
            component.check().map_err(|error| ClimateError::Component(index, error))?;
            let kind = table.kind();
            kind.check_step(&placed.row, step_s)
                .map_err(|bound| ClimateError::ComponentStep(index, bound))?;
            let held = network.nodes.get(placed.node as usize).map(|node| node.kind == NodeKind::Boundary);
            let fits = match (kind.place(), kind.sides()) {
                (Place::Node { holds, boundary }, _) => {
                    self.carries(placed.node, holds) && (boundary || held == Some(false))
                }
                (Place::Line, [own, ..]) => self.carries(placed.node, *own),
                (Place::Line, []) => false,
            };
            if !fits {
                return Err(ClimateError::ComponentNode(index));
            }
            self.check_conductance(index, placed, held == Some(true), step_s)?;
            check_inputs(network, placed.first_input, &component)?;
        }
        Ok(())
    }

    /// Within one step a volume must not pass the temperature of its walls.
    fn check_conductance(
        &self,
        index: u32,
        placed: &Placed,
        held: bool,
        step_s: f32,
    ) -> Result<(), ClimateError> {
        let own = self.placed().filter(|(_, _, other)| other.node == placed.node);
        let conductance: f32 = own.map(|(_, table, other)| table.kind().conductance_w_k(&other.row)).sum();
        let Some(volume) = self.volumes.get(placed.node as usize).filter(|_| !held && conductance > 0.0)
        else {
            return Ok(());
        };
        let heats = &volume.medium(&self.air, &self.coolant).resting_j_kg_k;
        let most = volume.start_kg * dot(&volume.fractions, heats) / step_s;
        if conductance > most { Err(ClimateError::Conductance(index, most)) } else { Ok(()) }
    }

    fn check_passages<E: Element>(&self, network: &Network<'_, E>) -> Result<(), ClimateError> {
        let mut last = 0;
        for (index, passage) in (0u32..).zip(self.passages) {
            let line = network.lines.get(passage.line as usize);
            let table = self.tables.get(passage.table as usize);
            let fits = line.zip(table).is_some_and(|(line, table)| {
                let place = passage.component.wrapping_sub(table.range.first);
                let side = table.kind().sides().get(usize::from(passage.side));
                place < table.range.count
                    && side.is_some_and(|carries| self.carries(line.from, *carries))
                    && (line.first_segment..line.first_segment + line.segments).contains(&passage.segment)
            });
            if !fits || passage.segment < last {
                return Err(ClimateError::Passage(index));
            }
            last = passage.segment;
        }
        for (index, table, placed) in self.placed() {
            let streams = |side: u8| {
                self.passages.iter().filter(|other| other.component == index && other.side == side).count()
            };
            let own = usize::from(!table.kind().sides().is_empty());
            if streams(0) != own || streams(1) != usize::from(placed.linked) {
                return Err(ClimateError::Sides(index));
            }
        }
        Ok(())
    }

    fn check_loops<E: Element>(&self, network: &Network<'_, E>) -> Result<(), ClimateError> {
        let slots = network.inputs.len();
        for (place, control) in self.loops.iter().enumerate() {
            let index = place as u32;
            control
                .sensor
                .check()
                .and(control.controller.check())
                .and(control.actuator.check())
                .map_err(|error| ClimateError::Loop(index, error))?;
            let driven = |slot: u32| {
                let earlier = self.loops.get(..place).unwrap_or(&[]);
                (slot as usize) < slots
                    && !network.schedules.iter().any(|schedule| schedule.input == slot)
                    && !earlier.iter().any(|other| other.drives == slot || other.opposite == slot)
            };
            let opposite = control.opposite == ControlLoop::NONE
                || (control.opposite != control.drives && driven(control.opposite));
            let measures = self.can_measure(control.measures);
            if !(measures && driven(control.drives) && opposite) {
                return Err(ClimateError::LoopTarget(index));
            }
            for (slot, spec) in (control.first_input..).zip(ControlLoop::INPUTS) {
                check_input(network, slot, spec)?;
            }
        }
        Ok(())
    }

    /// Adds everything to the network's id; nothing where there is no climate.
    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        if self.is_none() {
            return;
        }
        hash.value(self.reference_k);
        for medium in [&self.air, &self.coolant] {
            hash.values(&medium.flowing_j_kg_k);
            hash.values(&medium.resting_j_kg_k);
            hash.values(&medium.offset_j_kg);
            hash.values(&medium.gas_j_kg_k);
            hash.value(medium.latent_j_kg);
            hash.value(medium.expansion_1_k);
        }
        self.volumes.iter().for_each(|volume| volume.feed(hash));
        for (_, table, placed) in self.placed() {
            table.component(placed).hash_into(hash);
            for word in [placed.node, placed.first_input, u32::from(placed.linked)] {
                hash.word(word);
            }
        }
        for passage in self.passages {
            for word in [passage.segment, passage.component, u32::from(passage.side)] {
                hash.word(word);
            }
        }
        self.loops.iter().for_each(|control| control.feed(hash));
    }
}

/// Finds an input of a component that does not exist or starts out of its range.
fn check_inputs<E>(
    network: &Network<'_, E>,
    first: u32,
    component: &AnyComponent,
) -> Result<(), ClimateError> {
    let specs = (0..).map_while(|index| component.input_spec(index));
    for (slot, spec) in (first..).zip(specs) {
        check_input(network, slot, spec)?;
    }
    Ok(())
}

fn check_input<E>(network: &Network<'_, E>, slot: u32, spec: InputSpec) -> Result<(), ClimateError> {
    let value = network.inputs.get(slot as usize).ok_or(ClimateError::Input(slot))?;
    if (spec.min..=spec.max).contains(value) { Ok(()) } else { Err(ClimateError::Input(slot)) }
}
