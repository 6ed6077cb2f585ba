//! Leak: an [orifice](super::Orifice) known by one measured leak.
//!
//! Source: isentropic flow of dry air, γ = 1.4, at the pressures of the measurement; law in [`super::isentropic`].

use super::isentropic::flow_per_area;
use super::orifice::{EFFECTIVE_AREA, Orifice};
use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::limits::SOME_PRESSURE;
use crate::parameter::{InputSpec, Key, Keys, ParameterError};
use crate::component_parameters;

/// Seconds of a day.
const SECONDS_A_DAY: f64 = 86_400.0;

component_parameters! {
    /// Fixed data of one leak. Input: share of its area that is open.
    pub struct Leak {
        /// Effective area `C_d·A` [m²]; 1e-12 … 1e4.
        pub effective_area_m2: f32,
    }
}

impl Leak {
    fn orifice(self) -> Orifice {
        Orifice { effective_area_m2: self.effective_area_m2 }
    }
}

impl Component for Leak {
    const KIND: &'static str = "leak";
    const ABOUT: &'static str = "Orifice known by one measured leak.";
    const KEYS: Keys = &[&[
        Key::required("leak_kg_d", "kg/d", (1e-9, 1e6), "Measured leak."),
        Key::required("pressure_drop_pa", "Pa", SOME_PRESSURE, "Pressure difference of the measurement."),
        Key::optional(
            "inlet_pressure_pa",
            "Pa",
            SOME_PRESSURE,
            "Absolute pressure before the leak in the measurement; that of the line's node of higher pressure when absent.",
        ),
    ]];
    const INPUTS: &'static [InputSpec] = Orifice::INPUTS;

    fn from_file(draft: &mut Draft<'_>) -> Self {
        let drop = draft.number("pressure_drop_pa");
        let high = draft.optional("inlet_pressure_pa").unwrap_or(draft.line.high_pa);
        if drop > high {
            let reason = format_args!("`pressure_drop_pa` = {drop} is more than the {high} Pa before it");
            draft.refuse("pressure_drop_pa", reason);
        }
        let per_area = flow_per_area(high, high - drop, draft.line.high_k);
        let area = draft.number("leak_kg_d") / SECONDS_A_DAY / per_area;
        Self { effective_area_m2: draft.fit("leak_kg_d", area, EFFECTIVE_AREA, "m²") }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.orifice().check()
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    fn responds(&self) -> bool {
        true
    }

    fn needs_both_ends(&self) -> bool {
        true
    }

    fn chord_over_secant(&self) -> f32 {
        self.orifice().chord_over_secant()
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        self.orifice().law(at)
    }
}
