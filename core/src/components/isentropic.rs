//! Isentropic flow of air through an opening, as a resistance.
//!
//! With r = `p_low/p_high`, γ = 1.4 and the effective area `C_d·A`:
//!
//! ```text
//! w = C_d·A·p_high/√(Rg·T)·ψ(r)      ψ² = 2γ/(γ−1)·(r^(2/γ) − r^((γ+1)/γ)) = 7·s¹⁰·(1 − s²),  s = r^(1/7)
//! choked at and below r* = (2/(γ+1))^(γ/(γ−1)) = 0.5283:      ψ² = γ·(2/(γ+1))^((γ+1)/(γ−1)) = 0.4689
//! ```
//!
//! Source: one-dimensional isentropic flow of an ideal gas (de Saint-Venant and Wantzel 1839; any textbook of gas
//! dynamics). T is taken as stagnation temperature of the side of higher pressure. Valid for dry air at 200–400 K
//! through openings short against their width; a discharge coefficient is measured.
//!
//! Methods solve `p_in − p_out = R·w·|w|` with R held within a step. R = y/w² at the present pressures gives the
//! exact flow there, is never negative, and at small y becomes that of a pipe with ξ = `1/C_d²`. Written in s
//! nothing cancels: (1 − r)/(1 − s²) = (1 + s + … + s⁶)/(1 + s).

use crate::{air, math};

/// Pressure ratio at and below which the flow is choked, (2/(γ+1))^(γ/(γ−1)) at γ = 1.4 [1].
pub const CRITICAL_RATIO: f32 = 0.528_281_8;
/// Largest chord slope of the flow over either pressure, per secant w/y, over all pressures [1]. Found by
/// search: reached where one side is a vacuum now and would have 1.37 times the other's pressure at rest.
pub const CHORD_OVER_SECANT: f32 = 1.635;
/// ψ² of choked flow, γ·(2/(γ+1))^((γ+1)/(γ−1)) at γ = 1.4 [1].
const CHOKED: f32 = 0.468_857_1;
/// Lowest pressure at which a resistance is taken [Pa]: between two vacua there is neither flow nor a ratio.
const LOWEST_PA: f32 = 1e-3;

/// Returns R = y/w² [Pa·s²/kg²] of an opening of effective area `area_m2` [m², > 0] between two absolute
/// pressures [Pa], in either order, with gas of `temperature_k` [K, > 0] on the side of the higher one.
#[inline(never)]
pub fn resistance_pa_s2_kg2(area_m2: f32, one_pa: f32, other_pa: f32, temperature_k: f32) -> f32 {
    let (high, low) = if one_pa > other_pa { (one_pa, other_pa) } else { (other_pa, one_pa) };
    let high = math::larger(high, LOWEST_PA);
    let ratio = math::larger(low / high, 0.0);
    let subsonic = math::larger(ratio, CRITICAL_RATIO);
    let s = math::pow(subsonic, 1.0 / 7.0);
    let square = s * s;
    let fourth = square * square;
    // (1 − r)/ψ²: of the subsonic branch at r or at the critical ratio, beyond which ψ no longer changes.
    let sum = 1.0 + s + square + square * s + fourth + fourth * s + fourth * square;
    let open = sum / (7.0 * (fourth * fourth * square) * (1.0 + s));
    let shape = if ratio > CRITICAL_RATIO { open } else { (1.0 - ratio) / CHOKED };
    air::GAS_CONSTANT_J_KG_K * temperature_k / (area_m2 * area_m2 * high) * shape
}

