//! Condensing heat exchanger in an air line: walls, films and separator behind a quadratic loss.
//!
//! `p_in − p_out = R·w·|w|`; heat and water by [`super::coil`] and [`super::separator`], which also give the sources.

use super::coil::{CELLS, Coil, Condenser, WallFigures, WallStates};
use super::loss::{self, Loss, loss_face};
use super::separator::{STORES, Separator, separate};
use crate::component::{Block, Component, Draft, Heat, Passing, Placed, Seen, StepContext};
use crate::fluid::medium::{LIQUID, VAPOUR};
use crate::fluid::{Account, ENERGY, Stream};
use crate::limits::{CONDUCTANCE, FRACTION, HEAT_CAPACITY, MASS, MOIST_TEMPERATURE, REFERENCE_FLOW, SOME_TIME};
use crate::parameter::{Carries, InputSpec, Key, Keys, ParameterError, StepBound};
use crate::signal::{Display, OutputSpec};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one condensing heat exchanger.
    pub struct CondensingHeatExchanger {
        /// Quadratic flow resistance R [Pa·s²/kg²] of the air side; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Free share of the area that remains when blocked [1]; 0 for one that cannot be blocked.
        pub least_opening: f32,
        /// See [`Condenser::air_w_k`].
        pub air_w_k: f32,
        /// See [`Condenser::air_reference_kg_s`].
        pub air_reference_kg_s: f32,
        /// See [`Condenser::air_exponent`].
        pub air_exponent: f32,
        /// See [`Condenser::coolant_w_k`].
        pub coolant_w_k: f32,
        /// See [`Condenser::coolant_reference_kg_s`].
        pub coolant_reference_kg_s: f32,
        /// See [`Condenser::capacity_j_k`].
        pub capacity_j_k: f32,
        /// See [`Condenser::film_kg`].
        pub film_kg: f32,
        /// Temperature of the walls at the start [K].
        pub start_k: f32,
        /// Water that the separator holds between two discharges [kg]; finite and > 0.
        pub separator_kg: f32,
        /// Time between two discharges [s]; finite and > 0.
        pub discharge_s: f32,
        /// Water that leaves at once [kg]; finite and > 0.
        pub slug_kg: f32,
    }
}

/// Time between two discharges of condensate when the file gives none [s]: about 75 min (V-HAB).
pub(super) const DISCHARGE_S: f64 = 4_500.0;
/// Water that a separator holds when the file gives none [kg] (assumed).
pub(super) const SEPARATOR_KG: f64 = 2.0;
/// Water that a separator loses at once when the file gives none [kg] (assumed).
pub(super) const SLUG_KG: f64 = 0.05;
/// Temperature of the walls at the start.
pub(super) const START: Key = Key::optional(
    "temperature_k",
    "K",
    MOIST_TEMPERATURE,
    "Temperature of the walls at the start; that of the line's `from` node when absent.",
);
/// Heat capacity of the walls.
pub(super) const CAPACITY: Key =
    Key::optional("capacity_j_k", "J/K", HEAT_CAPACITY, "Heat capacity of the walls.").or(Condenser::CCAA.capacity_j_k as f64);

impl CondensingHeatExchanger {
    fn loss(self) -> Loss {
        let Self { resistance_pa_s2_kg2, least_opening, .. } = self;
        Loss { resistance_pa_s2_kg2, least_opening }
    }

    /// Returns the coil.
    pub fn coil(self) -> Condenser {
        Condenser {
            air_w_k: self.air_w_k,
            air_reference_kg_s: self.air_reference_kg_s,
            air_exponent: self.air_exponent,
            coolant_w_k: self.coolant_w_k,
            coolant_reference_kg_s: self.coolant_reference_kg_s,
            capacity_j_k: self.capacity_j_k,
            film_kg: self.film_kg,
        }
    }
}

impl Component for CondensingHeatExchanger {
    const KIND: &'static str = "condenser";
    const ABOUT: &'static str =
        "Condensing heat exchanger with walls, films and separator; that of the station by default; needs `[air]`.";
    const KEYS: Keys = &[
        loss::KEYS,
        loss::BLOCKAGE,
        &[
            Key::optional("air_w_k", "W/K", CONDUCTANCE, "Conductance of the air side at its reference flow.")
                .or(Condenser::CCAA.air_w_k as f64),
            Key::optional("air_reference_kg_s", "kg/s", REFERENCE_FLOW, "Reference flow of dry air.")
                .or(Condenser::CCAA.air_reference_kg_s as f64),
            Key::optional("air_exponent", "1", FRACTION, "Exponent of the air flow.")
                .or(Condenser::CCAA.air_exponent as f64),
            Key::optional("coolant_w_k", "W/K", CONDUCTANCE, "Conductance of the coolant side at its reference flow.")
                .or(Condenser::CCAA.coolant_w_k as f64),
            Key::optional("coolant_reference_kg_s", "kg/s", REFERENCE_FLOW, "Reference flow of coolant.")
                .or(Condenser::CCAA.coolant_reference_kg_s as f64),
            CAPACITY,
            Key::optional("film_kg", "kg", MASS, "Water that the films hold.").or(Condenser::CCAA.film_kg as f64),
            START,
            Key::optional("separator_kg", "kg", MASS, "Water that the separator holds.").or(SEPARATOR_KG),
            Key::optional("discharge_s", "s", SOME_TIME, "Time between two discharges.").or(DISCHARGE_S),
            Key::optional("slug_kg", "kg", MASS, "Water that leaves at once when the separator loses it.").or(SLUG_KG),
        ],
    ];

