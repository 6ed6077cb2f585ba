//! Source: heat and masses that come into a volume at its own temperature: equipment, lighting, injection, supply, leak.

use crate::component::{Block, Component, Draft, Placed, StepContext, VolumeView};
use crate::fluid::medium::{LIQUID, dot};
use crate::fluid::{Account, PARTS};
use crate::parameter::{Carries, InputSpec, Keys, ParameterError, Place};
use crate::component_parameters;

component_parameters! {
    /// A source. Inputs: heat, then the mass flow of every part.
    pub struct Source {}
}

/// A mass flow of a source.
const fn mass(name: &'static str) -> InputSpec {
    InputSpec { name, unit: "kg/s", min: -1.0, max: 1.0, default: 0.0 }
}

impl Component for Source {
    const KIND: &'static str = "source";
    const ABOUT: &'static str = "Heat and masses that come into a volume at its temperature.";
    const PLACE: Place = Place::Node { holds: Carries::Air, boundary: false };
    const KEYS: Keys = &[];
    const INPUTS: &'static [InputSpec] = &[
        InputSpec { name: "heat", unit: "W", min: -1e5, max: 1e5, default: 0.0 },
        mass("nitrogen"),
        mass("oxygen"),
        mass("carbon_dioxide"),
        mass("vapour"),
        mass("trace"),
        mass("liquid"),
    ];
    const SUPPLIES: bool = true;

    fn from_file(_draft: &mut Draft<'_>) -> Self {
        Self {}
    }

    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    fn gas_kg_s(&self, inputs: &[f32]) -> f32 {
        inputs.get(1..=LIQUID).unwrap_or(&[]).iter().sum()
    }

    fn supply(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        volume: &VolumeView<'_>,
        _block: Block<'_>,
        account: &mut Account<'_, '_>,
    ) {
        let [heat_w, rates @ ..] = step.inputs_of::<{ PARTS + 1 }>(placed.first_input);
        let air = step.air;
        let carried = dot(&rates, &air.flowing_j_kg_k) * volume.theta_k - rates[LIQUID] * air.latent_j_kg;
        let [a, b, c, d, e, f] = rates;
        account.bring([0, 1, 2, 3, 4, 5, 6], [a, b, c, d, e, f, heat_w + carried].map(|rate| rate * step.step_s));
    }
}
