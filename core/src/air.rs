//! Dry air and the constants of the gas laws.
//!
//! Ideal gas: `p = ρ·Rg·T`. Valid for 200–400 K and 0–200 kPa within 0.2 % (compressibility of air).

/// Specific gas constant of dry air Rg [J/(kg·K)].
///
/// Source: molar gas constant 8.314 462 J/(mol·K) over 28.965 g/mol; the value used with Qiu et al. 2017.
pub const GAS_CONSTANT_J_KG_K: f32 = 287.05;

/// Acceleration that turns a head in metres into a pressure, g [m/s²], as printed by Qiu et al. 2017.
pub const GRAVITY_M_S2: f32 = 9.806;

/// Returns the density ρ [kg/m³] of an ideal gas at `pressure_pa` [Pa, ≥ 0] and `temperature_k` [K, > 0].
pub fn density_kg_m3(pressure_pa: f32, temperature_k: f32) -> f32 {
    pressure_pa / (GAS_CONSTANT_J_KG_K * temperature_k)
}

/// Returns dp/dm = Rg·T/V [Pa/kg] of an isothermal gas volume `volume_m3` [m³, > 0] at `temperature_k` [K].
///
/// This is the inverse of the node's capacity Cap = V/(Rg·T) in the cabin equation of Qiu et al. 2017.
pub fn pressure_per_mass_pa_kg(volume_m3: f32, temperature_k: f32) -> f32 {
    GAS_CONSTANT_J_KG_K * temperature_k / volume_m3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_at_sea_level_in_the_cabin() {
        // 101 325 Pa and 295.15 K give 1.19596 kg/m³.
        assert!((density_kg_m3(101_325.0, 295.15) - 1.195_96).abs() < 1e-5);
    }

    #[test]
    fn filling_a_volume_with_its_own_mass_doubles_its_pressure() {
        let (volume, temperature, pressure) = (60.0, 295.15, 101_325.0);
        let mass = density_kg_m3(pressure, temperature) * volume;
        let rise = pressure_per_mass_pa_kg(volume, temperature) * mass;
        assert!((rise / pressure - 1.0).abs() < 1e-6);
    }
}
