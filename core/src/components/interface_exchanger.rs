//! Heat exchanger between two loops of coolant, or from one to coolant from outside: plates behind a quadratic loss.
//!
//! `p_in − p_out = R·w·|w|`; the heat is that of the walls of [`super::coil`] with liquid in the place of
//! the air, in counterflow.

use super::coil::{CELLS, Coil, Condenser, WallFigures, WallStates};
use super::condensing_heat_exchanger::{CAPACITY, COOLANT_FLOW, COOLANT_TEMPERATURE, FOULING, START};
use super::loss::{self, Loss, loss_face};
use crate::component::{Block, Component, Draft, Heat, Passing, Placed, Seen, StepContext};
use crate::fluid::{Account, ENERGY, Stream};
use crate::limits::{CONDUCTANCE, REFERENCE_FLOW};
use crate::parameter::{Carries, Key, Keys, ParameterError, StepBound};
use crate::signal::{Display, OutputSpec};
use crate::component_parameters;

/// Exponent of the flow in the conductance of liquids: laminar through offset strip fins, as in the condenser.
const EXPONENT: f32 = 0.46;

component_parameters! {
    /// Fixed data of one exchanger between liquids.
    pub struct InterfaceExchanger {
        /// Quadratic flow resistance R [Pa·s²/kg²] of its own side; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Free share of the area that remains when blocked [1]; 0 for one that cannot be blocked.
        pub least_opening: f32,
        /// Conductance of its own side at the reference flow [W/K]; finite and > 0.
        pub liquid_w_k: f32,
        /// Reference flow of its own side [kg/s]; finite and > 0.
        pub liquid_reference_kg_s: f32,
        /// Conductance of the other side at its reference flow [W/K]; finite and > 0.
        pub coolant_w_k: f32,
        /// Reference flow of the other side [kg/s]; finite and > 0.
        pub coolant_reference_kg_s: f32,
        /// Heat capacity of the plates [J/K].
        pub capacity_j_k: f32,
        /// Temperature of the plates at the start [K].
        pub start_k: f32,
    }
}

impl InterfaceExchanger {
    fn loss(self) -> Loss {
        let Self { resistance_pa_s2_kg2, least_opening, .. } = self;
        Loss { resistance_pa_s2_kg2, least_opening }
    }

    /// Returns the walls.
    pub fn coil(self) -> Condenser {
        Condenser {
            air_w_k: self.liquid_w_k,
            air_reference_kg_s: self.liquid_reference_kg_s,
            air_exponent: EXPONENT,
            coolant_w_k: self.coolant_w_k,
            coolant_reference_kg_s: self.coolant_reference_kg_s,
            capacity_j_k: self.capacity_j_k,
            film_kg: Condenser::CCAA.film_kg,
        }
    }
}

impl Component for InterfaceExchanger {
    const KIND: &'static str = "interface_exchanger";
    const ABOUT: &'static str =
        "Heat exchanger between two loops of coolant, or to coolant from outside; needs `[air]`.";
    const KEYS: Keys = &[
        loss::KEYS,
        loss::BLOCKAGE,
        &[
            Key::required("liquid_w_k", "W/K", CONDUCTANCE, "Conductance of the line's own side at its reference flow."),
            Key::required("liquid_reference_kg_s", "kg/s", REFERENCE_FLOW, "Reference flow of that side."),
            Key::required("coolant_w_k", "W/K", CONDUCTANCE, "Conductance of the other side at its reference flow."),
            Key::required("coolant_reference_kg_s", "kg/s", REFERENCE_FLOW, "Reference flow of the other side."),
            CAPACITY,
            START,
        ],
    ];

