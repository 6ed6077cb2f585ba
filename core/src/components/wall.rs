//! Wall with heat capacity between a volume and its surroundings.
//!
//! `C·dT/dt = G_i·(T_volume − T) − G_o·(T − T_outside)`, explicit Euler; one rounded number for each heat.

use crate::component::{Block, Component, Draft, Placed, StepContext, VolumeView};
use crate::fluid::{Account, ENERGY};
use crate::limits::{HEAT_CAPACITY, TEMPERATURE};
use crate::math;
use crate::parameter::{Carries, InputSpec, Key, Keys, ParameterError, Place, StepBound};
use crate::component_parameters;

/// Conductances, none included [W/K].
const CONDUCTANCE: (f64, f64) = (0.0, 1e9);
/// Least `c_v` of a part of air [J/(kg·K)], that of carbon dioxide and oxygen.
const LEAST_HEAT_J_KG_K: f32 = 650.0;

component_parameters! {
    /// Fixed data of one wall. Input: temperature of the surroundings.
    pub struct Wall {
        /// Heat capacity [J/K]; finite, and large enough for the step.
        pub capacity_j_k: f32,
        /// Conductance between volume and wall [W/K]; finite and ≥ 0.
        pub inner_w_k: f32,
        /// Conductance between wall and surroundings [W/K]; finite and ≥ 0.
        pub outer_w_k: f32,
        /// Temperature at the start [K].
        pub start_k: f32,
    }
}

impl Component for Wall {
    const KIND: &'static str = "wall";
    const ABOUT: &'static str = "Wall with heat capacity between a volume and its surroundings.";
    const PLACE: Place = Place::Node { holds: Carries::Any, boundary: true };
    const KEYS: Keys = &[&[
        Key::required("capacity_j_k", "J/K", HEAT_CAPACITY, "Heat capacity."),
        Key::required("inner_w_k", "W/K", CONDUCTANCE, "Conductance to the node."),
        Key::required("outer_w_k", "W/K", CONDUCTANCE, "Conductance to the surroundings."),
        Key::required("temperature_k", "K", TEMPERATURE, "Temperature at the start."),
    ]];
    const INPUTS: &'static [InputSpec] =
        &[InputSpec { name: "outside", unit: "K", min: 50.0, max: 500.0, default: 295.15 }];
    const STATE: usize = 2;
    const SUPPLIES: bool = true;

    fn from_file(draft: &mut Draft<'_>) -> Self {
        Self {
            capacity_j_k: draft.single("capacity_j_k"),
            inner_w_k: draft.single("inner_w_k"),
            outer_w_k: draft.single("outer_w_k"),
            start_k: draft.single("temperature_k"),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("capacity_j_k", self.capacity_j_k)?;
        ParameterError::unless_not_negative("inner_w_k", self.inner_w_k)?;
        ParameterError::unless_not_negative("outer_w_k", self.outer_w_k)?;
        ParameterError::unless_positive("start_k", self.start_k)
    }

    fn check_step(&self, step_s: f32) -> Result<(), StepBound> {
        // Within one step a wall must not pass the temperature that it is pulled to.
        let least = step_s * (self.inner_w_k + self.outer_w_k);
        if self.capacity_j_k < least {
            return Err(StepBound { parameter: "capacity_j_k", least, unit: "J/K" });
        }
        Ok(())
    }

    fn conductance_w_k(&self) -> f32 {
        self.inner_w_k
    }

    fn supply(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        volume: &VolumeView<'_>,
        block: Block<'_>,
        account: &mut Account<'_, '_>,
    ) {
        let [energy, carry] = block.state else { return };
        let theta = (self.start_k - step.reference_k) + *energy / self.capacity_j_k;
        let [outside_k] = step.inputs_of(placed.first_input);
        let outside = outside_k - step.reference_k;
        // The rest of a volume that blows down must not pass the wall's temperature within a step.
        let most_w_k = LEAST_HEAT_J_KG_K / step.step_s * volume.mass_kg;
        let inner = math::smaller(self.inner_w_k, most_w_k) * (volume.theta_k - theta) * step.step_s;
        let outer = self.outer_w_k * (outside - theta) * step.step_s;
        math::compensated_add(energy, carry, inner);
        math::compensated_add(energy, carry, outer);
        account.give([ENERGY], [-inner]);
        account.take_up_heat(outer);
    }

    fn holds(&self, state: &[f32], held: &mut dyn FnMut(usize, f32)) {
        if let [energy, carry] = *state {
            held(ENERGY, energy);
            held(ENERGY, -carry);
        }
    }
}
