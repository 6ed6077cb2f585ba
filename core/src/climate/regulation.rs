//! Control loops: what is measured, the controller, and the input that its actuator drives.

use super::medium::PARTS;
use super::{Climate, Contents};
use crate::control::{Actuator, Controller, Sensor};
use crate::{Fingerprint, InputSpec};

/// What a sensor looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Measure {
    /// Temperature of a volume [K].
    Temperature(u32),
    /// Dew point of a volume [K].
    DewPoint(u32),
    /// Relative humidity of a volume [1].
    RelativeHumidity(u32),
    /// Absolute pressure of a volume [Pa].
    Pressure(u32),
    /// Partial pressure in a volume [Pa]: the volume, the part.
    Partial(u32, u32),
    /// Temperature of the air behind an exchanger [K].
    AirOutlet(u32),
}

impl Measure {
    /// Kind, place and part as numbers, for a fingerprint.
    pub(crate) fn words(self) -> [u32; 3] {
        match self {
            Self::Temperature(node) => [0, node, 0],
            Self::DewPoint(node) => [1, node, 0],
            Self::RelativeHumidity(node) => [2, node, 0],
            Self::Pressure(node) => [3, node, 0],
            Self::Partial(node, part) => [4, node, part],
            Self::AirOutlet(exchanger) => [5, exchanger, 0],
        }
    }

    /// Whether the measured place exists in this climate and holds what is measured: of coolant that is temperature.
    pub(crate) fn exists(self, climate: &Climate<'_>) -> bool {
        match self {
            Self::Temperature(node) => (node as usize) < climate.volumes.len(),
            Self::DewPoint(node) | Self::RelativeHumidity(node) | Self::Pressure(node) => {
                climate.holds(node, Contents::Air)
            }
            Self::Partial(node, part) => climate.holds(node, Contents::Air) && (part as usize) < PARTS,
            Self::AirOutlet(exchanger) => (exchanger as usize) < climate.exchangers.len(),
        }
    }
}

/// A sensor, a controller and an actuator in series.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ControlLoop {
    /// What is measured.
    pub measure: Measure,
    /// The sensor.
    pub sensor: Sensor,
    /// The controller.
    pub controller: Controller,
    /// The actuator.
    pub actuator: Actuator,
    /// Input slot that the actuator drives.
    pub drives: u32,
    /// Slot that gets what is left to `closed + open`, for the other way of a three-way valve; [`Self::NONE`] for none.
    pub opposite: u32,
    /// Slot of `setpoint`; `sensor_bias`, `sensor_fault` and `actuator_fault` follow.
    pub first_input: u32,
}

impl ControlLoop {
    /// No slot.
    pub const NONE: u32 = u32::MAX;
    /// Inputs: setpoint and bias in the unit of what is measured; fault of the sensor (0 none, 1 stuck, 2 dropout) and
    /// of the actuator (0 none, 1 stuck, 2 open, 3 closed).
    pub const INPUTS: [InputSpec; 4] = [
        InputSpec { name: "setpoint", unit: "measured", min: -1e7, max: 1e7, default: 0.0 },
        InputSpec { name: "sensor_bias", unit: "measured", min: -1e7, max: 1e7, default: 0.0 },
        InputSpec { name: "sensor_fault", unit: "1", min: 0.0, max: 2.0, default: 0.0 },
        InputSpec { name: "actuator_fault", unit: "1", min: 0.0, max: 3.0, default: 0.0 },
    ];
    /// State of a loop.
    pub const STATE: usize = Sensor::STATE + Controller::STATE + Actuator::STATE;

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        let [kind, first, second] = self.measure.words();
        for word in [kind, first, second, self.drives, self.opposite, self.first_input] {
            hash.word(word);
        }
        self.sensor.feed(hash);
        self.controller.feed(hash);
        self.actuator.feed(hash);
    }
}
