//! Condensing heat exchanger: air over cold walls, coolant behind them, water between.
//!
//! The coil is cut into [`CELLS`] walls along the air's way; the coolant runs against it. Within one step a wall is
//! isothermal, so each side follows in closed form (bypass factor):
//!
//! ```text
//! air      T_o = T_s + b·(T_i − T_s)    W_o = min(W_i, W_s(T_s) + b·(W_i − W_s(T_s)))    b = exp(−NTU_a/n)
//!          W_s = M_w/M_dry·p_s/(p − p_s), the molar mass of the dry gas that flows
//! coolant  T_o = T_s + e·(T_i − T_s)                                                      e = exp(−NTU_c/n)
//! NTU_a = U_a·(w/w_ref)^m/(w·c_p)       NTU_c = U_c·(w_c/w_c,ref)^0.46/(w_c·c_c)
//! ```
//!
//! Heat and mass transfer have the same bypass factor (Lewis number near 1). A dry cell condenses nothing; a cell
//! colder than the dew point grows a film; a film under drier air evaporates again, as far as it covers its cell.
//! What a film cannot hold drains. With liquid in the place of the air the same walls are a liquid-to-liquid exchanger
//! in counterflow. Walls store heat, films store water, and each transfer is one rounded number that
//! leaves one side and enters the other.
//!
//! Source: bypass factor with wall node as in V-HAB's description of the station's exchanger; 0.46 is the exponent of
//! laminar flow through offset strip fins (j ~ Re^−0.54; R. M. Manglik, A. E. Bergles, Exp. Therm. Fluid Sci. 10,
//! 1995): in passages of millimetres such flows of coolant are laminar. `U_a`, m and `U_c` are fitted, see [`Condenser::CCAA`]. Valid for walls
//! of 0…60 °C and air flow in either direction; no frost.

use crate::component::StepContext;
use crate::fluid::medium::{LIQUID, Medium, VAPOUR};
use crate::fluid::stream::Stream;
use crate::parameter::{ParameterError, StepBound};
use crate::{math, moist};

/// Walls along the way of the air.
pub const CELLS: usize = 12;

/// Exponent of the coolant's heat transfer: laminar flow through offset strip fins.
const COOLANT_EXPONENT: f32 = 0.46;
/// Least flow that a side is computed for [kg/s]; below it nothing is exchanged.
const LEAST_FLOW_KG_S: f32 = 1e-6;
/// Most that acts on one wall [W/K]: 1 kg/s of wet air and 0.25 kg/s of water at once.
pub const WALL_LOAD_W_K: f32 = 4e3;

/// Fixed data of one coil.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Condenser {
    /// Conductance between air and wall `U_a` [W/K] at the reference flow; finite and > 0.
    pub air_w_k: f32,
    /// Reference flow of dry air `w_ref` [kg/s]; finite and > 0.
    pub air_reference_kg_s: f32,
    /// Exponent m of the air's flow [1]; 0 … 1.
    pub air_exponent: f32,
    /// Conductance between wall and coolant `U_c` [W/K] at the reference flow; finite and > 0.
    pub coolant_w_k: f32,
    /// Reference flow of coolant `w_c,ref` [kg/s]; finite and > 0.
    pub coolant_reference_kg_s: f32,
    /// Heat capacity of the dry walls [J/K]; finite, and large enough for the step.
    pub capacity_j_k: f32,
    /// Water that the films hold before they drain [kg]; finite and > 0.
    pub film_kg: f32,
}

