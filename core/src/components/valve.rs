//! Control valve: resistance as a power of the opening.
//!
//! `p_in − p_out = R(C)·w·|w|`, `R(C) = k·C^(−n)`.
//!
//! Source: the valve of Qiu et al. 2017 with the reading of its two printed steady flows; k and n are fitted
//! to a manufacturer's curve in any other use. A closed valve keeps a leakage opening, that of its seat's leak: `k·0^(−n)`
//! has no value.

use super::seat;
use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::math;
use crate::parameter::{InputSpec, Key, Keys, ParameterError, Reason};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one valve.
    pub struct Valve {
        /// Resistance k when fully open [Pa·s²/kg²] at the line's reference density; finite and > 0.
        pub open_resistance_pa_s2_kg2: f32,
        /// Exponent n of the opening [1]; 0 … 6.
        pub exponent: f32,
        /// Opening that remains when closed, `C_min` [1]; 1e-18 … 1.
        pub leakage_opening: f32,
    }
}

impl Valve {
    /// Returns R(C) [Pa·s²/kg²] for `opening` [1, 0 closed … 1 open].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "half as dear where the exponent is known to the compiler")]
    pub fn resistance_pa_s2_kg2(&self, opening: f32) -> f32 {
        let opening = math::larger(opening, self.leakage_opening);
        // The orifice's own exponent needs no power.
        if self.exponent.to_bits() == 2.0f32.to_bits() {
            return self.open_resistance_pa_s2_kg2 / (opening * opening);
        }
        self.open_resistance_pa_s2_kg2 * math::pow(opening, -self.exponent)
    }
}

impl Component for Valve {
    const KIND: &'static str = "valve";
    const ABOUT: &'static str = "Control valve: R(C) = k·C^(−n) at the opening C.";
    const KEYS: Keys = &[&[
        Key::required("open_resistance_pa_s2_kg2", "Pa·s²/kg²", (1e-6, 1e15), "Resistance k when fully open."),
        Key::required("exponent", "1", (0.0, 6.0), "Exponent n of the opening."),
    ], seat::KEYS];
    const INPUTS: &'static [InputSpec] = &[InputSpec::OPENING];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        let open_resistance_pa_s2_kg2 = draft.single("open_resistance_pa_s2_kg2");
        let exponent = draft.number("exponent");
        Self {
            open_resistance_pa_s2_kg2,
            exponent: exponent as f32,
            leakage_opening: seat::of_loss(draft, open_resistance_pa_s2_kg2, exponent),
        }
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    #[inline]
    fn may_be_linear(&self) -> bool {
        false
    }

    fn least_resistance_pa_s2_kg2(&self) -> f32 {
        self.resistance_pa_s2_kg2(1.0)
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "like the resistance")]
    fn law(&self, at: &Operating<'_>) -> Law {
        let opening = at.inputs.first().copied().unwrap_or(1.0);
        Law::closing(self.resistance_pa_s2_kg2(opening) / at.density_ratio)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("open_resistance_pa_s2_kg2", self.open_resistance_pa_s2_kg2)?;
        seat::check(self.leakage_opening)?;
        ParameterError::unless_not_negative("exponent", self.exponent)?;
        if self.exponent > 6.0 {
            return Err(ParameterError { parameter: "exponent", reason: Reason::OutsideValidity });
        }
        // The closed valve must still have a finite square in f32 (R·w² with w ≤ 1e3 kg/s).
        let closed = self.resistance_pa_s2_kg2(0.0);
        ParameterError::unless_finite("open_resistance_pa_s2_kg2", closed * 1e6)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: Valve =
        Valve { open_resistance_pa_s2_kg2: 85.978_46, exponent: 3.134_165, leakage_opening: 1e-3 };

    #[test]
    fn closing_never_lowers_the_resistance() {
        let mut last = 0.0;
        for step in (0..=10_000).rev() {
            let r = PAPER.resistance_pa_s2_kg2(step as f32 * 1e-4);
            assert!(r >= last, "at opening {}", step as f32 * 1e-4);
            last = r;
        }
        assert!(last.is_finite());
    }

    #[test]
    fn follows_its_power_law() {
        for opening in [1.0f32, 0.5, 0.2, 0.1, 0.02] {
            let exact = 85.978_46 * f64::from(opening).powf(-f64::from(PAPER.exponent));
            assert!((f64::from(PAPER.resistance_pa_s2_kg2(opening)) / exact - 1.0).abs() < 4e-7);
        }
    }

    #[test]
    fn an_unlimited_closed_valve_is_refused() {
        let valve = Valve { exponent: 9.0, ..PAPER };
        assert_eq!(valve.check().unwrap_err().parameter, "exponent");
        assert_eq!(Valve { leakage_opening: 0.0, ..PAPER }.check().unwrap_err().parameter, "leakage_opening");
        assert!(PAPER.check().is_ok());
    }
}
