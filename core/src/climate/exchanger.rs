//! What surrounds a condensing coil: coolant supply, water separator, carry-over and discharge.
//!
//! Water that a coil's films cannot hold drains into a separator, which keeps the share ε and loses the rest into the
//! air stream. It collects until the next discharge to the condensate tank; what comes while it is full is lost as
//! well. What is lost gathers into a slug and leaves for the volume behind the coil when the slug is whole: there it
//! lies free and evaporates.
//!
//! Source: P. Wieland, NASA TM-1998-206956 p. 104, and V-HAB: slurper and separator, discharge about every 75 min.
//! Hold-up, slug and discharge behaviour in microgravity are known in words only; their figures are parameters.

use super::condenser::{Condenser, Drained, WallStates};
use crate::element::ParameterError;
use crate::{Fingerprint, InputSpec, math};

/// Fixed data of one condensing heat exchanger with its separator.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Exchanger {
    /// The coil.
    pub condenser: Condenser,
    /// Temperature of the walls at the start [K].
    pub start_k: f32,
    /// Volume behind the coil, which gets what the separator loses.
    pub outlet_node: u32,
    /// Whether coolant comes from the inputs instead of a coolant line.
    pub own_coolant: bool,
    /// Water that the separator holds between two discharges [kg]; finite and > 0.
    pub separator_kg: f32,
    /// Time between two discharges [s]; finite and > 0.
    pub discharge_s: f32,
    /// Water that leaves at once [kg]; finite and > 0.
    pub slug_kg: f32,
    /// Slot of the first of [`Exchanger::INPUTS`].
    pub first_input: u32,
}

impl Exchanger {
    /// Inputs: share of the drained water that the separator keeps; flow [kg/s] and temperature [K] of coolant that
    /// comes from outside the network; share of both sides' conductances that fouling takes; whether the separator is
    /// discharged.
    pub const INPUTS: [InputSpec; 5] = [
        InputSpec { name: "separator_efficiency", unit: "1", min: 0.0, max: 1.0, default: 1.0 },
        InputSpec { name: "coolant_flow", unit: "kg/s", min: 0.0, max: 0.25, default: 0.0 },
        InputSpec { name: "coolant_temperature", unit: "K", min: 273.15, max: 333.15, default: 277.5 },
        InputSpec { name: "fouling", unit: "1", min: 0.0, max: 1.0, default: 0.0 },
        InputSpec { name: "discharge", unit: "1", min: 0.0, max: 1.0, default: 1.0 },
    ];

    /// Finds the first parameter outside its valid range, for a step of `step_s` [s].
    pub fn check(&self, step_s: f32) -> Result<(), ParameterError> {
        self.condenser.check(step_s)?;
        ParameterError::unless_positive("start_k", self.start_k)?;
        ParameterError::unless_positive("separator_kg", self.separator_kg)?;
        ParameterError::unless_positive("discharge_s", self.discharge_s)?;
        ParameterError::unless_positive("slug_kg", self.slug_kg)
    }

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        self.condenser.feed(hash);
        hash.values(&[self.start_k, self.separator_kg, self.discharge_s, self.slug_kg]);
        hash.word(self.outlet_node);
        hash.word(u32::from(self.own_coolant));
        hash.word(self.first_input);
    }
}

/// Stored figures of an exchanger's water, each followed by its carry: separator, tank, slug [kg]; energy of separator
/// and tank, of the slug [J]; time since the last discharge [s].
pub(super) const STORES: usize = 12;

/// Figures of an exchanger in a step: heat that left the air [J]; water that left the air [kg]; temperature of the air
/// behind it over the reference [K]; heat that the coolant took [J].
pub(super) const SHOWN: usize = 4;

