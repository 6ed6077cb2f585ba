//! Carbon dioxide scrubber of a laboratory: eight cells of sorbent along a duct, whose heat goes to the volume around it.
//!
//! `p_in − p_out = R·w·|w|`. The stream meets the cells in its own direction; in each, carbon dioxide decays at a first-order
//! rate that falls with the cell's loading, `dm/dx = −a·(k/8)·(1 − q/Q)·m/w`, exactly integrated over the cell. The heat of
//! capture and the enthalpy that the gas brought leave the sorbent for the volume with the time constant τ.
//!
//! Source: Langmuir's kinetics without desorption, as in D. M. Ruthven, Principles of Adsorption and Adsorption Processes,
//! 1984. Valid for a dry sorbent far from equilibrium.

use eclss_core::component::{Block, Component, Draft, Heat, Passing, Placed, Seen, StepContext};
use eclss_core::components::loss;
use eclss_core::fluid::medium::CARBON_DIOXIDE;
use eclss_core::fluid::{Account, ENERGY, Stream};
use eclss_core::parameter::{Carries, InputSpec, Key, Keys, ParameterError, StepBound};
use eclss_core::signal::{Display, OutputSpec};
use eclss_core::{Law, Operating, math, parameters};

/// Number of cells.
const CELLS: usize = 8;

parameters! {
    /// Fixed data of one scrubber.
    pub struct Scrubber {
        /// Quadratic flow resistance R [Pa·s²/kg²]; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Rate k of a fresh scrubber [kg/s]: flow of air of which it takes 1 − 1/e of the carbon dioxide; finite and > 0.
        pub rate_kg_s: f32,
        /// Carbon dioxide that all cells can hold [kg]; finite and > 0.
        pub capacity_kg: f32,
        /// Heat of capture [J/kg]; finite and ≥ 0.
        pub capture_j_kg: f32,
        /// Time constant τ in which heat leaves the sorbent [s]; at least a step.
        pub release_s: f32,
    }
}

