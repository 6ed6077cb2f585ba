//! Pump: raises the pressure of a liquid by a head curve that falls with volume flow; all electric power ends as heat in it.
//!
//! Source: Qiu et al. 2017, pressurisation component; law and validity in [`HeadCurve`]. P = N³·`P_0` at the speed N.

use super::turbomachine::{self, turbomachine};
use super::HeadCurve;
use crate::component::{Block, Component, Draft, Heat, Passing, Placed, StepContext};
use crate::fluid::Stream;
use crate::law::{Law, Operating};
use crate::parameter::{Carries, InputSpec, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one pump.
    pub struct Pump {
        /// Pressure rise at zero flow [Pa]; finite and ≥ 0.
        pub shutoff_pa: f32,
        /// Linear fall [Pa·s/kg]; finite and ≥ 0.
        pub linear_pa_s_kg: f32,
        /// Quadratic fall [Pa·s²/kg²]; finite and > 0.
        pub quadratic_pa_s2_kg2: f32,
        /// Electric power at rated speed [W]; finite and ≥ 0.
        pub power_w: f32,
    }
}

turbomachine!(Pump);

impl Component for Pump {
    const KIND: &'static str = "pump";
    const ABOUT: &'static str = "Pump with a head curve; its electric power heats the liquid.";
    const KEYS: Keys = &[turbomachine::KEYS];

    turbomachine!(face);
}
