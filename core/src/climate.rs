//! Heat, moisture, gas composition and control on top of a network's flows.
//!
//! The flow method yields one mean flow per line and step; one conservative update moves masses and energy with it.
//! What leaves one volume enters the next as the same numbers. Temperatures and pressures follow from what volumes
//! hold ([`volume`]), and the pressures go back into the next step of the flow method.
//!
//! Like the rest of a network this is constant data, with a flat state and a step of fixed operations. A network
//! without volumes here has no climate and costs nothing.

mod books;
mod buffers;
mod coils;
pub mod condenser;
pub mod crew;
mod density;
pub mod exchanger;
mod lines;
pub mod medium;
pub mod monitor;
mod observe;
pub mod parts;
pub mod regulation;
mod step;
pub mod stream;
mod supply;
pub mod volume;

pub(crate) use buffers::{Running, sizes};
pub use crew::Crew;
pub(crate) use density::virtual_k;
pub use exchanger::{Exchanger, ExchangerReadings};
pub use observe::{Ledger, Readings};
pub(crate) use observe::{Observed, VolumeView};
pub use parts::{Passage, Remover, Source, Station, Wall};
pub use regulation::ControlLoop;
pub(crate) use step::{Given, Stepped, control, start, step, supply};
pub(crate) use supply::Supplied;
pub use volume::{Contents, Volume};

use self::medium::{Medium, PARTS};
use crate::element::{Element, InputSpec, ParameterError, Reason};
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
    /// What streams meet on their way, in the order of the segments.
    pub stations: &'a [Station],
    /// Condensing heat exchangers.
    pub exchangers: &'a [Exchanger],
    /// Heat and mass sources.
    pub sources: &'a [Source],
    /// Groups of people.
    pub crews: &'a [Crew],
    /// Idealised removal.
    pub removers: &'a [Remover],
    /// Walls.
    pub walls: &'a [Wall],
    /// Control loops, in the order in which they act.
    pub loops: &'a [ControlLoop],
}

