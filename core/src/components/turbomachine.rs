//! Fan and pump alike: keys of a head curve, electric power, and the face of its law.
//!
//! The hydraulic power of a head curve Δp(w) is P = w·Δp(w)/ρ, largest where its slope vanishes:
//! f0 − 2·f1·w − 3·f2·w² = 0. By the affinity laws it goes with the cube of the speed, as the electric power does, so a
//! comparison at rated speed holds at any.

use super::HeadCurve;
use crate::component::Draft;
use crate::parameter::Key;

/// Largest hydraulic power over the electric one when the file gives neither power nor efficiency [1] (assumed).
const EFFICIENCY: f64 = 0.5;
/// Shut-off pressures [Pa].
const SHUTOFF: (f64, f64) = (0.0, 1e7);
/// Linear falls [Pa·s/kg] and [s/m²].
const LINEAR: (f64, f64) = (0.0, 1e12);
/// Quadratic falls [Pa·s²/kg²] and [s²/m⁵].
const QUADRATIC: (f64, f64) = (1e-6, 1e15);

/// Keys of a head curve, given in one of two ways, and of the electric power.
pub(super) const KEYS: &[Key] = &[
    Key::optional("shutoff_pa", "Pa", SHUTOFF, "Pressure rise at zero flow; or a curve by `h0_m`."),
    Key::optional("linear_pa_s_kg", "Pa·s/kg", LINEAR, "Linear fall; 0 when absent."),
    Key::optional("quadratic_pa_s2_kg2", "Pa·s²/kg²", QUADRATIC, "Quadratic fall."),
    Key::optional("h0_m", "m", (0.0, 1e6), "Head at zero flow of h = h0 − h1·Q − h2·Q²."),
    Key::optional("h1_s_m2", "s/m²", LINEAR, "Linear fall of the head; 0 when absent."),
    Key::optional("h2_s2_m5", "s²/m⁵", QUADRATIC, "Quadratic fall of the head."),
    Key::optional(
        "power_w",
        "W",
        (0.0, 1e6),
        "Electric power at rated speed, which heats the fluid; from the efficiency when absent, needs `[air]`.",
    ),
    Key::optional(
        "efficiency",
        "1",
        (0.01, 1.0),
        "Largest hydraulic power over the electric one; 0.5 when both are absent, needs `[air]`.",
    ),
];

/// Returns a number that a way to give the curve must have.
fn need(draft: &mut Draft<'_>, key: &'static str) -> f64 {
    draft.optional(key).unwrap_or_else(|| {
        draft.refuse(key, format_args!("`{key}` is missing"));
        1.0
    })
}

/// Returns the head curve over mass flow, Δp = ρ·g·h(w/ρ), of a table with [`KEYS`].
pub(super) fn curve(draft: &mut Draft<'_>) -> HeadCurve {
    if draft.optional("h0_m").is_none() {
        for key in ["h1_s_m2", "h2_s2_m5"] {
            if draft.optional(key).is_some() {
                draft.refuse(key, format_args!("`{key}` belongs to a curve by heads, which needs `h0_m`"));
            }
        }
        return HeadCurve {
            shutoff_pa: need(draft, "shutoff_pa") as f32,
            linear_pa_s_kg: draft.single("linear_pa_s_kg"),
            quadratic_pa_s2_kg2: need(draft, "quadratic_pa_s2_kg2") as f32,
        };
    }
    for key in ["shutoff_pa", "linear_pa_s_kg", "quadratic_pa_s2_kg2"] {
        if draft.optional(key).is_some() {
            draft.refuse(key, format_args!("give the curve once: by heads, or by pressures"));
        }
    }
    let density = draft.density("h0_m");
    let heads = (need(draft, "h0_m"), draft.number("h1_s_m2"), need(draft, "h2_s2_m5"));
    let [shutoff, linear, quadratic] = HeadCurve::parameters_of_head(heads.0, heads.1, heads.2, density);
    HeadCurve {
        shutoff_pa: draft.fit("h0_m", shutoff, SHUTOFF, "Pa"),
        linear_pa_s_kg: draft.fit("h1_s_m2", linear, LINEAR, "Pa·s/kg"),
        quadratic_pa_s2_kg2: draft.fit("h2_s2_m5", quadratic, QUADRATIC, "Pa·s²/kg²"),
    }
}

/// Returns the largest hydraulic power [W] at rated speed in a fluid of `density_kg_m3` [kg/m³, > 0].
fn hydraulic_w(curve: &HeadCurve, density_kg_m3: f64) -> f64 {
    let [shutoff, linear, quadratic] =
        [curve.shutoff_pa, curve.linear_pa_s_kg, curve.quadratic_pa_s2_kg2].map(f64::from);
    let w = (libm::sqrt(linear * linear + 3.0 * shutoff * quadratic) - linear) / (3.0 * quadratic);
    w * (shutoff - linear * w - quadratic * w * w) / density_kg_m3
}

