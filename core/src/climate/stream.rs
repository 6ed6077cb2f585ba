//! What passes a place during one step: masses and the energy that they carry.

use super::medium::{GAS_CONSTANTS_J_KG_K, LIQUID, Medium, NITROGEN, PARTS, Parts, VAPOUR, dot};

/// Gas constants of nitrogen, oxygen, carbon dioxide and trace gases by that of vapour [1].
const RATIOS: [f32; 4] = {
    let [nitrogen, oxygen, carbon_dioxide, vapour, trace, _] = GAS_CONSTANTS_J_KG_K;
    [nitrogen / vapour, oxygen / vapour, carbon_dioxide / vapour, trace / vapour]
};

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
