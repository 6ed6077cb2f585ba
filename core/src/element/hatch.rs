//! Hatch: a large opening between two modules, open, closed or between.
//!
//! `p_in − p_out = R/C²·w·|w|`, `R = ξ/(2·ρ·A²)`, C the free part of the area.
//!
//! Source: the quadratic loss of Qiu et al. 2017 on the hatch's own area; ξ is the user's (a sharp-edged hole
//! between large rooms has about 2.7, which is 1/0.61²). Pressure differences between open cabins are small: 1 Pa
//! drives about 1 kg/s through 1 m². A closed hatch keeps the leak
//! of its seal.

use super::{Element, InputSpec, Law, Operating, ParameterError, Reason};
use crate::{Fingerprint, math};

/// Fixed data of one hatch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hatch {
    /// Resistance R when fully open [Pa·s²/kg²] at the line's reference density; finite and > 0.
    pub open_resistance_pa_s2_kg2: f32,
    /// Part of the area that remains when closed [1]; 1e-18 … 1.
    pub leakage_opening: f32,
}

/// Refuses a leakage opening outside 1e-18 … 1.
pub(super) fn check_leakage(opening: f32) -> Result<(), ParameterError> {
    ParameterError::unless_fraction("leakage_opening", opening)?;
    if opening < super::LEAST_LEAKAGE {
        return Err(ParameterError { parameter: "leakage_opening", reason: Reason::OutsideValidity });
    }
    Ok(())
}

/// Refuses a leakage opening of a quadratic loss whose closed resistance has no finite square.
pub(super) fn check_closed(opening: f32, open_resistance: f32) -> Result<(), ParameterError> {
    check_leakage(opening)?;
    // R·w² with w ≤ 1e3 kg/s.
    if (open_resistance / (opening * opening) * 1e6).is_finite() {
        return Ok(());
    }
    Err(ParameterError { parameter: "leakage_opening", reason: Reason::OutsideValidity })
}

impl Element for Hatch {
    fn input_spec(&self, index: usize) -> Option<InputSpec> {
        let opening = InputSpec { name: "opening", unit: "1", min: 0.0, max: 1.0, default: 1.0 };
        (index == 0).then_some(opening)
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
        check_closed(self.leakage_opening, self.open_resistance_pa_s2_kg2)
    }

    fn feed(&self, hash: &mut Fingerprint) {
        hash.word(12);
        hash.values(&[self.open_resistance_pa_s2_kg2, self.leakage_opening]);
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
