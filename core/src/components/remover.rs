//! Remover: idealised removal of one part of the air; this volume flow leaves without it, times the efficiency.
//!
//! Valid for a given efficiency: no sorbent, no saturation.

use crate::component::{Block, Component, Draft, Placed, StepContext, VolumeView};
use crate::fluid::medium::{LIQUID, NAMES};
use crate::fluid::{Account, ENERGY};
use crate::parameter::{Carries, InputSpec, Key, Keys, ParameterError, Place};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one remover. Inputs: volume flow of air, share of the part that is taken.
    pub struct Remover {
        /// The part, as its place in [`NAMES`]; 0 … 4.
        pub part: f32,
    }
}

impl Component for Remover {
    const KIND: &'static str = "remover";
    const ABOUT: &'static str = "Idealised removal of one part of the air.";
    const PLACE: Place = Place::Node { holds: Carries::Air, boundary: false };
    const KEYS: Keys = &[&[Key::choice("part", NAMES.split_at(LIQUID).0, "The part that is removed.")]];
    const INPUTS: &'static [InputSpec] = &[
        InputSpec { name: "air_flow", unit: "m³/s", min: 0.0, max: 1.0, default: 0.0 },
        InputSpec { name: "efficiency", unit: "1", min: 0.0, max: 1.0, default: 1.0 },
    ];
    const SUPPLIES: bool = true;

    fn from_file(draft: &mut Draft<'_>) -> Self {
        Self { part: draft.choice("part") }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_not_negative("part", self.part)
    }

    fn supply(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        volume: &VolumeView<'_>,
        _block: Block<'_>,
        account: &mut Account<'_, '_>,
    ) {
        let part = self.part as usize;
        let [air_flow, efficiency] = step.inputs_of(placed.first_input);
        let flow = air_flow * efficiency;
        let air = step.air;
        let (Some(gas), Some(heat)) = (air.gas_j_kg_k.get(part), air.flowing_j_kg_k.get(part)) else { return };
        // ρ = p_i/(R_i·T) of this part alone
        let rate = -flow * volume.partial_pa(part) / (gas * (step.reference_k + volume.theta_k));
        account.bring([part, ENERGY], [rate * step.step_s, rate * heat * volume.theta_k * step.step_s]);
    }
}