    const SIDES: &'static [Carries] = &[Carries::Air, Carries::Coolant];
    const IDLE_WHEN_LINKED: &'static [&'static str] = &["coolant_flow", "coolant_temperature"];
    const OUTPUTS: &'static [OutputSpec] = &[
        OutputSpec { name: "heat", label: "heat out of the air", display: Display::Heat },
        OutputSpec { name: "coolant_heat", label: "heat into the coolant", display: Display::Heat },
        OutputSpec { name: "condensate", label: "water out of the air", display: Display::Trickle },
        OutputSpec { name: "air_outlet", label: "temperature behind the coil", display: Display::Temperature },
        OutputSpec { name: "film", label: "water in the films", display: Display::Mass },
        OutputSpec { name: "separator", label: "water in the separator", display: Display::Mass },
        OutputSpec { name: "tank", label: "water in the condensate tank", display: Display::Mass },
        OutputSpec { name: "slug", label: "water gathered for the next slug", display: Display::Mass },
    ];
    const STATE: usize = 4 * CELLS + STORES;
    const SCRATCH: usize = 3 * CELLS + SHOWN;
    const SETTLES: bool = true;

    fn from_file(draft: &mut Draft<'_>) -> Self {
        draft.needs_air();
        let Loss { resistance_pa_s2_kg2, least_opening } = Loss::from_file(draft);
        Self {
            resistance_pa_s2_kg2,
            least_opening,
            air_w_k: draft.single("air_w_k"),
            air_reference_kg_s: draft.single("air_reference_kg_s"),
            air_exponent: draft.single("air_exponent"),
            coolant_w_k: draft.single("coolant_w_k"),
            coolant_reference_kg_s: draft.single("coolant_reference_kg_s"),
            capacity_j_k: draft.single("capacity_j_k"),
            film_kg: draft.single("film_kg"),
            start_k: draft.optional("temperature_k").unwrap_or(draft.line.from_k) as f32,
            separator_kg: draft.single("separator_kg"),
            discharge_s: draft.single("discharge_s"),
            slug_kg: draft.single("slug_kg"),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.loss().check()?;
        self.coil().check()?;
        ParameterError::unless_positive("start_k", self.start_k)?;
        ParameterError::unless_positive("separator_kg", self.separator_kg)?;
        ParameterError::unless_positive("discharge_s", self.discharge_s)?;
        ParameterError::unless_positive("slug_kg", self.slug_kg)
    }

    fn check_step(&self, step_s: f32) -> Result<(), StepBound> {
        self.coil().check_step(step_s)
    }

    loss_face!(SEPARATOR_EFFICIENCY, COOLANT_FLOW, COOLANT_TEMPERATURE, FOULING, DISCHARGE);

    fn start(&self, _placed: &Placed, step: &StepContext<'_>, block: Block<'_>) {
        if let Some(Cut { shown, .. }) = Cut::of(block) {
            shown[2] = self.start_k - step.reference_k;
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
        let [_, _, _, fouling] = step.inputs_of(placed.first_input);
        let (before, condenser) = (*stream, self.coil());
        let mut coil = cut.coil(&condenser, self.start_k, 1.0 - fouling, step);
        if passing.side == COOLANT {
            coil.pass_coolant(stream, step.step_s, step.coolant);
            cut.shown[3] = stream.energy_j - before.energy_j;
            return Heat::default();
        }
        coil.pass_air(stream, step.step_s, passing.pressure_pa, passing.reversed);
        let water = before.vapour_kg() - stream.vapour_kg();
        let theta = stream.theta_k(step.air);
        // Condensate leaves as a liquid, which lies below its vapour by the evaporation enthalpy.
        let liquid = step.air.flowing_j_kg_k[LIQUID] * theta - step.air.latent_j_kg;
        [cut.shown[0], cut.shown[1], cut.shown[2]] =
            [(before.energy_j - stream.energy_j) - water * liquid, water, theta];
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
        let [efficiency, flow, temperature, fouling, discharge] = step.inputs_of(placed.first_input);
        let condenser = self.coil();
        if !placed.linked {
            let taken = cut
                .coil(&condenser, self.start_k, 1.0 - fouling, step)
                .pass_own_coolant(flow, temperature, step);
            cut.shown[3] = taken;
            account.take_up_heat(-taken);
        }
        let drained = cut.coil(&condenser, self.start_k, 1.0, step).settle();
        let Self { separator_kg, discharge_s, slug_kg, .. } = *self;
        let separator = Separator { separator_kg, discharge_s, slug_kg };
        let lost = separate(&separator, cut.stores, drained, efficiency, discharge >= 0.5, step.step_s);
        account.give([LIQUID, ENERGY], [lost.water_kg, lost.energy_j]);
    }

    fn holds(&self, state: &[f32], held: &mut dyn FnMut(usize, f32)) {
        let (walls, stores) = state.split_at_checked(4 * CELLS).unwrap_or_default();
        let mut pairs = |part: usize, sums: &[f32], carries: &[f32]| {
            for sum in sums { held(part, *sum); }
            for carry in carries { held(part, -carry); }
        };
        if let Some([energy, energy_carry, film, film_carry]) = walls.as_chunks::<CELLS>().0.first_chunk() {
            pairs(ENERGY, energy, energy_carry);
            pairs(VAPOUR, film, film_carry);
        }
        for (part, pair) in [VAPOUR, VAPOUR, VAPOUR, ENERGY, ENERGY].iter().zip(stores.as_chunks::<2>().0) {
            pairs(*part, &pair[..1], &pair[1..]);
        }
    }

    fn output(&self, item: usize, _placed: &Placed, step: &StepContext<'_>, seen: Seen<'_>) -> f32 {
        let (walls, stores) = seen.state.split_at_checked(4 * CELLS).unwrap_or_default();
        let shown = seen.scratch.get(3 * CELLS..).unwrap_or_default();
        let (Some(&[heat, water, theta, taken]), Some(&[separator, _, tank, _, slug])) =
            (shown.first_chunk(), stores.first_chunk())
        else {
            return f32::NAN;
        };
        match item {
            0 => heat / step.step_s,
            1 => taken / step.step_s,
            2 => water / step.step_s,
            3 => step.reference_k + theta,
            4 => walls.as_chunks::<CELLS>().0.get(2).map_or(0.0, |film| film.iter().sum()),
            5 => separator,
            6 => tank,
            _ => slug,
        }
    }
}

/// Side of an exchanger that the stream of its coolant passes.
const COOLANT: u8 = 1;

/// Share of the drained water that the separator keeps.
const SEPARATOR_EFFICIENCY: InputSpec =
    InputSpec { name: "separator_efficiency", unit: "1", min: 0.0, max: 1.0, default: 1.0 };
/// Flow of coolant from outside the network.
pub(super) const COOLANT_FLOW: InputSpec =
    InputSpec { name: "coolant_flow", unit: "kg/s", min: 0.0, max: 0.25, default: 0.0 };
/// Temperature of that coolant.
pub(super) const COOLANT_TEMPERATURE: InputSpec =
    InputSpec { name: "coolant_temperature", unit: "K", min: 273.15, max: 333.15, default: 277.5 };
/// Share of both sides' conductances that fouling takes.
pub(super) const FOULING: InputSpec =
    InputSpec { name: "fouling", unit: "1", min: 0.0, max: 1.0, default: 0.0 };
/// Whether the separator is discharged.
const DISCHARGE: InputSpec = InputSpec { name: "discharge", unit: "1", min: 0.0, max: 1.0, default: 1.0 };

/// Heat out of the stream and into the coolant [J], water out of the stream [kg], temperature behind the coil over the
/// reference [K], in the last step: heat, water, temperature, coolant's heat.
const SHOWN: usize = 4;

/// State and scratch of a coil.
struct Cut<'b> {
    walls: &'b mut WallStates,
    stores: &'b mut [f32; STORES],
    figures: &'b mut WallFigures,
    shown: &'b mut [f32; SHOWN],
}

impl<'b> Cut<'b> {
    #[inline]
    fn of(Block { state, scratch }: Block<'b>) -> Option<Self> {
        let (walls, stores) = state.split_at_mut_checked(4 * CELLS)?;
        let (figures, shown) = scratch.split_at_mut_checked(3 * CELLS)?;
        Some(Self {
            walls: walls.as_chunks_mut().0.first_chunk_mut()?,
            stores: stores.first_chunk_mut()?,
            figures: figures.as_chunks_mut().0.first_chunk_mut()?,
            shown: shown.first_chunk_mut()?,
        })
    }

    #[inline]
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
