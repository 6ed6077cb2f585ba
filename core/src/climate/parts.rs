//! What acts on volumes and streams: heat, sources, removal, walls.
//!
//! Each is constant data whose present values are inputs, so that a scenario schedules them, a controller drives them,
//! and an operator commands them live.

use super::medium::PARTS;
use crate::element::{ParameterError, Reason};
use crate::{Fingerprint, InputSpec};

/// What a line's stream meets at one of its segments.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Passage {
    /// Electric power of a fan or pump at rated speed [W], all of which ends as heat in what it moves; it follows the
    /// cube of the speed, whose slot is given.
    Machine {
        /// At rated speed [W], ≥ 0.
        power_w: f32,
        /// Slot of the speed.
        speed_input: u32,
    },
    /// Heater, cold plate or simple heat load: the power in this slot [W] goes into the stream.
    Heater {
        /// Slot of the power.
        power_input: u32,
    },
    /// Air side of this exchanger.
    Condenser(u32),
    /// Coolant side of this exchanger.
    CoolantSide(u32),
    /// Liquid in the place of this exchanger's air: liquid to liquid.
    LiquidSide(u32),
}

/// A passage at its place; in the order of the segments.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Station {
    /// The segment, counted over all lines.
    pub segment: u32,
    /// Its line.
    pub line: u32,
    /// What is there.
    pub passage: Passage,
}

/// Power of a heater's input.
pub const HEATER_INPUT: InputSpec = InputSpec { name: "power", unit: "W", min: -1e5, max: 1e5, default: 0.0 };

/// Heat and masses that come into a volume at its own temperature: equipment, lighting, injection, supply, leak.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Source {
    /// The volume.
    pub node: u32,
    /// Slot of `heat`; the masses of the parts follow.
    pub first_input: u32,
}

/// A mass flow of a source.
const fn mass(name: &'static str) -> InputSpec {
    InputSpec { name, unit: "kg/s", min: -1.0, max: 1.0, default: 0.0 }
}

impl Source {
    /// Inputs: heat, then the mass flow of every part.
    pub const INPUTS: [InputSpec; PARTS + 1] = [
        InputSpec { name: "heat", unit: "W", min: -1e5, max: 1e5, default: 0.0 },
        mass("nitrogen"),
        mass("oxygen"),
        mass("carbon_dioxide"),
        mass("vapour"),
        mass("trace"),
        mass("liquid"),
    ];
}

/// Idealised removal of one part: this volume flow of air leaves without it, times the efficiency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Remover {
    /// The volume.
    pub node: u32,
    /// The part, as in [`super::medium::NAMES`].
    pub part: u32,
    /// Slot of `air_flow`; `efficiency` follows.
    pub first_input: u32,
}

impl Remover {
    /// Inputs: volume flow of air, share of the part that is taken.
    pub const INPUTS: [InputSpec; 2] = [
        InputSpec { name: "air_flow", unit: "m³/s", min: 0.0, max: 1.0, default: 0.0 },
        InputSpec { name: "efficiency", unit: "1", min: 0.0, max: 1.0, default: 1.0 },
    ];
}

/// A wall with heat capacity between a volume and its surroundings.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Wall {
    /// The volume.
    pub node: u32,
    /// Heat capacity [J/K]; finite, and large enough for the step.
    pub capacity_j_k: f32,
    /// Conductance between volume and wall [W/K]; finite and ≥ 0.
    pub inner_w_k: f32,
    /// Conductance between wall and surroundings [W/K]; finite and ≥ 0.
    pub outer_w_k: f32,
    /// Temperature at the start [K].
    pub start_k: f32,
    /// Slot of `outside`.
    pub first_input: u32,
}

impl Wall {
    /// Input: temperature of the surroundings.
    pub const INPUTS: [InputSpec; 1] =
        [InputSpec { name: "outside", unit: "K", min: 50.0, max: 500.0, default: 295.15 }];

    /// Finds the first parameter outside its valid range, for a step of `step_s` [s].
    pub fn check(&self, step_s: f32) -> Result<(), ParameterError> {
        ParameterError::unless_positive("capacity_j_k", self.capacity_j_k)?;
        ParameterError::unless_not_negative("inner_w_k", self.inner_w_k)?;
        ParameterError::unless_not_negative("outer_w_k", self.outer_w_k)?;
        ParameterError::unless_positive("start_k", self.start_k)?;
        if self.capacity_j_k < step_s * (self.inner_w_k + self.outer_w_k) {
            return Err(ParameterError { parameter: "capacity_j_k", reason: Reason::OutsideValidity });
        }
        Ok(())
    }

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        hash.word(self.node);
        hash.values(&[self.capacity_j_k, self.inner_w_k, self.outer_w_k, self.start_k]);
        hash.word(self.first_input);
    }
}

impl Station {
    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        hash.word(self.segment);
        match self.passage {
            Passage::Machine { power_w, speed_input } => {
                hash.word(1);
                hash.value(power_w);
                hash.word(speed_input);
            }
            Passage::Heater { power_input } => {
                hash.word(2);
                hash.word(power_input);
            }
            Passage::Condenser(index) => {
                hash.word(3);
                hash.word(index);
            }
            Passage::CoolantSide(index) => {
                hash.word(4);
                hash.word(index);
            }
            Passage::LiquidSide(index) => {
                hash.word(5);
                hash.word(index);
            }
        }
    }
}
