//! Head curve of a turbomachine and the affinity laws.
//!
//! `Δp = ρ·g·h(Q)`, `h(Q) = h0 − h1·Q − h2·Q·|Q|`, Q = w/ρ; at speed ratio N: `N²·h0 − N·h1·Q − h2·Q·|Q|`.
//!
//! Source: Qiu et al. 2017, pressurisation component, whose h(w) is the case ρ = `ρ_ref`; affinity laws
//! Q ∝ N, h ∝ N². A fan is a volume machine: the curve belongs to Q, so that a depressurised cabin gets the
//! right flow. Valid on the falling branch; a stall hump is refused.

use crate::air;
use crate::law::Law;
use crate::parameter::{ParameterError, Reason};

/// Head curve at rated speed, written for mass flow at the line's reference density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadCurve {
    /// Pressure rise at zero flow, ρ·g·h0 [Pa]; finite and ≥ 0.
    pub shutoff_pa: f32,
    /// Linear fall, g·h1 [Pa·s/kg]; finite and ≥ 0.
    pub linear_pa_s_kg: f32,
    /// Quadratic fall, g·h2/ρ [Pa·s²/kg²]; finite and ≥ 0, and > 0 where the linear fall is 0.
    pub quadratic_pa_s2_kg2: f32,
}

impl HeadCurve {
    /// Returns shut-off pressure, linear and quadratic fall of this struct's fields for heads in metres of the
    /// fluid: `h0_m` [m], `h1_s_m2` [s/m²], `h2_s2_m5` [s²/m⁵], at `density_kg_m3` [kg/m³, > 0]. In `f64`: they are
    /// computed once, when a network is made, and then rounded.
    pub fn parameters_of_head(h0_m: f64, h1_s_m2: f64, h2_s2_m5: f64, density_kg_m3: f64) -> [f64; 3] {
        let gravity = f64::from(air::GRAVITY_M_S2);
        [density_kg_m3 * gravity * h0_m, gravity * h1_s_m2, gravity * h2_s2_m5 / density_kg_m3]
    }

    /// Returns the law at `speed` [1, 0 stopped … 1 rated] and `density_ratio` ρ/`ρ_ref` [1, > 0].
    #[inline]
    pub fn law(&self, speed: f32, density_ratio: f32) -> Law {
        Law {
            resistance: self.quadratic_pa_s2_kg2 / density_ratio,
            // Said this way, a curve without linear part is known to have none when the network is compiled in.
            linear: if self.linear_pa_s_kg > 0.0 { speed * self.linear_pa_s_kg } else { 0.0 },
            head: speed * speed * self.shutoff_pa * density_ratio,
        }
    }

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_not_negative("shutoff_pa", self.shutoff_pa)?;
        ParameterError::unless_finite("linear_pa_s_kg", self.linear_pa_s_kg)?;
        ParameterError::unless_finite("quadratic_pa_s2_kg2", self.quadratic_pa_s2_kg2)?;
        // At zero speed only the quadratic part is left, so it alone must keep the machine from being a
        // hole without resistance.
        if self.linear_pa_s_kg < 0.0 {
            return Err(ParameterError { parameter: "linear_pa_s_kg", reason: Reason::NotFalling });
        }
        if self.quadratic_pa_s2_kg2 <= 0.0 {
            return Err(ParameterError { parameter: "quadratic_pa_s2_kg2", reason: Reason::NotFalling });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVE: HeadCurve =
        HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 120.0, quadratic_pa_s2_kg2: 12_984.2 };

    fn rise(speed: f32, density_ratio: f32, w: f32) -> f32 {
        let law = CURVE.law(speed, density_ratio);
        law.head - law.linear * w - law.resistance * w * w.abs()
    }

    #[test]
    fn affinity_laws_hold() {
        // Twice the speed at twice the flow gives four times the head.
        for w in [0.0, 0.02, 0.05, 0.09] {
            assert!((rise(2.0, 1.0, 2.0 * w) - 4.0 * rise(1.0, 1.0, w)).abs() < 1e-3);
        }
    }

    #[test]
    fn the_curve_belongs_to_the_volume_flow() {
        // At half the density the same volume flow is half the mass flow, and every head is half.
        for w in [0.0, 0.02, 0.05] {
            assert!((rise(1.0, 0.5, 0.5 * w) - 0.5 * rise(1.0, 1.0, w)).abs() < 1e-4);
        }
    }

    #[test]
    fn head_in_metres_is_the_same_machine() {
        let (density, w, g) = (1.195_96, 0.06, f64::from(air::GRAVITY_M_S2));
        let q = w / density;
        let [shutoff, linear, quadratic] = HeadCurve::parameters_of_head(25.0, 3.0, 900.0, density);
        let exact = density * g * (25.0 - 3.0 * q - 900.0 * q * q);
        assert!((shutoff - linear * w - quadratic * w * w - exact).abs() < 1e-9);
    }

    #[test]
    fn a_stall_hump_is_refused() {
        let humped = HeadCurve { linear_pa_s_kg: -50.0, ..CURVE };
        assert_eq!(humped.check().unwrap_err().reason, Reason::NotFalling);
        assert!(CURVE.check().is_ok());
    }
}
