//! Moist air: what water does in the air of a cabin, in single precision at a constant cost.
//!
//! | function | range | largest error against the same formula in `f64` |
//! |---|---|---|
//! | [`saturation_pressure_pa`] | 0…60 °C | 8e-7 relative |
//! | [`saturation_slope_pa_k`] | 0…60 °C | 1e-6 relative |
//! | [`dew_point_k`] | 1 Pa over ice-free water … 60 °C | 1e-4 K |
//! | [`humidity_ratio`], [`vapour_pressure_pa`] | `p_v` ≤ p/2 | 3e-7 relative |
//! | [`enthalpy_j_kg`] | 0…60 °C, W ≤ 0.15 | 0.05 J/kg |
//! | [`evaporation_enthalpy_j_kg`] | 0…60 °C | 0.3 J/kg |
//!
//! Each is tested over its whole range, and against `psychrolib` (ASHRAE formulas) in
//! `core/tests/moist_air_oracle.rs`.

mod properties;
mod saturation;

pub use properties::{
    LIQUID_HEAT_J_KG_K, MOLAR_RATIO, enthalpy_j_kg, evaporation_enthalpy_j_kg, humidity_ratio,
    moles_per_dry_mole, relative_humidity, vapour_pressure_pa,
};
pub use saturation::{dew_point_k, saturation_pressure_pa, saturation_slope_pa_k};

/// 0 °C [K].
pub const ZERO_CELSIUS_K: f32 = 273.15;
