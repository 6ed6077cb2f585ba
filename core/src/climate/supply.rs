//! What comes from outside and what changes inside the volumes: crew, sources, removal, free water, walls.

use super::books::ALL;
use super::buffers::{Running, State, Work};
use super::crew;
use super::medium::{CARBON_DIOXIDE, GAS_CONSTANTS_J_KG_K, LIQUID, OXYGEN, PARTS, Parts, VAPOUR, dot};
use super::step::{Stepped, input};
use super::volume::{self, Contents, ENERGY, STORED, Stored};
use super::{Climate, Remover};
use crate::unroll::every;
use crate::{Network, NodeKind, math};

/// Least `c_v` of a part of air [J/(kg·K)], that of carbon dioxide and oxygen.
const LEAST_HEAT_J_KG_K: f32 = 650.0;

/// Crew, sources, removal and free water. What comes in has the temperature of its volume.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(super) fn supply_volumes<E, const UNROLL: bool>(
    network: &Network<'_, E>,
    at: Stepped<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    let climate = &network.climate;
    let mut given = Given::to(0);
    every!(UNROLL, climate.crews.iter(), crew => {
        given.turn_to(crew.node as usize, state, work);
        let [count, activity] = [input(at.inputs, crew.first_input), input(at.inputs, crew.first_input + 1)];
        breathe(climate, count * at.step_s, activity, work, &mut given);
    });
    every!(UNROLL, climate.sources.iter(), source => {
        given.turn_to(source.node as usize, state, work);
        let inputs = at.inputs.get(source.first_input as usize..);
        if let Some([heat, rates @ ..]) = inputs.and_then(<[f32]>::first_chunk::<{ PARTS + 1 }>) {
            give(climate, at.step_s, *heat, rates, work, &mut given);
        }
    });
    every!(UNROLL, climate.removers.iter(), remover => {
        given.turn_to(remover.node as usize, state, work);
        remove(climate, remover, at, work, &mut given);
    });
    given.book(state, work);
    every!(UNROLL, climate.volumes.iter().enumerate(), (node, volume) => {
        let held = network.nodes.get(node).is_some_and(|node| node.kind == NodeKind::Boundary);
        let wets = volume.contents == Contents::Air && !held;
        if let (true, Some(figures), Some(fractions)) = (wets, work.figures.get(node), work.fractions.get(node)) {
            let vapour = volume::evaporated_kg(volume, figures, fractions, &climate.air, climate.reference_k, at.step_s);
            work.books.add(node, [VAPOUR, LIQUID], [vapour, -vapour]);
        }
    });
}

/// What a step has brought into all volumes; nothing without a climate.
#[derive(Clone, Copy, Default)]
pub(crate) struct Supplied<'s> {
    masses: &'s [Stored],
    fractions: &'s [Parts],
}

impl<'s> Supplied<'s> {
    pub(crate) fn of(running: &'s Running<'_>) -> Self {
        Self { masses: running.work.books.net, fractions: running.work.fractions }
    }

    /// As a flow into every volume [kg/s] of what it holds: so much of that would raise the pressure alike, Σ ṁᵢ·Rᵢ/R.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn flows_kg_s(self, climate: &Climate<'_>, step_s: f32) -> impl Iterator<Item = f32> {
        let per_step = 1.0 / step_s;
        let rows = self.masses.iter().zip(self.fractions).zip(climate.volumes);
        rows.map(move |((&[nitrogen, oxygen, carbon_dioxide, vapour, trace, ..], fractions), volume)| {
            let mass = match volume.contents {
                Contents::Air => {
                    let gases = [nitrogen, oxygen, carbon_dioxide, vapour, trace, 0.0];
                    dot(&gases, &GAS_CONSTANTS_J_KG_K) / dot(fractions, &GAS_CONSTANTS_J_KG_K)
                }
                Contents::Coolant => nitrogen,
            };
            mass * per_step
        })
    }
}

/// What comes into one volume from outside in a step. Several sources of one volume, and its crew, are one transfer.
struct Given {
    node: usize,
    /// Masses of all parts [kg] and energy [J].
    sum: Stored,
    /// Their sizes.
    turned: Stored,
}

impl Given {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    fn to(node: usize) -> Self {
        Self { node, sum: [0.0; STORED], turned: [0.0; STORED] }
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    fn add<const N: usize>(&mut self, places: [usize; N], values: [f32; N]) {
        for (place, value) in places.into_iter().zip(values) {
            self.sum[place] += value;
            self.turned[place] += value.abs();
        }
    }

