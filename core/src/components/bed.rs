//! Adsorption bed (4BMS, trace contaminant control) as a resistance that takes one species out.
//!
//! `p_in − p_out = R·w_in·|w_in|`, `w_out = w_in − w_d`, `w_d = y·η·w_in`.
//!
//! Source: Qiu et al. 2017, resistance component with mass removal. Valid for a given capture efficiency; the
//! sorbent's own state is not modelled here.

use super::loss;
use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::limits::FRACTION;
use crate::parameter::{Key, Keys, ParameterError, Reason};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one bed.
    pub struct Bed {
        /// Quadratic flow resistance R of the packing [Pa·s²/kg²]; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Mass fraction y of the captured species in the air that enters [1]; 0 … 1.
        pub mass_fraction: f32,
        /// Capture efficiency η [1]; 0 … 1.
        pub capture_efficiency: f32,
    }
}

impl Component for Bed {
    const KIND: &'static str = "bed";
    const ABOUT: &'static str = "Adsorption bed that takes out a fixed share of the air that enters.";
    const KEYS: Keys = &[
        loss::KEYS,
        &[
            Key::required("mass_fraction", "1", FRACTION, "Mass fraction of the captured species in the air that enters."),
            Key::required("capture_efficiency", "1", FRACTION, "Share of the species that is captured."),
        ],
    ];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        Self {
            resistance_pa_s2_kg2: loss::resistance(draft),
            mass_fraction: draft.single("mass_fraction"),
            capture_efficiency: draft.single("capture_efficiency"),
        }
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        Law::quadratic(self.resistance_pa_s2_kg2 / at.density_ratio)
    }

    #[inline]
    fn removal(&self) -> f32 {
        // w_d = y·η·w_in = s·w_out with w_in = w_out + w_d.
        let captured = self.mass_fraction * self.capture_efficiency;
        captured / (1.0 - captured)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_not_negative("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        ParameterError::unless_fraction("mass_fraction", self.mass_fraction)?;
        ParameterError::unless_fraction("capture_efficiency", self.capture_efficiency)?;
        // A bed that takes more than half of all air is no bed, and its outlet flow has no meaning at 1.
        if self.mass_fraction * self.capture_efficiency > 0.5 {
            return Err(ParameterError { parameter: "capture_efficiency", reason: Reason::OutsideValidity });
        }
        Ok(())
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn removal_closes_the_mass_balance() {
        let bed = Bed { resistance_pa_s2_kg2: 2e3, mass_fraction: 0.006, capture_efficiency: 0.8 };
        let w_out = 0.01f32;
        let w_in = (1.0 + bed.removal()) * w_out;
        assert!(((w_in - w_out) / (0.006 * 0.8 * w_in) - 1.0).abs() < 1e-4);
    }
}
