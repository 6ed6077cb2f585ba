//! Streams: masses that pass a place during one step, and the energy that they carry.

use crate::math;

use super::medium::{GAS_CONSTANTS_J_KG_K, LIQUID, Medium, NITROGEN, PARTS, Parts, VAPOUR, dot};

/// Gas constants of nitrogen, oxygen, carbon dioxide and trace gases by that of vapour [1].
const RATIOS: [f32; 4] = {
    let [nitrogen, oxygen, carbon_dioxide, vapour, trace, _] = GAS_CONSTANTS_J_KG_K;
    [nitrogen / vapour, oxygen / vapour, carbon_dioxide / vapour, trace / vapour]
};

/// Figures that a volume stores: masses of all parts, energy, and one that stays 0, so that rows fill whole vectors.
pub const STORED: usize = PARTS + 2;
/// Place of the energy among them.
pub const ENERGY: usize = PARTS;
/// One row of masses [kg] and energy [J], or of their carries.
pub type Stored = [f32; STORED];

/// Lowest temperature that is followed [K]: where air that blows down to vacuum without heat from anywhere (at 200 Pa,
/// from a cabin at 295 K) begins to turn into nitrogen and oxygen snow; ideal gas up to there, its `c_p` within 1 %.
pub const LEAST_K: f32 = 50.0;
/// Highest temperature that is followed [K]: 122 °C; water as a coolant boils there at 2.1 bar; `c_p` of air rises by 1.5 %.
pub const MOST_K: f32 = 395.15;

/// Masses and energy that pass during one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stream {
    /// Mass of every part [kg], ≥ 0.
    pub mass_kg: Parts,
    /// Energy with respect to the reference temperature [J].
    pub energy_j: f32,
}

impl Stream {
    /// What `mass_kg` [kg, ≥ 0] of a volume with these mass fractions [1] and this temperature over the reference
    /// [K] carries. Liquid does not flow with the air.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub fn of(mass_kg: f32, fractions: &Parts, theta_k: f32, medium: &Medium) -> Self {
        let mut parts = [0.0; PARTS];
        for (part, fraction) in parts.iter_mut().zip(fractions) {
            *part = mass_kg * fraction;
        }
        parts[LIQUID] = 0.0;
        Self { mass_kg: parts, energy_j: dot(&parts, &medium.flowing_j_kg_k) * theta_k }
    }

    /// What `mass_kg` [kg, ≥ 0] of coolant at this temperature over the reference [K] carries.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub fn of_coolant(mass_kg: f32, theta_k: f32, coolant: &Medium) -> Self {
        let [heat, ..] = coolant.flowing_j_kg_k;
        let mut parts = [0.0; PARTS];
        parts[NITROGEN] = mass_kg;
        Self { mass_kg: parts, energy_j: heat * mass_kg * theta_k }
    }

    /// Heat capacity of what passes [J/K].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub fn capacity_j_k(&self, medium: &Medium) -> f32 {
        dot(&self.mass_kg, &medium.flowing_j_kg_k)
    }

    /// Temperature over the reference [K]; 0 where nothing passes.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub fn theta_k(&self, medium: &Medium) -> f32 {
        let capacity = self.capacity_j_k(medium);
        let sensible = self.energy_j + self.mass_kg[LIQUID] * medium.latent_j_kg;
        if capacity > 0.0 { sensible / capacity } else { 0.0 }
    }

    /// Gives the stream heat [J], as far as it then stays within the temperatures that are followed; energies count from
    /// `reference_k` [K]. Returns the heat that it cannot carry [J].
    #[inline]
    pub fn warm(&mut self, heat_j: f32, medium: &Medium, reference_k: f32) -> f32 {
        let capacity = self.capacity_j_k(medium);
        let sensible = self.energy_j + self.mass_kg[LIQUID] * medium.latent_j_kg;
        let most = capacity * (MOST_K - reference_k) - sensible;
        let least = capacity * (LEAST_K - reference_k) - sensible;
        let carried = math::larger(math::smaller(least, 0.0), math::smaller(math::larger(most, 0.0), heat_j));
        self.energy_j += carried;
        heat_j - carried
    }

    /// Mass of dry gas [kg].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub fn dry_kg(&self) -> f32 {
        let [nitrogen, oxygen, carbon_dioxide, _, trace, _] = self.mass_kg;
        nitrogen + oxygen + carbon_dioxide + trace
    }

    /// Mass of vapour that would be as many moles as the dry gas [kg]: Σ m·R over the vapour's R.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub fn vapour_of_equal_moles_kg(&self) -> f32 {
        let [nitrogen, oxygen, carbon_dioxide, _, trace, _] = self.mass_kg;
        let [a, b, c, d] = RATIOS;
        nitrogen * a + oxygen * b + carbon_dioxide * c + trace * d
    }

    /// Mass of vapour [kg].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub fn vapour_kg(&self) -> f32 {
        self.mass_kg[VAPOUR]
    }
}
