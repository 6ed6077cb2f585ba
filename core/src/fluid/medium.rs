//! What flows: the parts of cabin air, or a coolant, with the few constants that energy and pressure need.
//!
//! Energy counts from the network's reference temperature `T_r`, θ = T − `T_r`:
//!
//! ```text
//! gas      h = c_p·θ             u = c_v·θ − R·T_r
//! liquid   h = c_l·θ − L(T_r)    u = h
//! ```
//!
//! That is h = u + R·T with the free constant of every substance chosen so that what flows carries small numbers; the
//! flow work R·T is in it, and so is the evaporation enthalpy, by which liquid water lies below its vapour. A
//! substance that changes phase inside a volume therefore needs no heat of its own in the books: the temperature
//! follows.
//!
//! Source: specific heats of ideal gases at 300 K (NIST-JANAF tables), molar masses (CIAAW), evaporation enthalpy at
//! `T_r` from [`crate::moist`]. Valid for 273–333 K, where the specific heats move by less than 1 %.

use crate::moist;

/// Number of parts that a volume may hold.
pub const PARTS: usize = 6;

/// Mass [kg] or any other figure of every part.
pub type Parts = [f32; PARTS];

/// Nitrogen (with argon).
pub const NITROGEN: usize = 0;
/// Oxygen.
pub const OXYGEN: usize = 1;
/// Carbon dioxide.
pub const CARBON_DIOXIDE: usize = 2;
/// Water vapour.
pub const VAPOUR: usize = 3;
/// Trace gases, with the properties of air.
pub const TRACE: usize = 4;
/// Liquid water that lies free in a volume; it does not flow with the air.
pub const LIQUID: usize = 5;

/// Names of the parts of air, in order.
pub const NAMES: [&str; PARTS] = ["nitrogen", "oxygen", "carbon_dioxide", "vapour", "trace", "liquid"];

/// Molar gas constant [J/(kmol·K)].
const MOLAR_J_KMOL_K: f32 = 8_314.463;
/// Specific gas constants R of the parts of air [J/(kg·K)].
pub const GAS_CONSTANTS_J_KG_K: Parts = [
    MOLAR_J_KMOL_K / 28.013_4,
    MOLAR_J_KMOL_K / 31.998,
    MOLAR_J_KMOL_K / 44.009,
    MOLAR_J_KMOL_K / 18.015,
    MOLAR_J_KMOL_K / 28.965,
    0.0,
];

/// Specific heats at constant pressure `c_p` of the parts of air [J/(kg·K)].
const AIR_HEATS_J_KG_K: Parts = [1_040.0, 919.0, 846.0, 1_864.0, 1_006.0, moist::LIQUID_HEAT_J_KG_K];

/// Constants of what fills a volume, at the network's reference temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Medium {
    /// `c_p` of every part [J/(kg·K)].
    pub flowing_j_kg_k: Parts,
    /// `c_v` of every part [J/(kg·K)].
    pub resting_j_kg_k: Parts,
    /// How far u lies below `c_v`·θ, for every part [J/kg].
    pub offset_j_kg: Parts,
    /// Gas constant of every part [J/(kg·K)].
    pub gas_j_kg_k: Parts,
    /// Evaporation enthalpy at the reference temperature [J/kg].
    pub latent_j_kg: f32,
    /// How much of its volume a liquid gains per kelvin [1/K]; a gas follows its own law.
    pub expansion_1_k: f32,
}

impl Medium {
    /// Nothing flows.
    pub const NONE: Self = Self::coolant(0.0);

    /// Cabin air at the reference temperature `reference_k` [K, 273…333].
    pub fn air(reference_k: f32) -> Self {
        let latent_j_kg = moist::evaporation_enthalpy_j_kg(reference_k);
        let mut resting = AIR_HEATS_J_KG_K;
        let mut offset = [0.0; PARTS];
        for ((resting, offset), gas) in resting.iter_mut().zip(&mut offset).zip(GAS_CONSTANTS_J_KG_K) {
            *resting -= gas;
            *offset = gas * reference_k;
        }
        offset[LIQUID] = latent_j_kg;
        Self {
            flowing_j_kg_k: AIR_HEATS_J_KG_K,
            resting_j_kg_k: resting,
            offset_j_kg: offset,
            gas_j_kg_k: GAS_CONSTANTS_J_KG_K,
            latent_j_kg,
            expansion_1_k: 0.0,
        }
    }

    /// A liquid that does not expand, with the specific heat `heat_j_kg_k` [J/(kg·K)]; all of it is part 0.
    pub const fn coolant(heat_j_kg_k: f32) -> Self {
        let heats = [heat_j_kg_k, 0.0, 0.0, 0.0, 0.0, 0.0];
        Self {
            flowing_j_kg_k: heats,
            resting_j_kg_k: heats,
            offset_j_kg: [0.0; PARTS],
            gas_j_kg_k: [0.0; PARTS],
            latent_j_kg: 0.0,
            expansion_1_k: 0.0,
        }
    }
}

/// Returns Σ aᵢ·bᵢ in the order of the parts.
#[inline(always)]
#[allow(clippy::inline_always, reason = "six products inside every volume and line")]
pub fn dot(a: &Parts, b: &Parts) -> f32 {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
}

/// Returns the partial pressure of a part [Pa] from mass fractions.
#[inline]
pub fn partial_pressure_pa(part: usize, fractions: &Parts, pressure_pa: f32) -> f32 {
    let gas = &GAS_CONSTANTS_J_KG_K;
    let (own, constant) =
        (fractions.get(part).copied().unwrap_or(0.0), gas.get(part).copied().unwrap_or(0.0));
    pressure_pa * own * constant / dot(fractions, gas)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dry_air_has_the_properties_of_its_parts() {
        // 75.5 % nitrogen and 24.5 % oxygen by mass lie within 1 % of air's own 1 006 and 287.05.
        let parts = [0.755, 0.245, 0.0, 0.0, 0.0, 0.0];
        let air = Medium::air(295.15);
        assert!((dot(&parts, &air.flowing_j_kg_k) / 1_006.0 - 1.0).abs() < 0.01);
        assert!((dot(&parts, &air.gas_j_kg_k) / 287.05 - 1.0).abs() < 0.01);
    }

    #[test]
    fn flow_work_and_evaporation_are_what_separate_the_enthalpies() {
        let (reference, theta) = (295.15f32, 7.0f32);
        let air = Medium::air(reference);
        for part in 0..LIQUID {
            let h = air.flowing_j_kg_k[part] * theta;
            let u = air.resting_j_kg_k[part] * theta - air.offset_j_kg[part];
            let work = air.gas_j_kg_k[part] * (reference + theta);
            assert!(((h - u) / work - 1.0).abs() < 1e-5);
        }
        let vapour = air.flowing_j_kg_k[VAPOUR] * theta;
        let liquid = air.flowing_j_kg_k[LIQUID] * theta - air.latent_j_kg;
        let evaporation = moist::evaporation_enthalpy_j_kg(reference + theta);
        assert!(((vapour - liquid) / evaporation - 1.0).abs() < 1e-4);
    }
}
