//! Electric power of fans and pumps: what they give to the fluid has to come from somewhere.
//!
//! The hydraulic power of a head curve Δp(w) is P = w·Δp(w)/ρ, largest where its slope vanishes:
//! f0 − 2·f1·w − 3·f2·w² = 0. By the affinity laws it goes with the cube of the speed, as the electric power does in
//! the core, so a comparison at rated speed holds at any.

use eclss_core::element::HeadCurve;

use crate::document::Machine;
use crate::limits;

/// Largest hydraulic power [W] of a machine at rated speed in a fluid of `density_kg_m3` [kg/m³, > 0].
fn hydraulic_w(curve: &HeadCurve, density_kg_m3: f64) -> f64 {
    let [shutoff, linear, quadratic] =
        [curve.shutoff_pa, curve.linear_pa_s_kg, curve.quadratic_pa_s2_kg2].map(f64::from);
    let w = (libm::sqrt(linear * linear + 3.0 * shutoff * quadratic) - linear) / (3.0 * quadratic);
    w * (shutoff - linear * w - quadratic * w * w) / density_kg_m3
}

/// Electric power [W] of a machine at rated speed, or the key at fault and why. `density_kg_m3` is 0 where the line has
/// none.
pub(super) fn electric_w(
    machine: &Machine,
    curve: &HeadCurve,
    density_kg_m3: f64,
) -> Result<f64, (&'static str, String)> {
    if machine.power_w.is_some() && machine.efficiency.is_some() {
        return Err(("efficiency", "give the power once: as `power_w` or by an `efficiency`".into()));
    }
    let hydraulic = (density_kg_m3 > 0.0).then(|| hydraulic_w(curve, density_kg_m3));
    match (machine.power_w, hydraulic) {
        // A hair less is rounding of the file's own figures.
        (Some(power), Some(least)) if power < (1.0 - 1e-6) * least => {
            Err(("power_w", format!("`power_w` is less than the {least:.3} W that the machine gives to its stream")))
        }
        (Some(power), _) => Ok(power),
        (None, Some(least)) => Ok(least / machine.efficiency.unwrap_or(limits::MACHINE_EFFICIENCY)),
        (None, None) => Err((
            "kind",
            "its power needs a density, and the line has none at the start: give it a `power_w`, or the line a \
             `reference_density_kg_m3`"
                .into(),
        )),
    }
}

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