impl Condenser {
    /// The condensing heat exchanger of the station's common cabin air assembly.
    ///
    /// `U_a`, m and `U_c` are fitted to the rows at 67 °F of the effectiveness table of SAE 2005-01-2801 (through
    /// V-HAB) by `cargo run --release -p eclss-core --example fit_condenser`, with the effectiveness read as
    /// `(T_in − T_out)/(T_in − T_coolant)`; reference flows are free choices, capacity and film are assumed. The table
    /// hardly determines `U_c`: it only says that the coolant's side resists much less than the air's.
    pub const CCAA: Self = Self {
        air_w_k: 490.1,
        air_reference_kg_s: 0.1,
        air_exponent: 0.567_5,
        coolant_w_k: 10_468.0,
        coolant_reference_kg_s: 0.075_6,
        capacity_j_k: 12_000.0,
        film_kg: 0.1,
    };

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("air_w_k", self.air_w_k)?;
        ParameterError::unless_positive("air_reference_kg_s", self.air_reference_kg_s)?;
        ParameterError::unless_fraction("air_exponent", self.air_exponent)?;
        ParameterError::unless_positive("coolant_w_k", self.coolant_w_k)?;
        ParameterError::unless_positive("coolant_reference_kg_s", self.coolant_reference_kg_s)?;
        ParameterError::unless_positive("capacity_j_k", self.capacity_j_k)?;
        ParameterError::unless_positive("film_kg", self.film_kg)
    }

    /// Refuses a heat capacity with which a wall would pass, within a step of `step_s` [s], the temperature that it is
    /// pulled to.
    pub fn check_step(&self, step_s: f32) -> Result<(), StepBound> {
        let least = CELLS as f32 * step_s * WALL_LOAD_W_K;
        if self.capacity_j_k < least {
            return Err(StepBound { parameter: "capacity_j_k", least, unit: "J/K" });
        }
        Ok(())
    }

    /// Share of the way to the wall's state that a flow of `flow_kg_s` with capacity `capacity_w_k` goes in one cell.
    fn contact(conductance_w_k: f32, capacity_w_k: f32) -> f32 {
        let ntu = conductance_w_k / (capacity_w_k * CELLS as f32);
        1.0 - math::exp(-math::smaller(ntu, 80.0))
    }
}

/// One figure of all walls, in the direction of the air, so that a host works on several walls at once.
pub type Cells = [f32; CELLS];

/// State of the walls: energies of wall and film over the start, and their carries [J]; water in the films, and its
/// carries [kg].
pub type WallStates = [Cells; 4];

/// Figures of the walls that a step derives: temperatures over the reference [K]; energy [J] and water [kg] that reach
/// them in this step.
pub type WallFigures = [Cells; 3];

/// Water that leaves a coil during one step, and the energy that it carries.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drained {
    /// Water [kg].
    pub water_kg: f32,
    /// Its energy with respect to the reference temperature [J].
    pub energy_j: f32,
}

/// One coil while it is stepped: [`Self::begin`], both sides in any order, [`Self::settle`].
#[derive(Debug)]
pub struct Coil<'s> {
    /// Fixed data.
    pub condenser: &'s Condenser,
    /// Air as the network has it.
    pub air: &'s Medium,
    /// Share of the conductances that fouling has left [1].
    pub clean: f32,
    /// Reference temperature `T_r` [K].
    pub reference_k: f32,
    /// Temperature of the walls at the start over the reference [K].
    pub start_theta_k: f32,
    /// States.
    pub walls: &'s mut WallStates,
    /// Figures.
    pub figures: &'s mut WallFigures,
}

/// Takes a stream of liquid past walls of these figures in the given order, with `conductance_j_k` [J/K] to all of them
/// in this step.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of a side")]
fn sweep(
    stream: &mut Stream,
    conductance_j_k: f32,
    liquid: &Medium,
    [walls, heats, _]: &mut WallFigures,
    order: impl Iterator<Item = usize>,
) {
    let ([mass, ..], [heat, ..]) = (stream.mass_kg, liquid.flowing_j_kg_k);
    let capacity = heat * mass;
    let remaining = 1.0 - Condenser::contact(conductance_j_k, capacity);
    let (mut theta, mut before) = (stream.energy_j / capacity, stream.energy_j);
    for place in order {
        theta = walls[place] + remaining * (theta - walls[place]);
        let after = capacity * theta;
        heats[place] += before - after;
        before = after;
    }
    stream.energy_j = before;
}