/// Why a climate was refused, with the index of the thing at fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    /// A station names what does not exist, is out of order, or stands in the wrong medium.
    Station(u32),
    /// A parameter of an exchanger.
    Exchanger(u32, ParameterError),
    /// An exchanger has no air side or more than one, no coolant or two, or no volume behind it.
    ExchangerSides(u32),
    /// A source names no volume of air.
    Source(u32),
    /// A crew names no volume of air.
    Crew(u32),
    /// A remover names no volume of air or no part of it.
    Remover(u32),
    /// A parameter of a wall.
    Wall(u32, ParameterError),
    /// A wall names no volume.
    WallNode(u32),
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
        stations: &[],
        exchangers: &[],
        sources: &[],
        crews: &[],
        removers: &[],
        walls: &[],
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

    /// Name, unit and range of input `slot`, where it is the climate's.
    pub fn spec_of(&self, slot: usize) -> Option<InputSpec> {
        let of = |first: u32, specs: &[InputSpec]| {
            slot.checked_sub(first as usize).and_then(|index| specs.get(index)).copied()
        };
        let heater = |station: &Station| match station.passage {
            Passage::Heater { power_input } => of(power_input, &[parts::HEATER_INPUT]),
            Passage::Machine { .. }
            | Passage::Condenser(_)
            | Passage::CoolantSide(_)
            | Passage::LiquidSide(_) => None,
        };
        let mut found = self.stations.iter().find_map(heater);
        found = found
            .or_else(|| self.exchangers.iter().find_map(|part| of(part.first_input, &Exchanger::INPUTS)));
        found = found.or_else(|| self.sources.iter().find_map(|part| of(part.first_input, &Source::INPUTS)));
        found = found.or_else(|| self.crews.iter().find_map(|part| of(part.first_input, &Crew::INPUTS)));
        found =
            found.or_else(|| self.removers.iter().find_map(|part| of(part.first_input, &Remover::INPUTS)));
        found = found.or_else(|| self.walls.iter().find_map(|part| of(part.first_input, &Wall::INPUTS)));
        found.or_else(|| self.loops.iter().find_map(|part| of(part.first_input, &ControlLoop::INPUTS)))
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
        self.check_stations(network)?;
        self.check_parts(network, step_s)?;
        self.check_loops(network)
    }

    fn check_stations<E: Element>(&self, network: &Network<'_, E>) -> Result<(), ClimateError> {
        let mut last = 0;
        for (index, station) in (0u32..).zip(self.stations) {
            let line = network.lines.get(station.line as usize);
            let inside = line.is_some_and(|line| {
                let air = self.holds(line.from, Contents::Air);
                let medium = match station.passage {
                    Passage::Condenser(of) => air && (of as usize) < self.exchangers.len(),
                    Passage::CoolantSide(of) | Passage::LiquidSide(of) => {
                        !air && (of as usize) < self.exchangers.len()
                    }
                    Passage::Machine { .. } | Passage::Heater { .. } => true,
                };
                medium && (line.first_segment..line.first_segment + line.segments).contains(&station.segment)
            });
            if !inside || station.segment < last {
                return Err(ClimateError::Station(index));
            }
            match station.passage {
                Passage::Machine { power_w, speed_input } => {
                    let power = ParameterError::unless_not_negative("power_w", power_w);
                    if power.is_err() || speed_input as usize >= network.inputs.len() {
                        return Err(ClimateError::Station(index));
                    }
                }
                Passage::Heater { power_input } => {
                    check_inputs(network, power_input, &[parts::HEATER_INPUT])?;
                }
                Passage::Condenser(_) | Passage::CoolantSide(_) | Passage::LiquidSide(_) => {}
            }
            last = station.segment;
        }
        Ok(())
    }

    fn check_parts<E: Element>(&self, network: &Network<'_, E>, step_s: f32) -> Result<(), ClimateError> {
        for (index, exchanger) in (0u32..).zip(self.exchangers) {
            exchanger.check(step_s).map_err(|error| ClimateError::Exchanger(index, error))?;
            let count = |passage| self.stations.iter().filter(|station| station.passage == passage).count();
            // Air or liquid on the one side, coolant on the other; behind it what it carries.
            let liquid = count(Passage::LiquidSide(index));
            let first = (count(Passage::Condenser(index)), liquid);
            let behind = if liquid > 0 { Contents::Coolant } else { Contents::Air };
            let fits = matches!(first, (1, 0) | (0, 1))
                && count(Passage::CoolantSide(index)) == usize::from(!exchanger.own_coolant);
            if !(fits && self.holds(exchanger.outlet_node, behind)) {
                return Err(ClimateError::ExchangerSides(index));
            }
            check_inputs(network, exchanger.first_input, &Exchanger::INPUTS)?;
        }
        for (index, source) in (0u32..).zip(self.sources) {
            if !self.holds(source.node, Contents::Air) {
                return Err(ClimateError::Source(index));
            }
            check_inputs(network, source.first_input, &Source::INPUTS)?;
        }
        for (index, crew) in (0u32..).zip(self.crews) {
            if !self.holds(crew.node, Contents::Air) {
                return Err(ClimateError::Crew(index));
            }
            check_inputs(network, crew.first_input, &Crew::INPUTS)?;
        }
        for (index, remover) in (0u32..).zip(self.removers) {
            if !self.holds(remover.node, Contents::Air) || remover.part as usize >= PARTS - 1 {
                return Err(ClimateError::Remover(index));
            }
            check_inputs(network, remover.first_input, &Remover::INPUTS)?;
        }
        for (index, wall) in (0u32..).zip(self.walls) {
            wall.check(step_s).map_err(|error| ClimateError::Wall(index, error))?;
            let volume = self.volumes.get(wall.node as usize).ok_or(ClimateError::WallNode(index))?;
            // Within one step a volume must not pass the temperature of its walls either.
            let walls = self.walls.iter().filter(|other| other.node == wall.node);
            let conductance: f32 = walls.map(|wall| wall.inner_w_k).sum();
            let heats = &volume.medium(&self.air, &self.coolant).resting_j_kg_k;
            let held =
                network.nodes.get(wall.node as usize).is_some_and(|node| node.kind == NodeKind::Boundary);
            if !held && volume.start_kg * medium::dot(&volume.fractions, heats) < step_s * conductance {
                let (parameter, reason) = ("inner_w_k", Reason::OutsideValidity);
                return Err(ClimateError::Wall(index, ParameterError { parameter, reason }));
            }
            check_inputs(network, wall.first_input, &Wall::INPUTS)?;
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
            check_inputs(network, control.first_input, &ControlLoop::INPUTS)?;
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
        self.stations.iter().for_each(|station| station.feed(hash));
        self.exchangers.iter().for_each(|exchanger| exchanger.feed(hash));
        for source in self.sources {
            hash.word(source.node);
            hash.word(source.first_input);
        }
        self.crews.iter().for_each(|crew| crew.feed(hash));
        for remover in self.removers {
            hash.word(remover.node);
            hash.word(remover.part);
            hash.word(remover.first_input);
        }
        self.walls.iter().for_each(|wall| wall.feed(hash));
        self.loops.iter().for_each(|control| control.feed(hash));
    }
}

/// Finds an input that does not exist or starts out of its range.
fn check_inputs<E>(network: &Network<'_, E>, first: u32, specs: &[InputSpec]) -> Result<(), ClimateError> {
    for (slot, spec) in (first as usize..).zip(specs) {
        let value = network.inputs.get(slot).ok_or(ClimateError::Input(slot as u32))?;
        if !(spec.min..=spec.max).contains(value) {
            return Err(ClimateError::Input(slot as u32));
        }
    }
    Ok(())
}
