//! Pipe: quadratic pressure loss.
//!
//! `p_in − p_out = R·w·|w|`, `R = ξ/(2·ρ·A²)`; of one that can be blocked R/C² at the free share C of its area.
//!
//! Source: Qiu et al. 2017, resistance component. Valid for turbulent flow, |Δp| ≤ 2 kPa, Mach < 0.1; a line
//! becomes linear below its own laminar limit.

use super::loss::{self, Loss, loss_face};
use crate::component::{Component, Draft};
use crate::parameter::{Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one pipe, duct, filter or grille.
    pub struct Pipe {
        /// Quadratic flow resistance R [Pa·s²/kg²] at the line's reference density; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Free share of the area that remains when blocked [1]; 0 for a pipe that cannot be blocked.
        pub least_opening: f32,
    }
}

impl Pipe {
    /// Returns a pipe that cannot be blocked.
    pub const fn new(resistance_pa_s2_kg2: f32) -> Self {
        Self { resistance_pa_s2_kg2, least_opening: 0.0 }
    }

    fn loss(self) -> Loss {
        let Self { resistance_pa_s2_kg2, least_opening } = self;
        Loss { resistance_pa_s2_kg2, least_opening }
    }
}

impl Component for Pipe {
    const KIND: &'static str = "pipe";
    const ABOUT: &'static str = "Duct, filter or grille.";
    const KEYS: Keys = &[loss::KEYS, loss::BLOCKAGE];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        let Loss { resistance_pa_s2_kg2, least_opening } = Loss::from_file(draft);
        Self { resistance_pa_s2_kg2, least_opening }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.loss().check()
    }

    loss_face!();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Operating;

    #[test]
    fn thinner_air_at_the_same_mass_flow_loses_more() {
        let law = |density_ratio| {
            Pipe::new(100.0).law(&Operating { density_ratio, ..Operating::plain(&[], 0.1) }).resistance
        };
        assert!((law(0.5) / law(1.0) - 2.0).abs() < 1e-6);
    }

    #[test]
    fn refuses_negative_and_unreal_resistance() {
        assert!(Pipe::new(-1.0).check().is_err());
        assert!(Pipe::new(f32::INFINITY).check().is_err());
        assert!(Pipe::new(0.0).check().is_ok());
    }
}