impl Component for Scrubber {
    const KIND: &'static str = "lab_scrubber";
    const ABOUT: &'static str = "Scrubber with eight cells of sorbent; needs `[air]`.";
    const KEYS: Keys = &[
        loss::KEYS,
        &[
            Key::required(
                "rate_kg_s",
                "kg/s",
                (1e-6, 1e3),
                "Flow of which it takes 1 − 1/e of the carbon dioxide.",
            ),
            Key::required("capacity_kg", "kg", (1e-6, 1e4), "Carbon dioxide that it can hold."),
            Key::optional("capture_j_kg", "J/kg", (0.0, 1e7), "Heat of capture.").or(1e6),
            Key::optional("release_s", "s", (1e-3, 1e6), "Time constant of its heat.").or(120.0),
        ],
    ];
    const INPUTS: &'static [InputSpec] =
        &[InputSpec { name: "activity", unit: "1", min: 0.0, max: 1.0, default: 1.0 }];
    const SIDES: &'static [Carries] = &[Carries::Air];
    const OUTPUTS: &'static [OutputSpec] = &[
        OutputSpec { name: "uptake", label: "carbon dioxide out of the air", display: Display::Trickle },
        OutputSpec { name: "loading", label: "carbon dioxide held", display: Display::Mass },
    ];
    const STATE: usize = 2 * CELLS + 2;
    const SCRATCH: usize = CELLS + 1;
    const SETTLES: bool = true;

    fn from_file(draft: &mut Draft<'_>) -> Self {
        draft.needs_air();
        Self {
            resistance_pa_s2_kg2: loss::resistance(draft),
            rate_kg_s: draft.single("rate_kg_s"),
            capacity_kg: draft.single("capacity_kg"),
            capture_j_kg: draft.single("capture_j_kg"),
            release_s: draft.single("release_s"),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_not_negative("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        ParameterError::unless_positive("rate_kg_s", self.rate_kg_s)?;
        ParameterError::unless_positive("capacity_kg", self.capacity_kg)?;
        ParameterError::unless_not_negative("capture_j_kg", self.capture_j_kg)?;
        ParameterError::unless_positive("release_s", self.release_s)
    }

    fn check_step(&self, step_s: f32) -> Result<(), StepBound> {
        // Pure carbon dioxide must not fill a cell, nor heat leave, faster than a step.
        let least = self.rate_kg_s * step_s;
        if self.capacity_kg < least {
            return Err(StepBound { parameter: "capacity_kg", least, unit: "kg" });
        }
        if self.release_s < step_s {
            return Err(StepBound { parameter: "release_s", least: step_s, unit: "s" });
        }
        Ok(())
    }

    fn law(&self, at: &Operating<'_>) -> Law {
        Law::quadratic(self.resistance_pa_s2_kg2 / at.density_ratio)
    }

    fn least_resistance_pa_s2_kg2(&self) -> f32 {
        self.resistance_pa_s2_kg2
    }

    fn begin(&self, _placed: &Placed, _step: &StepContext<'_>, block: Block<'_>) {
        // A stream at rest does not pass.
        block.scratch.fill(0.0);
    }

    fn pass(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        passing: &Passing<'_>,
        block: Block<'_>,
        stream: &mut Stream,
    ) -> Heat {
        let (Some(cells), Some((taken, [enthalpy]))) =
            (block.state.first_chunk::<CELLS>(), block.scratch.split_first_chunk_mut::<CELLS>())
        else {
            return Heat::default();
        };
        let [activity] = step.inputs_of(placed.first_input);
        let mass: f32 = stream.mass_kg.iter().sum();
        if mass <= 0.0 {
            return Heat::default();
        }
        let theta = stream.theta_k(passing.medium);
        // A stream near rest gives all that it has: e⁻⁸⁰ is nothing.
        let units = math::smaller(activity * self.rate_kg_s * step.step_s / mass, 80.0 * CELLS as f32);
        let room = 1.0 / self.capacity_kg;
        let mut all = 0.0;
        for place in 0..CELLS {
            let cell = if passing.reversed { CELLS - 1 - place } else { place };
            let free = math::larger(1.0 - cells[cell] * CELLS as f32 * room, 0.0);
            let share = 1.0 - math::exp(-units * free / CELLS as f32);
            taken[cell] = share * stream.mass_kg[CARBON_DIOXIDE];
            stream.mass_kg[CARBON_DIOXIDE] -= taken[cell];
            all += taken[cell];
        }
        *enthalpy = passing.medium.flowing_j_kg_k[CARBON_DIOXIDE] * theta * all;
        stream.energy_j -= *enthalpy;
        Heat::default()
    }

    fn settle(
        &self,
        _placed: &Placed,
        step: &StepContext<'_>,
        block: Block<'_>,
        account: &mut Account<'_, '_>,
    ) {
        let (Some(([cells, carries], [heat, carry])), Some((taken, [enthalpy]))) =
            (split(block.state), block.scratch.split_first_chunk::<CELLS>())
        else {
            return;
        };
        math::compensated_add_row(cells, carries, taken);
        let captured = self.capture_j_kg * taken.iter().sum::<f32>();
        // The bond's energy was no part of the network's.
        account.take_up_heat(captured);
        let released = *heat * (step.step_s / self.release_s);
        for energy in [*enthalpy, captured, -released] {
            math::compensated_add(heat, carry, energy);
        }
        account.give([ENERGY], [released]);
    }

    fn holds(&self, state: &[f32], held: &mut dyn FnMut(usize, f32)) {
        if let ([cells, carries], [heat, carry]) =
            (state.as_chunks::<CELLS>().0, state.as_chunks::<CELLS>().1)
        {
            for cell in cells {
                held(CARBON_DIOXIDE, *cell);
            }
            for carry in carries {
                held(CARBON_DIOXIDE, -carry);
            }
            held(ENERGY, *heat);
            held(ENERGY, -carry);
        }
    }

    fn output(&self, item: usize, _placed: &Placed, step: &StepContext<'_>, seen: Seen<'_>) -> f32 {
        let sum = |words: &[f32]| words.first_chunk::<CELLS>().map_or(f32::NAN, |cells| cells.iter().sum());
        match item {
            0 => sum(seen.scratch) / step.step_s,
            _ => sum(seen.state),
        }
    }
}

/// Cuts the state into masses of the cells and their carries, heat and its carry.
fn split(state: &mut [f32]) -> Option<([&mut [f32; CELLS]; 2], &mut [f32; 2])> {
    let (cells, rest) = state.split_first_chunk_mut()?;
    let (carries, rest) = rest.split_first_chunk_mut()?;
    Some(([cells, carries], rest.first_chunk_mut()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::fluid::Medium;

    const FRESH: Scrubber = Scrubber {
        resistance_pa_s2_kg2: 5e4,
        rate_kg_s: 0.02,
        capacity_kg: 0.1,
        capture_j_kg: 1e6,
        release_s: 120.0,
    };
    const FLOW_KG_S: f32 = 0.03;
    const STEP_S: f32 = 0.1;

    /// Passes a step of air with a gram of carbon dioxide a kilogram; returns the stream behind and what the cells took.
    fn pass(state: &mut [f32; Scrubber::STATE], reversed: bool) -> (Stream, [f32; CELLS]) {
        let air = Medium::air(295.15);
        let fractions = [0.77, 0.229, 0.001, 0.0, 0.0, 0.0];
        let mut stream = Stream::of(FLOW_KG_S * STEP_S, &fractions, 5.0, &air);
        let step = StepContext {
            step_s: STEP_S,
            reference_k: 295.15,
            air: &air,
            coolant: &Medium::NONE,
            inputs: &[1.0],
        };
        let placed = Placed { row: FRESH.into_any().row(), node: 0, first_input: 0, linked: false };
        let passing = Passing { side: 0, medium: &air, pressure_pa: 101_325.0, reversed };
        let mut scratch = [0.0; Scrubber::SCRATCH];
        FRESH.pass(&placed, &step, &passing, Block { state, scratch: &mut scratch }, &mut stream);
        assert!((stream.theta_k(&air) - 5.0).abs() < 1e-4, "the temperature moved");
        (stream, *scratch.first_chunk().expect("cells"))
    }

    #[test]
    fn a_fresh_scrubber_leaves_what_decays_exponentially() {
        let (stream, taken) = pass(&mut [0.0; Scrubber::STATE], false);
        let before = 0.001 * FLOW_KG_S * STEP_S;
        let left = before * (-FRESH.rate_kg_s / FLOW_KG_S).exp();
        assert!((stream.mass_kg[CARBON_DIOXIDE] / left - 1.0).abs() < 1e-5, "{stream:?}");
        assert!((taken.iter().sum::<f32>() + stream.mass_kg[CARBON_DIOXIDE] - before).abs() < 1e-12);
    }

    #[test]
    fn the_first_cell_on_the_way_takes_most_and_a_full_one_nothing() {
        let (_, forward) = pass(&mut [0.0; Scrubber::STATE], false);
        let (_, mut back) = pass(&mut [0.0; Scrubber::STATE], true);
        assert!(forward.windows(2).all(|pair| pair[0] > pair[1]), "{forward:?}");
        back.reverse();
        assert_eq!(forward.map(f32::to_bits), back.map(f32::to_bits));
        let mut state = [0.0; Scrubber::STATE];
        state[0] = FRESH.capacity_kg / CELLS as f32;
        let (_, taken) = pass(&mut state, false);
        assert!(
            taken[0].abs() < f32::MIN_POSITIVE && (taken[1] / forward[0] - 1.0).abs() < 1e-5,
            "{taken:?}"
        );
    }
}
