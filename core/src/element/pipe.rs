//! Pipe: quadratic pressure loss.
//!
//! `p_in − p_out = R·w·|w|`, `R = ξ/(2·ρ·A²)`.
//!
//! Source: Qiu et al. 2017, resistance component. Valid for turbulent flow, |Δp| ≤ 2 kPa, Mach < 0.1; a line
//! becomes linear below its own laminar limit.

use super::{Element, InputSpec, Law, Operating, ParameterError};
use crate::Fingerprint;

/// Fixed data of one pipe, duct, filter or grille.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pipe {
    /// Quadratic flow resistance R [Pa·s²/kg²] at the line's reference density; finite and ≥ 0.
    pub resistance_pa_s2_kg2: f32,
}

impl Pipe {
    /// Returns R [Pa·s²/kg²] of a loss coefficient `xi` [1, ≥ 0] on a flow area `area_m2` [m², > 0] for gas of
    /// `density_kg_m3` [kg/m³, > 0]. In `f64`: it is computed once, when a network is made, and then rounded.
    pub fn resistance_of_loss_coefficient(xi: f64, area_m2: f64, density_kg_m3: f64) -> f64 {
        xi / (2.0 * density_kg_m3 * area_m2 * area_m2)
    }
}

impl Element for Pipe {
    fn input_spec(&self, _index: usize) -> Option<InputSpec> {
        None
    }

    #[inline]
    fn is_active(&self) -> bool {
        false
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        Law::quadratic(self.resistance_pa_s2_kg2 / at.density_ratio)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_not_negative("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)
    }

    fn feed(&self, hash: &mut Fingerprint) {
        hash.word(1);
        hash.value(self.resistance_pa_s2_kg2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loss_is_the_dynamic_pressure_times_xi() {
        // Δp = ξ·ρ/2·v² with v = w/(ρ·A), an independent way to write the same law.
        let (xi, area, density, w) = (1.7, 0.00785, 1.196, 0.0865);
        let velocity = w / (density * area);
        let dp = Pipe::resistance_of_loss_coefficient(xi, area, density) * w * w;
        assert!((dp / (xi * 0.5 * density * velocity * velocity) - 1.0f64).abs() < 1e-12);
    }

    #[test]
    fn thinner_air_at_the_same_mass_flow_loses_more() {
        let law = |density_ratio| {
            Pipe { resistance_pa_s2_kg2: 100.0 }
                .law(&Operating { density_ratio, ..Operating::plain(&[], 0.1) })
                .resistance
        };
        assert!((law(0.5) / law(1.0) - 2.0).abs() < 1e-6);
    }

    #[test]
    fn refuses_negative_and_unreal_resistance() {
        assert!(Pipe { resistance_pa_s2_kg2: -1.0 }.check().is_err());
        assert!(Pipe { resistance_pa_s2_kg2: f32::INFINITY }.check().is_err());
        assert!(Pipe { resistance_pa_s2_kg2: 0.0 }.check().is_ok());
    }
}
