//! Quadratic loss of a duct, which may be blocked: shared by every component that is a passage with something in it.
//!
//! `p_in − p_out = R/C²·w·|w|`, C the free share of the area; `R = ξ/(2·ρ·A²)`.
//!
//! Source: Qiu et al. 2017, resistance component.

use crate::component::Draft;
use crate::law::{Law, Operating};
use crate::math;
use crate::parameter::{Key, ParameterError};

/// Quadratic resistances [Pa·s²/kg²].
const RESISTANCE: (f64, f64) = (0.0, 1e15);
/// Free share of the area that remains of a blocked one [1].
const LEAST_OPENING: f32 = 1e-3;

/// Keys of a loss, given in one of two ways.
pub const KEYS: &[Key] = &[
    Key::optional(
        "resistance_pa_s2_kg2",
        "Pa·s²/kg²",
        RESISTANCE,
        "R in Δp = R·w·|w|; or a `loss_coefficient`.",
    ),
    Key::optional(
        "loss_coefficient",
        "1",
        (0.0, 1e9),
        "ξ in Δp = ξ·ρ·v²/2 on the component's own flow area.",
    ),
];

/// Key of a passage that can be blocked.
pub const BLOCKAGE: &[Key] = &[Key::flag(
    "blockable",
    "Whether it can be blocked; it has an input `opening` then, the free share of its area.",
)];

/// Returns R [Pa·s²/kg²] of a loss coefficient `xi` [1, ≥ 0] on a flow area `area_m2` [m², > 0] for a fluid of
/// `density_kg_m3` [kg/m³, > 0]. In `f64`: it is computed once, when a network is made, and then rounded.
pub fn resistance_of_loss_coefficient(xi: f64, area_m2: f64, density_kg_m3: f64) -> f64 {
    xi / (2.0 * density_kg_m3 * area_m2 * area_m2)
}

/// Returns R [Pa·s²/kg²] of a table with [`KEYS`].
pub fn resistance(draft: &mut Draft<'_>) -> f32 {
    let (key, coefficient) = ("loss_coefficient", "as `loss_coefficient` with a diameter or area");
    match (draft.optional("resistance_pa_s2_kg2"), draft.optional(key)) {
        (Some(resistance), None) => resistance as f32,
        (None, Some(xi)) => {
            let (density, area) = (draft.density(key), draft.area(key));
            draft.fit(key, resistance_of_loss_coefficient(xi, area, density), RESISTANCE, "Pa·s²/kg²")
        }
        _ => {
            draft
                .refuse(key, format_args!("give the loss once: as `resistance_pa_s2_kg2`, or {coefficient}"));
            1.0
        }
    }
}

/// Refuses a loss beside an area of discharge.
pub(super) fn none(draft: &mut Draft<'_>) -> f32 {
    for key in ["resistance_pa_s2_kg2", "loss_coefficient"] {
        if draft.optional(key).is_some() {
            draft.refuse(key, format_args!("`{key}` and `discharge_coefficient` exclude each other"));
        }
    }
    0.0
}

/// Loss of a passage that may be blocked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// Quadratic flow resistance R [Pa·s²/kg²] at the line's reference density; finite and ≥ 0.
    pub resistance_pa_s2_kg2: f32,
    /// Free share of the area that remains when blocked [1]; 1e-4 … 1, or 0 for a passage that cannot be blocked.
    pub least_opening: f32,
}

impl Loss {
    /// Returns the loss of a table with [`KEYS`] and [`BLOCKAGE`].
    pub fn from_file(draft: &mut Draft<'_>) -> Self {
        let least_opening = if draft.flag("blockable") { LEAST_OPENING } else { 0.0 };
        Self { resistance_pa_s2_kg2: resistance(draft), least_opening }
    }

    /// Whether it can be blocked.
    #[inline]
    pub fn is_blockable(&self) -> bool {
        self.least_opening > 0.0
    }

    /// States the law; its opening is input `place`.
    #[inline]
    pub fn law(&self, at: &Operating<'_>, place: usize) -> Law {
        if !self.is_blockable() {
            return Law::quadratic(self.resistance_pa_s2_kg2 / at.density_ratio);
        }
        let opening = math::larger(at.inputs.get(place).copied().unwrap_or(1.0), self.least_opening);
        Law::quadratic(self.resistance_pa_s2_kg2 / (opening * opening * at.density_ratio))
    }

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        if !self.is_blockable() {
            ParameterError::unless_finite("least_opening", self.least_opening)?;
            return ParameterError::unless_not_negative("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2);
        }
        ParameterError::unless_positive("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        super::seat::check_closed(self.least_opening, self.resistance_pa_s2_kg2)
    }
}

/// Writes the law face of a component with a loss, behind whose own inputs the opening stands.
macro_rules! loss_face {
    ($($own:expr),*) => {
        const INPUTS: &'static [$crate::parameter::InputSpec] = &[$($own,)* $crate::parameter::InputSpec::OPENING];

        fn input_spec(&self, index: usize) -> Option<$crate::parameter::InputSpec> {
            let exists = index + 1 < Self::INPUTS.len() || self.loss().is_blockable();
            Self::INPUTS.get(index).copied().filter(|_| exists)
        }

        #[inline]
        fn is_active(&self) -> bool {
            self.loss().is_blockable()
        }

        fn may_be_linear(&self) -> bool {
            false
        }

        fn least_resistance_pa_s2_kg2(&self) -> f32 {
            self.resistance_pa_s2_kg2
        }

        #[inline]
        fn law(&self, at: &$crate::law::Operating<'_>) -> $crate::law::Law {
            self.loss().law(at, Self::INPUTS.len() - 1)
        }
    };
}
pub(super) use loss_face;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loss_is_the_dynamic_pressure_times_xi() {
        // Δp = ξ·ρ/2·v² with v = w/(ρ·A), an independent way to write the same law.
        let (xi, area, density, w) = (1.7, 0.00785, 1.196, 0.0865);
        let velocity = w / (density * area);
        let dp = resistance_of_loss_coefficient(xi, area, density) * w * w;
        assert!((dp / (xi * 0.5 * density * velocity * velocity) - 1.0f64).abs() < 1e-12);
    }

    #[test]
    fn half_the_area_has_four_times_the_loss() {
        let loss = Loss { resistance_pa_s2_kg2: 100.0, least_opening: 1e-3 };
        let at = |opening: f32| loss.law(&Operating::plain(&[opening], 0.1), 0).resistance;
        assert!((at(0.5) / at(1.0) - 4.0).abs() < 1e-6);
        assert!(at(0.0).is_finite());
    }
}