impl Coil<'_> {
    /// Derives the temperatures of all walls from their states and clears what reached them.
    pub fn begin(&mut self) {
        let wall = self.condenser.capacity_j_k * (1.0 / CELLS as f32);
        let heat = self.air.flowing_j_kg_k[LIQUID];
        let [energy, _, film, _] = *self.walls;
        let mut theta = [0.0; CELLS];
        for place in 0..CELLS {
            let stored = wall * self.start_theta_k + energy[place] + film[place] * self.air.latent_j_kg;
            theta[place] = stored / (wall + film[place] * heat);
        }
        *self.figures = [theta, [0.0; CELLS], [0.0; CELLS]];
    }

    /// Passes air through the coil for `step_s` [s] at `pressure_pa` [Pa], `reversed` from its outlet to its inlet:
    /// changes the stream, books heat and water at the walls.
    #[inline(never)] // in a loop over stations its powers would be taken for all of them
    pub fn pass_air(&mut self, stream: &mut Stream, step_s: f32, pressure_pa: f32, reversed: bool) {
        let dry = stream.dry_kg();
        let flow = dry / step_s;
        if flow < LEAST_FLOW_KG_S {
            return;
        }
        let data = self.condenser;
        let heats = &self.air.flowing_j_kg_k;
        let vapour_heat = heats[VAPOUR];
        // Droplets that an earlier coil lost pass unchanged.
        let droplets = stream.mass_kg[LIQUID];
        let mut theta = stream.theta_k(self.air);
        let droplet_energy = droplets * (heats[LIQUID] * theta - self.air.latent_j_kg);
        let mut vapour = stream.vapour_kg();
        let capacity = stream.capacity_j_k(self.air) - heats[LIQUID] * droplets;
        let dry_capacity = capacity - vapour_heat * vapour;
        let conductance =
            self.clean * data.air_w_k * math::pow(flow * (1.0 / data.air_reference_kg_s), data.air_exponent);
        let contact = Condenser::contact(conductance * step_s, capacity);
        let bypass = 1.0 - contact;
        let full = CELLS as f32 / data.film_kg;
        // Vapour [kg] that is as many moles as the dry gas, whatever that is made of.
        let saturable = stream.vapour_of_equal_moles_kg();
        let mut before = stream.energy_j - droplet_energy;
        let ([_, _, film, _], [wall, heat, water]) = (&*self.walls, &mut *self.figures);
        // Vapour that saturates the air at each wall, and what touches its film.
        let (mut saturated, mut wetted) = ([0.0; CELLS], [0.0; CELLS]);
        for ((saturated, wetted), (wall, film)) in
            saturated.iter_mut().zip(&mut wetted).zip(wall.iter().zip(film))
        {
            let saturation = moist::saturation_pressure_pa(self.reference_k + *wall);
            *saturated = saturable * moist::moles_per_dry_mole(saturation, pressure_pa);
            *wetted = contact * math::smaller(*film * full, 1.0);
        }
        let mut meet = |place: usize| {
            // More than saturation condenses; less evaporates a film, where there is one and not more than there is.
            let excess = vapour - saturated[place];
            let wet = if excess > 0.0 { contact } else { wetted[place] };
            let condensed = math::larger(wet * excess, -film[place]);
            vapour -= condensed;
            theta = wall[place] + bypass * (theta - wall[place]);
            let after = (dry_capacity + vapour_heat * vapour) * theta;
            heat[place] += before - after;
            water[place] += condensed;
            before = after;
        };
        if reversed {
            (0..CELLS).rev().for_each(&mut meet);
        } else {
            (0..CELLS).for_each(&mut meet);
        }
        stream.mass_kg[VAPOUR] = vapour;
        stream.energy_j = before + droplet_energy;
    }

    /// Passes coolant through the coil against the air for `step_s` [s]: changes the stream, books heat at the walls.
    #[inline(never)] // in a loop over stations its powers would be taken for all of them
    pub fn pass_coolant(&mut self, stream: &mut Stream, step_s: f32, coolant: &Medium) {
        let [mass, ..] = stream.mass_kg;
        let flow = mass / step_s;
        if flow < LEAST_FLOW_KG_S {
            return;
        }
        let data = self.condenser;
        let conductance = self.clean
            * data.coolant_w_k
            * math::pow(flow * (1.0 / data.coolant_reference_kg_s), COOLANT_EXPONENT);
        sweep(stream, conductance * step_s, coolant, self.figures, (0..CELLS).rev());
    }

    /// Passes coolant from outside the network, `flow_kg_s` [kg/s] at `temperature_k` [K]. Returns the heat that it takes
    /// [J].
    pub fn pass_own_coolant(&mut self, flow_kg_s: f32, temperature_k: f32, step: &StepContext<'_>) -> f32 {
        let (mass, theta) = (flow_kg_s * step.step_s, temperature_k - self.reference_k);
        let mut stream = Stream::of_coolant(mass, theta, step.coolant);
        let before = stream.energy_j;
        self.pass_coolant(&mut stream, step.step_s, step.coolant);
        stream.energy_j - before
    }

    /// Passes liquid through the coil in the place of air for `step_s` [s], `reversed` from its outlet to its inlet:
    /// changes the stream, books heat at the walls.
    #[inline(never)] // in a loop over stations its powers would be taken for all of them
    pub fn pass_liquid(&mut self, stream: &mut Stream, step_s: f32, liquid: &Medium, reversed: bool) {
        let [mass, ..] = stream.mass_kg;
        let flow = mass / step_s;
        if flow < LEAST_FLOW_KG_S {
            return;
        }
        let data = self.condenser;
        let conductance =
            self.clean * data.air_w_k * math::pow(flow * (1.0 / data.air_reference_kg_s), data.air_exponent);
        if reversed {
            sweep(stream, conductance * step_s, liquid, self.figures, (0..CELLS).rev());
        } else {
            sweep(stream, conductance * step_s, liquid, self.figures, 0..CELLS);
        }
    }

    /// Moves heat and water into the walls and drains what the films cannot hold.
    pub fn settle(&mut self) -> Drained {
        let heat = self.air.flowing_j_kg_k[LIQUID];
        let limit = self.condenser.film_kg * (1.0 / CELLS as f32);
        let latent = self.air.latent_j_kg;
        settle(self.walls, self.figures, limit, |theta| heat * theta - latent)
    }
}

/// Moves what reached the walls into them; `limit` [kg] is what one film holds, the closure a kilogram's energy [J/kg].
/// A function of its own, so that a compiler knows both arguments to be apart.
fn settle(
    [energy, energy_carry, film, film_carry]: &mut WallStates,
    [theta, given, water]: &WallFigures,
    limit: f32,
    carries: impl Fn(f32) -> f32,
) -> Drained {
    let (mut over, mut carried) = ([0.0; CELLS], [0.0; CELLS]);
    for place in 0..CELLS {
        over[place] = math::larger(film[place] + water[place] - limit, 0.0);
        carried[place] = over[place] * carries(theta[place]);
        math::compensated_add(&mut energy[place], &mut energy_carry[place], given[place]);
        math::compensated_add(&mut energy[place], &mut energy_carry[place], -carried[place]);
        math::compensated_add(&mut film[place], &mut film_carry[place], water[place]);
        math::compensated_add(&mut film[place], &mut film_carry[place], -over[place]);
    }
    let mut drained = Drained::default();
    for (over, carried) in over.iter().zip(&carried) {
        drained.water_kg += over;
        drained.energy_j += carried;
    }
    drained
}