    const SIDES: &'static [Carries] = &[Carries::Coolant, Carries::Coolant];
    const IDLE_WHEN_LINKED: &'static [&'static str] = &["coolant_flow", "coolant_temperature"];
    const OUTPUTS: &'static [OutputSpec] = &[
        OutputSpec { name: "heat", label: "heat out of the stream", display: Display::Heat },
        OutputSpec { name: "coolant_heat", label: "heat into the coolant", display: Display::Heat },
        OutputSpec { name: "air_outlet", label: "temperature behind the plates", display: Display::Temperature },
    ];
    const STATE: usize = 4 * CELLS;
    const SCRATCH: usize = 3 * CELLS + SHOWN;
    const SETTLES: bool = true;

    fn from_file(draft: &mut Draft<'_>) -> Self {
        draft.needs_air();
        let Loss { resistance_pa_s2_kg2, least_opening } = Loss::from_file(draft);
        Self {
            resistance_pa_s2_kg2,
            least_opening,
            liquid_w_k: draft.single("liquid_w_k"),
            liquid_reference_kg_s: draft.single("liquid_reference_kg_s"),
            coolant_w_k: draft.single("coolant_w_k"),
            coolant_reference_kg_s: draft.single("coolant_reference_kg_s"),
            capacity_j_k: draft.single("capacity_j_k"),
            start_k: draft.optional("temperature_k").unwrap_or(draft.line.from_k) as f32,
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.loss().check()?;
        self.coil().check()?;
        ParameterError::unless_positive("start_k", self.start_k)
    }

    fn check_step(&self, step_s: f32) -> Result<(), StepBound> {
        self.coil().check_step(step_s)
    }

    loss_face!(COOLANT_FLOW, COOLANT_TEMPERATURE, FOULING);

    fn start(&self, _placed: &Placed, step: &StepContext<'_>, block: Block<'_>) {
        if let Some(Cut { shown, .. }) = Cut::of(block) {
            shown[1] = self.start_k - step.reference_k;
        }
    }

    fn begin(&self, _placed: &Placed, step: &StepContext<'_>, block: Block<'_>) {
        if let Some(mut cut) = Cut::of(block) {
            cut.coil(&self.coil(), self.start_k, 1.0, step).begin();
        }
    }

    fn pass(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        passing: &Passing<'_>,
        block: Block<'_>,
        stream: &mut Stream,
    ) -> Heat {
        let Some(mut cut) = Cut::of(block) else { return Heat::default() };
        let [_, _, fouling] = step.inputs_of(placed.first_input);
        let (before, condenser) = (stream.energy_j, self.coil());
        let mut coil = cut.coil(&condenser, self.start_k, 1.0 - fouling, step);
        if passing.side == 0 {
            coil.pass_liquid(stream, step.step_s, step.coolant, passing.reversed);
            [cut.shown[0], cut.shown[1]] = [before - stream.energy_j, stream.theta_k(step.coolant)];
        } else {
            coil.pass_coolant(stream, step.step_s, step.coolant);
            cut.shown[2] = stream.energy_j - before;
        }
        Heat::default()
    }

    fn settle(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        block: Block<'_>,
        account: &mut Account<'_, '_>,
    ) {
        let Some(mut cut) = Cut::of(block) else { return };
        let [flow, temperature, fouling] = step.inputs_of(placed.first_input);
        let condenser = self.coil();
        if !placed.linked {
            let taken = cut
                .coil(&condenser, self.start_k, 1.0 - fouling, step)
                .pass_own_coolant(flow, temperature, step);
            cut.shown[2] = taken;
            account.take_up_heat(-taken);
        }
        cut.coil(&condenser, self.start_k, 1.0, step).settle();
    }

    fn holds(&self, state: &[f32], held: &mut dyn FnMut(usize, f32)) {
        if let Some([energy, carry]) = state.as_chunks::<CELLS>().0.first_chunk() {
            for sum in energy { held(ENERGY, *sum); }
            for carry in carry { held(ENERGY, -carry); }
        }
    }

    fn output(&self, item: usize, _placed: &Placed, step: &StepContext<'_>, seen: Seen<'_>) -> f32 {
        let shown = seen.scratch.get(3 * CELLS..).unwrap_or_default();
        let Some(&[heat, theta, taken]) = shown.first_chunk() else { return f32::NAN };
        match item {
            0 => heat / step.step_s,
            1 => taken / step.step_s,
            _ => step.reference_k + theta,
        }
    }
}

/// Figures of the last step: heat out of the stream [J], its temperature behind the plates over the reference [K], heat
/// into the coolant [J].
const SHOWN: usize = 3;

/// State and scratch of the plates.
struct Cut<'b> {
    walls: &'b mut WallStates,
    figures: &'b mut WallFigures,
    shown: &'b mut [f32; SHOWN],
}

impl<'b> Cut<'b> {
    fn of(Block { state, scratch }: Block<'b>) -> Option<Self> {
        let (figures, shown) = scratch.split_at_mut_checked(3 * CELLS)?;
        Some(Self {
            walls: state.as_chunks_mut().0.first_chunk_mut()?,
            figures: figures.as_chunks_mut().0.first_chunk_mut()?,
            shown: shown.first_chunk_mut()?,
        })
    }

    fn coil<'c>(
        &'c mut self,
        condenser: &'c Condenser,
        start_k: f32,
        clean: f32,
        step: &StepContext<'c>,
    ) -> Coil<'c> {
        Coil {
            condenser,
            air: step.air,
            clean,
            reference_k: step.reference_k,
            start_theta_k: start_k - step.reference_k,
            walls: self.walls,
            figures: self.figures,
        }
    }
}
