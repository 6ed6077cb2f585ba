//! Pressure regulator: throttles so that the pressure at its outlet stays at its set point.
//!
//! Isentropic flow through the effective area `C_d·A·x`. The opening x follows the outlet's absolute pressure p
//! with a lag τ: fully open at and below `set − band`, closed (but for its leak) at and above the set point:
//!
//! ```text
//! τ·dx/dt = u − x,   u = (set − p)/band within 0 … 1      x⁺ = x + h/(h + τ)·(u − x) once a step
//! ```
//!
//! Source: proportional (spring-loaded) regulator with first-order actuator, as in any control text; law of the
//! opening in [`super::isentropic`]. The update is that of implicit Euler: x never overshoots u, whatever the step.
//! The loop that it closes through its plenum needs one: with c = Rg·T/V and W the full flow, its angular frequency
//! is √(c·W/(τ·band)), and steps beyond about 1/that cannot follow it.

use super::{isentropic, orifice, seat};
use crate::component::{Component, Draft};
use crate::control::ActuatorFault;
use crate::law::{Law, Operating};
use crate::limits::SOME_PRESSURE;
use crate::math;
use crate::parameter::{InputSpec, Key, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one regulator. Memory: the opening x [1].
    pub struct PressureRegulator {
        /// Effective area `C_d·A` when fully open [m²]; 1e-15 … 1e4.
        pub effective_area_m2: f32,
        /// Absolute pressure at the outlet at and above which it closes [Pa]; finite and > 0.
        pub set_point_pa: f32,
        /// Below the set point by this it is fully open [Pa]; finite and > 0.
        pub band_pa: f32,
        /// Lag τ of the actuator [s]; finite and > 0.
        pub lag_s: f32,
        /// Opening that remains when closed [1]; 1e-18 … 1.
        pub leakage_opening: f32,
    }
}

impl Component for PressureRegulator {
    const KIND: &'static str = "pressure_regulator";
    const ABOUT: &'static str = "Holds the pressure at its outlet.";
    const KEYS: Keys = &[&[
        orifice::DISCHARGE,
        Key::required("set_point_pa", "Pa", SOME_PRESSURE, "Absolute pressure at the outlet at which it closes."),
        Key::required("band_pa", "Pa", SOME_PRESSURE, "Fully open below the set point by this."),
        Key::required("lag_s", "s", (1e-3, 1e5), "Lag of the actuator."),
    ], seat::KEYS];
    const INPUTS: &'static [InputSpec] = &[InputSpec::FAULT];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        let effective_area_m2 = orifice::effective_area(draft);
        Self {
            effective_area_m2,
            set_point_pa: draft.single("set_point_pa"),
            band_pa: draft.single("band_pa"),
            lag_s: draft.single("lag_s"),
            leakage_opening: seat::of_area(draft, effective_area_m2),
        }
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
        isentropic::CHORD_OVER_SECANT
    }

    fn memory(&self) -> usize {
        1
    }

    fn advance(&self, at: &Operating<'_>, step_s: f32, memory: &mut [f32]) {
        let Some(opening) = memory.first_mut() else { return };
        let wanted = (self.set_point_pa - at.outlet_pa) / self.band_pa;
        let wanted = math::larger(wanted, 0.0);
        let wanted = if wanted > 1.0 { 1.0 } else { wanted };
        let wanted = match ActuatorFault::of_inputs(at.inputs) {
            ActuatorFault::None => wanted,
            ActuatorFault::Stuck => *opening,
            ActuatorFault::Open => 1.0,
            ActuatorFault::Closed => 0.0,
        };
        // h/(h + τ), also for a step without end.
        *opening += (wanted - *opening) / (1.0 + self.lag_s / step_s);
    }

    fn settles(&self) -> bool {
        true
    }

    fn law(&self, at: &Operating<'_>) -> Law {
        let opening = math::larger(at.memory.first().copied().unwrap_or(1.0), self.leakage_opening);
        Law::closing(isentropic::resistance_pa_s2_kg2(
            math::larger(self.effective_area_m2 * opening, orifice::SMALLEST_AREA_M2),
            at.inlet_pa,
            at.outlet_pa,
            at.temperature_k,
        ))
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("set_point_pa", self.set_point_pa)?;
        ParameterError::unless_positive("band_pa", self.band_pa)?;
        ParameterError::unless_positive("lag_s", self.lag_s)?;
        orifice::check_area(self.effective_area_m2)?;
        seat::check(self.leakage_opening)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    const REGULATOR: PressureRegulator = PressureRegulator {
        effective_area_m2: 1e-6,
        set_point_pa: 101_000.0,
        band_pa: 500.0,
        lag_s: 0.5,
        leakage_opening: 1e-3,
    };

    fn advanced(outlet_pa: f32, step_s: f32, from: f32, steps: u32) -> f32 {
        let mut memory = [from];
        let at = Operating { inlet_pa: 1e6, outlet_pa, ..Operating::plain(&[], 0.0) };
        for _ in 0..steps {
            REGULATOR.advance(&at, step_s, &mut memory);
        }
        memory[0]
    }

    #[test]
    fn at_rest_the_opening_is_proportional_within_the_band() {
        for (outlet, exact) in [(9e4, 1.0), (100_500.0, 1.0), (100_750.0, 0.5), (101_000.0, 0.0), (2e5, 0.0)]
        {
            let found = advanced(outlet, f32::INFINITY, 0.3, 1);
            assert!((found - exact).abs() < 1e-6, "{outlet}: {found}");
        }
    }

    #[test]
    fn the_lag_is_an_exponential_and_never_overshoots() {
        let found = f64::from(advanced(9e4, 1e-4, 0.0, 5_000));
        assert!((found - (1.0 - (-1.0f64).exp())).abs() < 1e-4, "{found}");
        for step_s in [1e-4, 0.1, 10.0, 1e6] {
            assert!((0.0..=1.0).contains(&advanced(9e4, step_s, 0.0, 3)));
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        let name = |regulator: PressureRegulator| regulator.check().unwrap_err().parameter;
        assert_eq!(name(PressureRegulator { band_pa: 0.0, ..REGULATOR }), "band_pa");
        assert_eq!(name(PressureRegulator { lag_s: 0.0, ..REGULATOR }), "lag_s");
        assert_eq!(name(PressureRegulator { set_point_pa: -1.0, ..REGULATOR }), "set_point_pa");
        assert_eq!(name(PressureRegulator { leakage_opening: 0.0, ..REGULATOR }), "leakage_opening");
        assert_eq!(name(PressureRegulator { effective_area_m2: 1e-16, ..REGULATOR }), "effective_area_m2");
        assert!(REGULATOR.check().is_ok());
    }
}
