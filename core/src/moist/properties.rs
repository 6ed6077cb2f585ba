//! Humidity ratio, relative humidity and enthalpies of moist air.
//!
//! `W = 0.622·p_v/(p − p_v)`, `h = c_a·t + W·(L0 + c_v·t)` with t in °C, liquid water at 0 °C and dry air at 0 °C as
//! zero. Source of the constants: ASHRAE Handbook, Fundamentals (1.006 kJ/(kg·K), 2501 kJ/kg, 1.86 kJ/(kg·K)),
//! liquid water 4.186 kJ/(kg·K). Valid for 0…60 °C within 0.3 % of a real-gas formulation.

use super::ZERO_CELSIUS_K;
use crate::math;

/// Molar mass of water over that of dry air [1].
pub const MOLAR_RATIO: f32 = 0.622;
/// Specific heat of liquid water [J/(kg·K)].
pub const LIQUID_HEAT_J_KG_K: f32 = 4_186.0;
/// Specific heat of dry air [J/(kg·K)].
const DRY_HEAT_J_KG_K: f32 = 1_006.0;
/// Specific heat of water vapour [J/(kg·K)].
const VAPOUR_HEAT_J_KG_K: f32 = 1_860.0;
/// Evaporation enthalpy at 0 °C [J/kg].
const EVAPORATION_J_KG: f32 = 2_501e3;

/// Returns mass of water per mass of dry air [kg/kg] at the vapour's pressure [Pa, below half the total] and the
/// total pressure [Pa]; a large number, never a negative one, where water boils and there is no dry air left.
#[inline]
pub fn humidity_ratio(vapour_pa: f32, pressure_pa: f32) -> f32 {
    MOLAR_RATIO * moles_per_dry_mole(vapour_pa, pressure_pa)
}

/// Returns moles of water per mole of dry gas [1] at the vapour's pressure [Pa, below half the total] and the total
/// pressure [Pa], whatever the dry gas is; a large number, never a negative one, where water boils.
#[inline]
pub fn moles_per_dry_mole(vapour_pa: f32, pressure_pa: f32) -> f32 {
    vapour_pa / math::larger(pressure_pa - vapour_pa, 1e-3 * vapour_pa)
}

/// Returns the vapour's pressure [Pa] of air with `humidity_ratio` [kg/kg, ≥ 0] at `pressure_pa` [Pa].
#[inline]
pub fn vapour_pressure_pa(humidity_ratio: f32, pressure_pa: f32) -> f32 {
    pressure_pa * humidity_ratio / (MOLAR_RATIO + humidity_ratio)
}

/// Returns the relative humidity [1] of vapour at `vapour_pa` [Pa] and `temperature_k` [K, 273.15…333.15].
#[inline]
pub fn relative_humidity(vapour_pa: f32, temperature_k: f32) -> f32 {
    vapour_pa / super::saturation_pressure_pa(temperature_k)
}

/// Returns the enthalpy of moist air per mass of dry air [J/kg] at `temperature_k` [K, 273.15…333.15] and
/// `humidity_ratio` [kg/kg, 0…0.15].
#[inline]
pub fn enthalpy_j_kg(temperature_k: f32, humidity_ratio: f32) -> f32 {
    let t = temperature_k - ZERO_CELSIUS_K;
    DRY_HEAT_J_KG_K * t + humidity_ratio * (EVAPORATION_J_KG + VAPOUR_HEAT_J_KG_K * t)
}

/// Returns what it takes to evaporate liquid water at `temperature_k` [K, 273.15…333.15] at that temperature [J/kg].
#[inline]
pub fn evaporation_enthalpy_j_kg(temperature_k: f32) -> f32 {
    EVAPORATION_J_KG - (LIQUID_HEAT_J_KG_K - VAPOUR_HEAT_J_KG_K) * (temperature_k - ZERO_CELSIUS_K)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_against_double_precision_over_the_whole_range() {
        let (mut ratio, mut back, mut enthalpy, mut evaporation) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
        for step in 0..=1_000 {
            for part in 0..=50 {
                let (pressure, vapour) = (50_000.0 + 100.0 * step as f32, 400.0 * part as f32 + 1.0);
                let exact = 0.622 * f64::from(vapour) / (f64::from(pressure) - f64::from(vapour));
                let w = humidity_ratio(vapour, pressure);
                ratio = ratio.max((f64::from(w) / exact - 1.0).abs());
                let exact = f64::from(pressure) * f64::from(w) / (0.622 + f64::from(w));
                back = back.max((f64::from(vapour_pressure_pa(w, pressure)) / exact - 1.0).abs());
                let (t, w) = (273.15 + 0.06 * step as f32, 0.003 * part as f32);
                let celsius = f64::from(t - ZERO_CELSIUS_K);
                let exact = 1006.0 * celsius + f64::from(w) * (2_501e3 + 1860.0 * celsius);
                enthalpy = enthalpy.max((f64::from(enthalpy_j_kg(t, w)) - exact).abs());
                let exact = 2_501e3 - (4186.0 - 1860.0) * celsius;
                evaporation = evaporation.max((f64::from(evaporation_enthalpy_j_kg(t)) - exact).abs());
            }
        }
        std::println!(
            "humidity ratio {ratio:.1e}, back {back:.1e}, enthalpy {enthalpy:.2e}, {evaporation:.2e} J/kg"
        );
        assert!(ratio < 3e-7 && back < 3e-7 && enthalpy < 0.05 && evaporation < 0.3);
    }

    #[test]
    fn water_that_boils_has_no_negative_humidity_ratio() {
        let mut last = 0.0;
        for step in 0..=400 {
            let ratio = humidity_ratio(872.0, 2_000.0 - 5.0 * step as f32);
            assert!(ratio >= last, "{step}: {ratio}");
            last = ratio;
        }
        assert!(last > 100.0);
    }

    #[test]
    fn saturated_air_has_a_relative_humidity_of_one() {
        for t in [275.0, 295.15, 320.0] {
            let vapour = super::super::saturation_pressure_pa(t);
            assert!((relative_humidity(vapour, t) - 1.0).abs() < 1e-6);
        }
    }
}
