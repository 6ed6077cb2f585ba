//! Controllers as elements: sensor, controller and actuator in series, each with the faults that real ones have.
//!
//! Each is constant data with a pure step over a small state, called once a tick. Faults are inputs, so that a
//! scenario schedules them and an operator commands them live.

mod actuator;
mod controller;
mod sensor;

pub use actuator::{Actuator, ActuatorFault};
pub use controller::{Controller, Pid, Thermostat};
pub use sensor::{Sensor, SensorFault};
