//! Pipe by reference data: one measured loss and an exponent.
//!
//! `Δp = Δp_ref·(ρ_ref/ρ_in)·(w/w_ref)^n`.
//!
//! Source: Qiu et al. 2017, resistance component by reference data. Valid for 1 ≤ n ≤ 2 (laminar to fully
//! turbulent). The law is given to the methods as the curve `R·w|w| + L·w` that touches it at the present
//! flow; below a thousandth of the reference flow it is continued by its tangent curve there.

use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::math;
use crate::parameter::{Key, Keys, ParameterError, Reason};
use crate::component_parameters;

/// Pressure losses of a measurement [Pa].
const DROP: (f64, f64) = (1e-9, 1e7);

/// Smallest flow, as a part of the reference flow, at which the touching curve is taken.
const SMALLEST_PART: f32 = 1e-3;

component_parameters! {
    /// Fixed data of one element known by a measured point.
    pub struct ReferencePipe {
        /// Pressure loss at the reference flow and the line's reference density [Pa]; finite and > 0.
        pub pressure_drop_pa: f32,
        /// Reference flow `w_ref` [kg/s]; finite and > 0.
        pub mass_flow_kg_s: f32,
        /// Exponent n of the flow [1]; 1 … 2.
        pub exponent: f32,
    }
}

impl Component for ReferencePipe {
    const KIND: &'static str = "reference_pipe";
    const ABOUT: &'static str = "Loss known by one measured point and an exponent.";
    const KEYS: Keys = &[&[
        Key::required("pressure_drop_pa", "Pa", DROP, "Measured pressure loss."),
        Key::required("mass_flow_kg_s", "kg/s", (1e-9, 1e3), "Mass flow of the measurement."),
        Key::required("exponent", "1", (1.0, 2.0), "Exponent of the flow."),
        Key::optional("density_kg_m3", "kg/m³", (1e-6, 2e4), "Density of the measurement; the line's when absent."),
    ]];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        // Δp = Δp_ref·(ρ_ref/ρ)·(w/w_ref)^n: the loss that the same flow has at the line's density.
        let measured = draft.number("pressure_drop_pa");
        let drop = match draft.optional("density_kg_m3") {
            None => measured,
            Some(density) => measured * density / draft.density("density_kg_m3"),
        };
        Self {
            pressure_drop_pa: draft.fit("pressure_drop_pa", drop, DROP, "Pa"),
            mass_flow_kg_s: draft.single("mass_flow_kg_s"),
            exponent: draft.single("exponent"),
        }
    }

    #[inline]
    fn is_active(&self) -> bool {
        self.exponent < 2.0
    }

    fn follows_flow(&self) -> bool {
        self.is_active()
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        let part = math::larger((at.mass_flow_kg_s / self.mass_flow_kg_s).abs(), SMALLEST_PART);
        // Chord resistance Δp/w² at this flow; R' and L' match value and slope of the law there.
        let chord = self.pressure_drop_pa / (self.mass_flow_kg_s * self.mass_flow_kg_s * at.density_ratio)
            * math::pow(part, self.exponent - 2.0);
        Law {
            resistance: (self.exponent - 1.0) * chord,
            linear: (2.0 - self.exponent) * chord * part * self.mass_flow_kg_s,
            head: 0.0,
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("pressure_drop_pa", self.pressure_drop_pa)?;
        ParameterError::unless_positive("mass_flow_kg_s", self.mass_flow_kg_s)?;
        ParameterError::unless_finite("exponent", self.exponent)?;
        if !(1.0..=2.0).contains(&self.exponent) {
            return Err(ParameterError { parameter: "exponent", reason: Reason::OutsideValidity });
        }
        let chord = self.pressure_drop_pa / (self.mass_flow_kg_s * self.mass_flow_kg_s);
        ParameterError::unless_finite("pressure_drop_pa", chord * 1e3)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    fn drop_pa(pipe: &ReferencePipe, w: f32) -> f32 {
        let law = pipe.law(&Operating::plain(&[], w));
        law.resistance * w * w.abs() + law.linear * w - law.head
    }

    #[test]
    fn goes_through_its_reference_point_and_scales_with_the_exponent() {
        let pipe = ReferencePipe { pressure_drop_pa: 40.0, mass_flow_kg_s: 0.05, exponent: 1.8 };
        assert!((drop_pa(&pipe, 0.05) / 40.0 - 1.0).abs() < 1e-6);
        assert!((drop_pa(&pipe, 0.1) / drop_pa(&pipe, 0.05) - 2f32.powf(1.8)).abs() < 1e-5);
        assert!((drop_pa(&pipe, -0.1) + drop_pa(&pipe, 0.1)).abs() < 1e-5);
    }

    #[test]
    fn the_touching_curve_has_the_slope_of_the_law() {
        let pipe = ReferencePipe { pressure_drop_pa: 40.0, mass_flow_kg_s: 0.05, exponent: 1.4 };
        for w in [0.001f32, 0.02, 0.3] {
            let law = pipe.law(&Operating::plain(&[], w));
            let slope = f64::from(2.0 * law.resistance * w + law.linear);
            let exact = 1.4 * 40.0 / 0.05 * (f64::from(w) / 0.05).powf(0.4);
            assert!((slope / exact - 1.0).abs() < 1e-5, "{w}: {slope} against {exact}");
        }
    }

    #[test]
    fn exponent_two_is_a_pipe() {
        let reference = ReferencePipe { pressure_drop_pa: 40.0, mass_flow_kg_s: 0.05, exponent: 2.0 };
        assert!(!reference.is_active());
        assert!((drop_pa(&reference, 0.02) - 40.0 / 0.0025 * 0.0004).abs() < 1e-5);
    }
}
