//! Heater, cold plate or heat load in a line: a quadratic loss whose stream takes up a commanded power.
//!
//! `p_in − p_out = R·w·|w|`; the heat is an input.

use super::loss::{self, Loss, loss_face};
use crate::component::{Block, Component, Draft, Heat, Passing, Placed, StepContext};
use crate::fluid::Stream;
use crate::parameter::{Carries, InputSpec, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one heater.
    pub struct Heater {
        /// Quadratic flow resistance R [Pa·s²/kg²] at the line's reference density; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Free share of the area that remains when blocked [1]; 0 for a heater that cannot be blocked.
        pub least_opening: f32,
    }
}

impl Heater {
    fn loss(self) -> Loss {
        let Self { resistance_pa_s2_kg2, least_opening } = self;
        Loss { resistance_pa_s2_kg2, least_opening }
    }
}

impl Component for Heater {
    const KIND: &'static str = "heater";
    const ABOUT: &'static str = "Heater, cold plate or heat load in a line; needs `[air]`.";
    const KEYS: Keys = &[loss::KEYS, loss::BLOCKAGE];
    const SIDES: &'static [Carries] = &[Carries::Any];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        draft.needs_air();
        let Loss { resistance_pa_s2_kg2, least_opening } = Loss::from_file(draft);
        Self { resistance_pa_s2_kg2, least_opening }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.loss().check()
    }

    loss_face!(InputSpec { name: "power", unit: "W", min: -1e5, max: 1e5, default: 0.0 });

    fn pass(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        passing: &Passing<'_>,
        _block: Block<'_>,
        stream: &mut Stream,
    ) -> Heat {
        let [power_w] = step.inputs_of(placed.first_input);
        let outside_j = power_w * step.step_s;
        Heat { outside_j, left_j: stream.warm(outside_j, passing.medium, step.reference_k) }
    }
}
