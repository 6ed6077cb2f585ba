//! Crew: what people take from the air and give to it, by activity.
//!
//! Source: BVAD 2015 table 3.22 (NASA/TP-2015-218570), through V-HAB: dry heat in kJ/h; vapour, sweat, oxygen and
//! carbon dioxide in 1e-4 kg/min, a person. With 8 h of sleep, 30 min of exercise and 60 min of recovery a day of it sums
//! to 0.819 kg of oxygen, 1.038 kg of carbon dioxide, 1.85 kg of vapour, 0.08 kg of sweat and 136.9 W, latent heat included. (The daily sums
//! of NASA RP-1324 differ: 0.84, 1.00, 2.28 kg, 136.7 W.) In recovery oxygen and carbon dioxide are as in nominal work.
//! Sweat is liquid water that lies free in the cabin. All of it comes at the cabin's temperature.

use crate::component::{Block, Component, Draft, Placed, StepContext, VolumeView};
use crate::fluid::medium::{CARBON_DIOXIDE, LIQUID, OXYGEN, PARTS, Parts, VAPOUR};
use crate::fluid::{Account, ENERGY};
use crate::parameter::{Carries, InputSpec, Keys, ParameterError, Place};
use crate::component_parameters;

component_parameters! {
    /// A group of people in one cabin. Inputs: how many, and their activity.
    pub struct Crew {}
}

/// Names of the activities; the input `activity` is the index.
pub const ACTIVITIES: [&str; 8] =
    ["sleep", "nominal", "exercise", "late_exercise", "recovery", "recovery_2", "recovery_3", "recovery_4"];

/// As printed: dry heat [kJ/h]; vapour, sweat, oxygen, carbon dioxide [1e-4 kg/min].
const PRINTED: [[f32; 5]; 8] = [
    [224.0, 6.3, 0.0, 3.6, 4.55],
    [329.0, 11.77, 0.0, 5.68, 7.2],
    [514.0, 46.16, 1.56, 39.4, 49.85],
    [624.0, 128.42, 33.52, 39.4, 49.85],
    [568.0, 83.83, 15.16, 5.68, 7.2],
    [488.0, 40.29, 0.36, 5.68, 7.2],
    [466.0, 27.44, 0.0, 5.68, 7.2],
    [455.0, 20.4, 0.0, 5.68, 7.2],
];

/// The table's unit of mass flow, 1e-4 kg/min [kg/s].
const KG_S: f32 = 1e-4 / 60.0;

/// Dry heat [W]; vapour, sweat, oxygen, carbon dioxide [kg/s].
const TABLE: [[f32; 5]; 8] = {
    let mut table = PRINTED;
    let mut row = 0;
    while row < table.len() {
        table[row][0] *= 1.0 / 3.6;
        let mut column = 1;
        while column < table[row].len() {
            table[row][column] *= KG_S;
            column += 1;
        }
        row += 1;
    }
    table
};

/// What one person gives at an activity: heat [W], and masses of the parts [kg/s], oxygen below 0.
pub fn person(activity: f32) -> (f32, Parts) {
    let index = if activity > 0.0 { (activity + 0.5) as usize } else { 0 };
    let row = TABLE.get(index).or(TABLE.last()).unwrap_or(&[0.0; 5]);
    let [heat_w, vapour, sweat, oxygen, carbon_dioxide] = *row;
    let mut parts = [0.0; PARTS];
    parts[VAPOUR] = vapour;
    parts[LIQUID] = sweat;
    parts[OXYGEN] = -oxygen;
    parts[CARBON_DIOXIDE] = carbon_dioxide;
    (heat_w, parts)
}

impl Component for Crew {
    const KIND: &'static str = "crew";
    const ABOUT: &'static str = "People, by the 2015 edition of the Baseline Values and Assumptions Document.";
    const PLACE: Place = Place::Node { holds: Carries::Air, boundary: false };
    const KEYS: Keys = &[];
    const INPUTS: &'static [InputSpec] = &[
        InputSpec { name: "count", unit: "1", min: 0.0, max: 100.0, default: 1.0 },
        InputSpec { name: "activity", unit: "1", min: 0.0, max: 7.0, default: 1.0 },
    ];
    const SUPPLIES: bool = true;

    fn from_file(_draft: &mut Draft<'_>) -> Self {
        Self {}
    }

    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    fn supply(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        volume: &VolumeView<'_>,
        _block: Block<'_>,
        account: &mut Account<'_, '_>,
    ) {
        let [count, activity] = step.inputs_of(placed.first_input);
        let person_s = count * step.step_s;
        let (heat_w, rates) = person(activity);
        let heats = &step.air.flowing_j_kg_k;
        let [oxygen, carbon_dioxide, vapour, liquid] =
            [OXYGEN, CARBON_DIOXIDE, VAPOUR, LIQUID].map(|part| (rates[part], rates[part] * heats[part]));
        let sensible = ((oxygen.1 + carbon_dioxide.1) + (vapour.1 + liquid.1)) * volume.theta_k;
        let energy = heat_w + (sensible - liquid.0 * step.air.latent_j_kg);
        account.bring(
            [OXYGEN, CARBON_DIOXIDE, VAPOUR, LIQUID, ENERGY],
            [oxygen.0, carbon_dioxide.0, vapour.0, liquid.0, energy].map(|rate| rate * person_s),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_of_the_table_sums_to_the_printed_figures() {
        // Hours: 8 asleep, ½ exercising, 1 recovering by quarters, the rest nominal.
        let hours = [8.0f32, 14.5, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25];
        let (mut heat, mut sums) = (0.0, [0.0f32; PARTS]);
        for (activity, hours) in hours.into_iter().enumerate() {
            let (watt, parts) = person(activity as f32);
            heat += watt * hours / 24.0;
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum += part * 3_600.0 * hours;
            }
        }
        assert!((sums[OXYGEN] + 0.819).abs() < 1e-3, "{}", sums[OXYGEN]);
        assert!((sums[CARBON_DIOXIDE] - 1.038).abs() < 1e-3, "{}", sums[CARBON_DIOXIDE]);
        assert!((sums[VAPOUR] - 1.85).abs() < 5e-3, "{}", sums[VAPOUR]);
        assert!((sums[LIQUID] - 0.08).abs() < 5e-3, "{}", sums[LIQUID]);
        // The printed heat counts what it takes to evaporate the vapour.
        let latent = sums[VAPOUR] * 2.43e6 / 86_400.0;
        assert!((heat + latent - 136.9).abs() < 1.0, "{heat} + {latent}");
    }
}