/// Moves what the coil drained into separator and slug, and discharges when it is time and `discharges`; otherwise that
/// discharge is missed. Returns what leaves for the volume behind.
pub(super) fn separate(
    exchanger: &Exchanger,
    stores: &mut [f32; STORES],
    drained: Drained,
    efficiency: f32,
    discharges: bool,
    step_s: f32,
) -> Drained {
    let [separator, s, tank, t, slug, l, kept_j, k, slug_j, j, time, c] = stores;
    let room = math::larger(exchanger.separator_kg - *separator, 0.0);
    let kept = math::smaller(efficiency * drained.water_kg, room);
    // Energy goes with the water.
    let share = if drained.water_kg > 0.0 { kept / drained.water_kg } else { 0.0 };
    let kept_energy = share * drained.energy_j;
    math::compensated_add(separator, s, kept);
    math::compensated_add(kept_j, k, kept_energy);
    math::compensated_add(slug, l, drained.water_kg - kept);
    math::compensated_add(slug_j, j, drained.energy_j - kept_energy);
    math::compensated_add(time, c, step_s);
    if *time >= exchanger.discharge_s {
        math::compensated_add(time, c, -exchanger.discharge_s);
        let discharged = if discharges { *separator } else { 0.0 };
        math::compensated_add(separator, s, -discharged);
        math::compensated_add(tank, t, discharged);
    }
    if *slug < exchanger.slug_kg {
        return Drained::default();
    }
    let released = Drained { water_kg: *slug, energy_j: *slug_j };
    math::compensated_add(slug, l, -released.water_kg);
    math::compensated_add(slug_j, j, -released.energy_j);
    released
}

/// What an exchanger shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExchangerReadings {
    /// Heat that leaves the air, sensible and latent [W].
    pub heat_w: f32,
    /// Heat that the coolant takes [W].
    pub coolant_w: f32,
    /// Water that leaves the air [kg/s].
    pub condensate_kg_s: f32,
    /// Temperature of the air behind the coil [K].
    pub air_outlet_k: f32,
    /// Water in the films [kg].
    pub film_kg: f32,
    /// Water in the separator [kg].
    pub separator_kg: f32,
    /// Water in the condensate tank [kg].
    pub tank_kg: f32,
    /// Water gathered for the next slug [kg].
    pub slug_kg: f32,
}

impl ExchangerReadings {
    pub(super) fn of(
        stores: &[f32; STORES],
        shown: &[f32; SHOWN],
        [_, _, films, _]: &WallStates,
        reference_k: f32,
        step_s: f32,
    ) -> Self {
        let [separator_kg, _, tank_kg, _, slug_kg, ..] = *stores;
        let [heat, water, theta, taken] = *shown;
        Self {
            heat_w: heat / step_s,
            coolant_w: taken / step_s,
            condensate_kg_s: water / step_s,
            air_outlet_k: reference_k + theta,
            film_kg: films.iter().sum(),
            separator_kg,
            tank_kg,
            slug_kg,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXCHANGER: Exchanger = Exchanger {
        condenser: Condenser::CCAA,
        start_k: 280.0,
        outlet_node: 0,
        own_coolant: true,
        separator_kg: 0.5,
        discharge_s: 100.0,
        slug_kg: 0.05,
        first_input: 0,
    };

    fn run(efficiency: f32, seconds: u32) -> ([f32; STORES], f32, u32) {
        let (mut stores, mut released, mut slugs) = ([0.0; STORES], 0.0, 0);
        for _ in 0..10 * seconds {
            let drained = Drained { water_kg: 1e-3, energy_j: -2e3 };
            let out = separate(&EXCHANGER, &mut stores, drained, efficiency, true, 0.1);
            assert!(
                out.water_kg.abs() < f32::MIN_POSITIVE || (out.energy_j / out.water_kg + 2e6).abs() < 10.0
            );
            released += out.water_kg;
            slugs += u32::from(out.water_kg > 0.0);
        }
        (stores, released, slugs)
    }

    #[test]
    fn a_good_separator_discharges_by_the_clock_and_loses_nothing() {
        let (stores, released, _) = run(1.0, 40);
        assert!(released.abs() < f32::MIN_POSITIVE && (stores[0] - 0.4).abs() < 1e-4);
        // 10 g/s fill the separator in 50 s; what comes until the discharge at 100 s is lost.
        let ([separator, _, tank, _, slug, ..], released, _) = run(1.0, 101);
        assert!((tank - 0.5).abs() < 1e-3 && separator < 0.02, "{tank} {separator}");
        assert!((slug + released - 0.5).abs() < 2e-3, "{slug} {released}");
    }

    #[test]
    fn what_is_lost_leaves_in_slugs_and_nothing_vanishes() {
        let (stores, released, slugs) = run(0.6, 60);
        let [separator, _, tank, _, slug, ..] = stores;
        assert!((separator + tank + slug + released - 0.6).abs() < 1e-5);
        assert!(slugs >= 4, "{slugs}");
        assert!(slug < EXCHANGER.slug_kg);
    }
}