    /// Goes on with the volume `node`; what came into another is booked.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    fn turn_to(&mut self, node: usize, state: &mut State<'_>, work: &mut Work<'_>) {
        if node != self.node {
            self.book(state, work);
            *self = Self::to(node);
        }
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    fn book(&self, state: &mut State<'_>, work: &mut Work<'_>) {
        work.books.add_row(self.node, &self.sum);
        state.outside.supply_row(&self.sum, &self.turned);
    }
}

/// What a remover takes.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn remove(climate: &Climate<'_>, remover: &Remover, at: Stepped<'_>, work: &Work<'_>, given: &mut Given) {
    let (node, part) = (remover.node as usize, remover.part as usize);
    let flow = input(at.inputs, remover.first_input) * input(at.inputs, remover.first_input + 1);
    let (Some([theta, pressure, ..]), Some(fractions)) = (work.figures.get(node), work.fractions.get(node))
    else {
        return;
    };
    let air = &climate.air;
    let (Some(gas), Some(heat)) = (air.gas_j_kg_k.get(part), air.flowing_j_kg_k.get(part)) else { return };
    // ρ = p_i/(R_i·T) of this part alone
    let partial = volume::partial_pressure_pa(part, fractions, *pressure);
    let rate = -flow * partial / (gas * (climate.reference_k + *theta));
    given.add([part, ENERGY], [rate * at.step_s, rate * heat * theta * at.step_s]);
}

/// What people give to a volume and take from it within so many person-seconds.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn breathe(climate: &Climate<'_>, person_s: f32, activity: f32, work: &Work<'_>, given: &mut Given) {
    let theta = work.figures.get(given.node).map_or(0.0, |[theta, ..]| *theta);
    let (heat_w, rates) = crew::person(activity);
    let heats = &climate.air.flowing_j_kg_k;
    let [oxygen, carbon_dioxide, vapour, liquid] =
        [OXYGEN, CARBON_DIOXIDE, VAPOUR, LIQUID].map(|part| (rates[part], rates[part] * heats[part]));
    let sensible = ((oxygen.1 + carbon_dioxide.1) + (vapour.1 + liquid.1)) * theta;
    let energy = heat_w + (sensible - liquid.0 * climate.air.latent_j_kg);
    given.add(
        [OXYGEN, CARBON_DIOXIDE, VAPOUR, LIQUID, ENERGY],
        [oxygen.0, carbon_dioxide.0, vapour.0, liquid.0, energy].map(|rate| rate * person_s),
    );
}

/// Heat [W] and masses [kg/s] from outside.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn give(
    climate: &Climate<'_>,
    step_s: f32,
    heat_w: f32,
    rates: &[f32; PARTS],
    work: &Work<'_>,
    given: &mut Given,
) {
    let theta = work.figures.get(given.node).map_or(0.0, |[theta, ..]| *theta);
    let carried = dot(rates, &climate.air.flowing_j_kg_k) * theta - rates[LIQUID] * climate.air.latent_j_kg;
    let [a, b, c, d, e, f] = *rates;
    given.add(ALL, [a, b, c, d, e, f, heat_w + carried].map(|rate| rate * step_s));
}

/// Heat between volumes, walls and surroundings.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(super) fn pass_walls<const UNROLL: bool>(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    let most_w_kg_k = LEAST_HEAT_J_KG_K / at.step_s;
    every!(UNROLL, climate.walls.iter().zip(state.walls.iter_mut()), (wall, [energy, carry]) => {
        let node = wall.node as usize;
        let (air, mass) = work.figures.get(node).map_or((0.0, 0.0), |[theta, _, mass, ..]| (*theta, *mass));
        let theta = (wall.start_k - climate.reference_k) + *energy / wall.capacity_j_k;
        let outside = input(at.inputs, wall.first_input) - climate.reference_k;
        // What is left of a volume that blows down must not pass the wall's temperature within a step.
        let inner = math::smaller(wall.inner_w_k, most_w_kg_k * mass) * (air - theta) * at.step_s;
        let outer = wall.outer_w_k * (outside - theta) * at.step_s;
        math::compensated_add(energy, carry, inner);
        math::compensated_add(energy, carry, outer);
        work.books.add(node, [ENERGY], [-inner]);
        state.outside.supply_heat(outer);
    });
}