/// Returns the isentropic flow per effective area [kg/(s·m²)] of dry air, γ = 1.4, from `high` to `low` [Pa, absolute] at
/// `temperature_k` [K] upstream: the law of this module in `f64`, for parameters that are derived when a file is read.
pub fn flow_per_area(high: f64, low: f64, temperature_k: f64) -> f64 {
    const GAMMA: f64 = 1.4;
    let critical = libm::pow(2.0 / (GAMMA + 1.0), GAMMA / (GAMMA - 1.0));
    let ratio = if low / high > critical { low / high } else { critical };
    let fall = libm::pow(ratio, 2.0 / GAMMA) - libm::pow(ratio, (GAMMA + 1.0) / GAMMA);
    let gas = f64::from(air::GAS_CONSTANT_J_KG_K) * temperature_k;
    high / libm::sqrt(gas) * libm::sqrt(2.0 * GAMMA / (GAMMA - 1.0) * fall)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The textbook's formula in `f64`.
    fn flow_kg_s(area: f64, high: f64, low: f64, temperature: f64) -> f64 {
        let gamma = 1.4f64;
        let critical = (2.0 / (gamma + 1.0)).powf(gamma / (gamma - 1.0));
        let r = (low / high).max(critical);
        let psi =
            (2.0 * gamma / (gamma - 1.0) * (r.powf(2.0 / gamma) - r.powf((gamma + 1.0) / gamma))).sqrt();
        area * high / (287.05 * temperature).sqrt() * psi
    }

    #[test]
    fn the_whole_range_of_ratios_is_the_isentropic_formula() {
        let mut worst = 0.0f64;
        for area in [1e-12f32, 1e-6, 0.3] {
            for high in [1.0f32, 3e3, 101_325.0, 2e7] {
                for step in 0..=2_000u16 {
                    let low = high * (f32::from(step) / 2_001.0);
                    let resistance = resistance_pa_s2_kg2(area, high, low, 295.15);
                    let y = f64::from(high) - f64::from(low);
                    let found = (y / f64::from(resistance)).sqrt();
                    let exact = flow_kg_s(area.into(), high.into(), low.into(), f64::from(295.15f32));
                    worst = worst.max((found / exact - 1.0).abs());
                    let turned = resistance_pa_s2_kg2(area, low, high, 295.15);
                    assert!((turned - resistance).abs() <= 0.0, "the order of the pressures");
                }
            }
        }
        std::println!("isentropic flow: largest relative error {worst:.1e}");
        assert!(worst < 2e-6, "{worst:e}");
    }

    #[test]
    fn the_choked_flow_of_air_is_the_textbooks() {
        // w·√(Rg·T)/(A·p) = √γ·(2/(γ+1))^((γ+1)/(2(γ−1))) = 0.6847 below the critical ratio.
        for low in [0.0f32, 1e4, 5e4] {
            let resistance = resistance_pa_s2_kg2(1e-4, 1e5, low, 300.0);
            let flow = ((1e5 - low) / resistance).sqrt();
            let number = flow * (287.05f32 * 300.0).sqrt() / (1e-4 * 1e5);
            assert!((number - 0.684_731).abs() < 2e-6, "{number}");
        }
    }

    #[test]
    fn at_a_small_difference_it_is_a_pipe_of_the_same_density() {
        let density = air::density_kg_m3(1e5, 290.0);
        let exact = 1.0 / (2.0 * density * 1e-2 * 1e-2);
        let found = resistance_pa_s2_kg2(1e-2, 1e5, 99_999.9, 290.0);
        assert!((found / exact - 1.0).abs() < 5e-6);
    }

    #[test]
    fn between_vacua_there_is_a_number() {
        for (one, other) in [(0.0, 0.0), (-1.0, 0.0), (0.0, -5.0), (1e-20, 0.0)] {
            let resistance = resistance_pa_s2_kg2(1e-12, one, other, 295.15);
            assert!(resistance.is_finite() && resistance > 0.0, "{one}, {other}: {resistance}");
        }
    }

    /// How steeply the flow changes with each pressure, against the secant w/y that the operator looks at.
    #[test]
    fn chords_are_within_the_bound_of_the_operator() {
        let flow = |p1: f64, p2: f64| {
            if p1 >= p2 { flow_kg_s(1.0, p1, p2, 295.15) } else { -flow_kg_s(1.0, p2, p1, 295.15) }
        };
        // From a vacuum to a hundred times the other pressure, and close by.
        let decades = (0..=120).map(|k| 1e5 * 10f64.powf(f64::from(k) / 24.0 - 3.0));
        let grid: std::vec::Vec<f64> = [0.0, 1e5].into_iter().chain(decades).collect();
        let near: std::vec::Vec<f64> = (-8..=8).map(|k| 1e5 + 1e2 * f64::from(k).powi(3) / 512.0).collect();
        let mut worst = 0.0f64;
        for list in [&grid, &near] {
            for &p1 in list {
                for &p2 in list {
                    let w = flow(p1, p2);
                    if (p1 - p2).abs() < 1e-9 {
                        continue;
                    }
                    let secant = w / (p1 - p2);
                    for &other in list {
                        let inlet = (w - flow(other, p2)) / (p1 - other);
                        let outlet = (w - flow(p1, other)) / (p2 - other);
                        worst = worst.max(inlet / secant).max(-outlet / secant);
                        let noise = 1e-6 * secant;
                        assert!(inlet.is_nan() || inlet >= -noise, "rises with the inlet's pressure");
                        assert!(outlet.is_nan() || outlet <= noise, "falls with the outlet's");
                    }
                }
            }
        }
        std::println!("isentropic flow: largest chord over secant {worst:.4}");
        assert!(worst <= f64::from(CHORD_OVER_SECANT) && worst > 1.62, "{worst}");
    }
}
