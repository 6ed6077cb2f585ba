//! Condensing heat exchanger (CHE) as the paper has it: a resistance that takes condensate out.
//!
//! `p_in − p_out = R·w_in·|w_in|`, `w_out = w_in − w_d`, `w_d = s·w_out`, `s = ε·x_liq`.
//!
//! Source: Qiu et al. 2017, resistance component with mass removal; patent CN105677969B for ε and `x_liq`.
//! Valid for a given condensate share; heat and moisture themselves are not modelled here.

use super::loss;
use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::limits::FRACTION;
use crate::parameter::{Key, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one condensing heat exchanger.
    pub struct HeatExchanger {
        /// Quadratic flow resistance R of the air side [Pa·s²/kg²]; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Mass of liquid per mass of air that leaves, `x_liq` [1]; 0 … 1.
        pub liquid_fraction: f32,
        /// Share of the liquid that the separator takes out, ε [1]; 0 … 1.
        pub separator_efficiency: f32,
    }
}

impl Component for HeatExchanger {
    const KIND: &'static str = "heat_exchanger";
    const ABOUT: &'static str = "Condensing heat exchanger of the paper: a loss that takes out a fixed share of condensate.";
    const KEYS: Keys = &[
        loss::KEYS,
        &[
            Key::required("liquid_fraction", "1", FRACTION, "Mass of liquid per mass of air that leaves."),
            Key::required("separator_efficiency", "1", FRACTION, "Share of the liquid that the separator takes out."),
        ],
    ];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        Self {
            resistance_pa_s2_kg2: loss::resistance(draft),
            liquid_fraction: draft.single("liquid_fraction"),
            separator_efficiency: draft.single("separator_efficiency"),
        }
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        Law::quadratic(self.resistance_pa_s2_kg2 / at.density_ratio)
    }

    #[inline]
    fn removal(&self) -> f32 {
        self.separator_efficiency * self.liquid_fraction
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_not_negative("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        ParameterError::unless_fraction("liquid_fraction", self.liquid_fraction)?;
        ParameterError::unless_fraction("separator_efficiency", self.separator_efficiency)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_separated_liquid_leaves_the_air() {
        let che = HeatExchanger {
            resistance_pa_s2_kg2: 16_007.0,
            liquid_fraction: 0.005,
            separator_efficiency: 0.9,
        };
        assert!((che.removal() - 0.0045).abs() < 1e-9);
        assert!(HeatExchanger { separator_efficiency: 0.0, ..che }.removal().abs() < f32::MIN_POSITIVE);
        assert_eq!(
            HeatExchanger { liquid_fraction: 1.5, ..che }.check().unwrap_err().parameter,
            "liquid_fraction"
        );
    }
}
