//! Control loops: what is measured, the controller, and the input that its actuator drives.

use crate::control::{Actuator, Controller, Sensor};
use crate::{Fingerprint, InputSpec, Signal};

/// A sensor, a controller and an actuator in series.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ControlLoop {
    /// Signal that the sensor looks at, of a volume or an exchanger.
    pub measures: Signal,
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
        self.measures.hash_into(hash);
        for word in [self.drives, self.opposite, self.first_input] {
            hash.word(word);
        }
        self.sensor.feed(hash);
        self.controller.feed(hash);
        self.actuator.feed(hash);
    }
}
