//! Saturation of water vapour over liquid water.
//!
//! `p_s(T) = 611.21·exp((18.678 − t/234.5)·t/(257.14 + t))` Pa with t in °C.
//!
//! Source: A. L. Buck, J. Appl. Meteorol. 20 (1981), constants of the Buck Research manual of 1996. Valid here for
//! 0…60 °C over liquid water, where it stays within 0.1 % of the ASHRAE formula; no enhancement factor.

use super::ZERO_CELSIUS_K;
use crate::math;

const AT_ZERO_PA: f32 = 611.21;
const A: f32 = 18.678;
const B: f32 = 234.5;
const C: f32 = 257.14;
/// 30 °C [K].
const MIDDLE_K: f32 = 303.15;

/// Where the polynomial has its least value, −68 °C [K]: colder, it would rise again.
const COLDEST_K: f32 = 205.15;

/// Root of the pressure over the middle of the range, in x = (t − 30)/30: least largest relative error, 9.4e-8 in the
/// pressure (`docs/theory.md`). A square cannot fall below zero, whatever the argument.
const ROOT: [f32; 7] =
    [65.154_63, 56.105_69, 17.859_41, 2.169_027, -0.039_770_704, -0.022_407_087, 0.000_699_361_1];

/// Returns the pressure of water vapour over liquid water [Pa] at `temperature_k` [K], 273.15…333.15.
///
/// A polynomial takes the place of the exponential in a step: half the operations. Outside that range it stays near the
/// formula: within 3 % from −40 to 120 °C, within a factor of 1.6 down to −60 °C; what is colder than −68 °C has the 2 Pa of there.
#[inline]
pub fn saturation_pressure_pa(temperature_k: f32) -> f32 {
    let x = (math::larger(temperature_k, COLDEST_K) - MIDDLE_K) * (1.0 / 30.0);
    let mut root = ROOT[6];
    for coefficient in [ROOT[5], ROOT[4], ROOT[3], ROOT[2], ROOT[1], ROOT[0]] {
        root = root * x + coefficient;
    }
    root * root
}

/// Returns `dp_s/dT` [Pa/K] at `temperature_k` [K], 273.15…333.15.
#[inline]
pub fn saturation_slope_pa_k(temperature_k: f32) -> f32 {
    let t = temperature_k - ZERO_CELSIUS_K;
    // d/dt of the exponent: ((A − 2·t/B)·(C + t) − (A − t/B)·t)/(C + t)²
    let sum = C + t;
    let slope = ((A - 2.0 * t * (1.0 / B)) * sum - (A - t * (1.0 / B)) * t) / (sum * sum);
    saturation_pressure_pa(temperature_k) * slope
}

/// Returns the temperature [K] at which air whose vapour has `vapour_pa` [Pa, 1…20 000] begins to condense.
///
/// The formula above solved for t: with L = `ln(p_v/611.21)`, t²/B + (L − A)·t + L·C = 0. Below about 611 Pa the
/// answer is a dew point over supercooled water. A vapour pressure below 1 Pa counts as 1 Pa.
pub fn dew_point_k(vapour_pa: f32) -> f32 {
    let l = math::ln(math::larger(vapour_pa, 1.0) * (1.0 / AT_ZERO_PA));
    let b = A - l;
    ZERO_CELSIUS_K + 2.0 * C * l / (b + math::sqrt(b * b - l * (4.0 * C / B)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(t: f64) -> f64 {
        611.21 * ((18.678 - t / 234.5) * (t / (257.14 + t))).exp()
    }

    fn temperatures() -> impl Iterator<Item = f32> {
        (0..=60_000).map(|step| 273.15 + step as f32 * 1e-3)
    }

    #[test]
    fn pressure_and_slope_are_within_their_documented_errors() {
        let (mut pressure, mut slope) = (0.0f64, 0.0f64);
        for temperature in temperatures() {
            // The rounding of 273.15 itself is 2e-6 K; it belongs to the argument, not to the formula.
            let t = f64::from(temperature - ZERO_CELSIUS_K);
            pressure = pressure.max((f64::from(saturation_pressure_pa(temperature)) / exact(t) - 1.0).abs());
            let difference = (exact(t + 1e-4) - exact(t - 1e-4)) / 2e-4;
            slope = slope.max((f64::from(saturation_slope_pa_k(temperature)) / difference - 1.0).abs());
        }
        std::println!("saturation: largest relative error {pressure:.2e}, slope {slope:.2e}");
        assert!(pressure < 8e-7 && slope < 1e-6, "{pressure:e} {slope:e}");
    }

    #[test]
    fn dew_point_undoes_saturation() {
        let mut worst = 0.0f64;
        for temperature in temperatures() {
            let t = f64::from(temperature) - 273.15;
            let dew = f64::from(dew_point_k(exact(t) as f32));
            assert!(dew.is_finite());
            worst = worst.max((dew - 273.15 - t).abs());
        }
        std::println!("dew point: largest error {worst:.2e} K");
        assert!(worst < 1e-4, "{worst:e}");
    }

    #[test]
    fn dew_point_rises_with_vapour_down_to_dry_air() {
        let mut last = 0.0;
        for step in 0..=2_000 {
            let dew = dew_point_k(10.0f32 * step as f32);
            assert!(dew.is_finite() && dew >= last, "{step}: {dew}");
            last = dew;
        }
        assert!(dew_point_k(0.0).is_finite() && dew_point_k(-1.0).is_finite());
    }
}