/// Returns the electric power at rated speed [W] of a table with [`KEYS`]; 0 in a network without heat.
pub(super) fn power_w(draft: &mut Draft<'_>, curve: &HeadCurve) -> f32 {
    let (power, efficiency) = (draft.optional("power_w"), draft.optional("efficiency"));
    if !draft.line.has_air {
        for (key, value) in [("power_w", power), ("efficiency", efficiency)] {
            if value.is_some() {
                draft.refuse(key, format_args!("this needs heat and moisture: add a table `[air]`"));
            }
        }
        return 0.0;
    }
    if power.is_some() && efficiency.is_some() {
        draft.refuse("efficiency", format_args!("give the power once: as `power_w` or by an `efficiency`"));
    }
    let density = draft.line.density_kg_m3;
    let hydraulic = (density > 0.0).then(|| hydraulic_w(curve, density));
    match (power, hydraulic) {
        // A hair less is rounding of the file's own figures.
        (Some(power), Some(least)) if power < (1.0 - 1e-6) * least => {
            let reason = "W that the machine gives to its stream";
            draft.refuse("power_w", format_args!("`power_w` is less than the {least:.3} {reason}"));
            0.0
        }
        (Some(power), _) => power as f32,
        (None, Some(least)) => (least / efficiency.unwrap_or(EFFICIENCY)) as f32,
        (None, None) => {
            let help = "give it a `power_w`, or the line a `reference_density_kg_m3`";
            let reason = "its power needs a density, and the line has none at the start";
            draft.refuse("kind", format_args!("{reason}: {help}"));
            0.0
        }
    }
}

/// Writes a component that is a head curve at a speed, with an electric power.
macro_rules! turbomachine {
    (face) => {
        const INPUTS: &'static [InputSpec] = &[InputSpec::SPEED];
        const SIDES: &'static [Carries] = &[Carries::Any];

        fn pass(
            &self,
            placed: &Placed,
            step: &StepContext<'_>,
            passing: &Passing<'_>,
            _block: Block<'_>,
            stream: &mut Stream,
        ) -> Heat {
            let [speed] = step.inputs_of(placed.first_input);
            let outside_j = self.power_w * speed * speed * speed * step.step_s;
            Heat { outside_j, left_j: stream.warm(outside_j, passing.medium, step.reference_k) }
        }

        fn from_file(draft: &mut Draft<'_>) -> Self {
            let curve = turbomachine::curve(draft);
            Self { power_w: turbomachine::power_w(draft, &curve), ..Self::new(curve) }
        }

        fn check(&self) -> Result<(), ParameterError> {
            ParameterError::unless_not_negative("power_w", self.power_w)?;
            self.curve().check()
        }

        #[inline]
        fn is_active(&self) -> bool {
            true
        }

        #[inline]
        fn may_be_linear(&self) -> bool {
            self.linear_pa_s_kg > 0.0
        }

        #[inline]
        fn law(&self, at: &Operating<'_>) -> Law {
            self.curve().law(at.inputs.first().copied().unwrap_or(1.0), at.density_ratio)
        }
    };
    ($name:ident) => {
        impl $name {
            /// Returns a machine of this head curve without electric power.
            pub const fn new(curve: HeadCurve) -> Self {
                let HeadCurve { shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2 } = curve;
                Self { shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2, power_w: 0.0 }
            }

            /// Returns the head curve.
            #[inline]
            pub const fn curve(&self) -> HeadCurve {
                let Self { shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2, .. } = *self;
                HeadCurve { shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2 }
            }
        }
    };
}
pub(super) use turbomachine;

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest of the product itself, by walking along the curve.
    #[test]
    fn the_largest_hydraulic_power_is_where_the_curve_says() {
        for (shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2) in
            [(300.0, 0.0, 12_984.2), (5e4, 1e5, 2e6), (900.0, 4_000.0, 1.0), (0.0, 0.0, 5.0)]
        {
            let curve = HeadCurve { shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2 };
            let [a, b, c] = [shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2].map(f64::from);
            let most = (0..200_000)
                .map(|step| f64::from(step) * 5e-6)
                .map(|w| w * (a - b * w - c * w * w) / 1.2)
                .fold(0.0, f64::max);
            let found = hydraulic_w(&curve, 1.2);
            assert!((found - most).abs() <= 1e-6 * most, "{found} W for {most} W");
        }
    }
}
