//! Hatch: a large opening between two modules, open, closed or between.
//!
//! `p_in − p_out = R/C²·w·|w|`, `R = ξ/(2·ρ·A²)`, C the free part of the area.
//!
//! Source: the quadratic loss of Qiu et al. 2017 on the hatch's own area; ξ is the user's (a sharp-edged hole
//! between large rooms has about 2.7, which is 1/0.61²). Pressure differences between open cabins are small: 1 Pa
//! drives about 1 kg/s through 1 m². A closed hatch keeps the leak of its
//! seal.

use super::{loss, seat};
use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::math;
use crate::parameter::{InputSpec, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one hatch.
    pub struct Hatch {
        /// Resistance R when fully open [Pa·s²/kg²] at the line's reference density; finite and > 0.
        pub open_resistance_pa_s2_kg2: f32,
        /// Part of the area that remains when closed [1]; 1e-18 … 1.
        pub leakage_opening: f32,
    }
}

impl Component for Hatch {
    const KIND: &'static str = "hatch";
    const ABOUT: &'static str = "Opening between modules: R/C² at the free share C of its area.";
    const KEYS: Keys = &[
        loss::KEYS,
        seat::KEYS,
    ];
    const INPUTS: &'static [InputSpec] = &[InputSpec::OPENING];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        let open_resistance_pa_s2_kg2 = loss::resistance(draft);
        Self {
            open_resistance_pa_s2_kg2,
            leakage_opening: seat::of_loss(draft, open_resistance_pa_s2_kg2, 2.0),
        }
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    fn least_resistance_pa_s2_kg2(&self) -> f32 {
        self.open_resistance_pa_s2_kg2
    }

    fn law(&self, at: &Operating<'_>) -> Law {
        let opening = math::larger(at.inputs.first().copied().unwrap_or(1.0), self.leakage_opening);
        Law::closing(self.open_resistance_pa_s2_kg2 / (opening * opening) / at.density_ratio)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("open_resistance_pa_s2_kg2", self.open_resistance_pa_s2_kg2)?;
        seat::check_closed(self.leakage_opening, self.open_resistance_pa_s2_kg2)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    const HATCH: Hatch = Hatch { open_resistance_pa_s2_kg2: 0.5, leakage_opening: 1e-5 };

    #[test]
    fn half_the_area_carries_half_the_flow() {
        let flow = |opening| (1.0 / HATCH.law(&Operating::plain(&[opening], 0.0)).resistance).sqrt();
        assert!((flow(0.5) / flow(1.0) - 0.5).abs() < 1e-6);
        assert!((flow(0.0) / flow(1.0) - 1e-5).abs() < 1e-10);
    }

    #[test]
    fn bad_parameters_are_named() {
        assert_eq!(Hatch { leakage_opening: 0.0, ..HATCH }.check().unwrap_err().parameter, "leakage_opening");
        let error = Hatch { open_resistance_pa_s2_kg2: 0.0, ..HATCH }.check().unwrap_err();
        assert_eq!(error.parameter, "open_resistance_pa_s2_kg2");
        assert!(HATCH.check().is_ok());
    }
}
