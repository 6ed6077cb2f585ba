//! What comes from outside and what changes inside the volumes: crew, sources, removal, free water, walls.

use super::buffers::{State, Work};
use super::crew;
use super::medium::{CARBON_DIOXIDE, LIQUID, NITROGEN, OXYGEN, PARTS, TRACE, VAPOUR, dot};
use super::step::{Stepped, input};
use super::volume::{self, Contents, ENERGY};
use super::{Climate, Remover};
use crate::unroll::every;
use crate::{Network, NodeKind, math};

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
    every!(UNROLL, climate.crews.iter(), crew => {
        let [count, activity] = [input(at.inputs, crew.first_input), input(at.inputs, crew.first_input + 1)];
        breathe(climate, crew.node as usize, count * at.step_s, activity, state, work);
    });
    every!(UNROLL, climate.sources.iter(), source => {
        let inputs = at.inputs.get(source.first_input as usize..);
        if let Some([heat, rates @ ..]) = inputs.and_then(<[f32]>::first_chunk::<{ PARTS + 1 }>) {
            give(climate, source.node as usize, at.step_s, *heat, rates, state, work);
        }
    });
    every!(UNROLL, climate.removers.iter(), remover => {
        remove(climate, remover, at, state, work);
    });
    every!(UNROLL, climate.volumes.iter().enumerate(), (node, volume) => {
        let held = network.nodes.get(node).is_some_and(|node| node.kind == NodeKind::Boundary);
        let wets = volume.contents == Contents::Air && volume.surface_kg_s_pa > 0.0 && !held;
        if let (true, Some(figures), Some(fractions)) = (wets, work.figures.get(node), work.fractions.get(node)) {
            let vapour = volume::evaporated_kg(volume, figures, fractions, &climate.air, climate.reference_k, at.step_s);
            work.books.add(node, [VAPOUR, LIQUID], [vapour, -vapour]);
        }
    });
}

/// What a remover takes.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn remove(
    climate: &Climate<'_>,
    remover: &Remover,
    at: Stepped<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
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
    let (mass, energy) = (rate * at.step_s, rate * heat * theta * at.step_s);
    work.books.add(node, [part, ENERGY], [mass, energy]);
    state.outside.supply([part, ENERGY], [mass, energy]);
}

/// What people give to a volume and take from it within so many person-seconds.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn breathe(
    climate: &Climate<'_>,
    node: usize,
    person_s: f32,
    activity: f32,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    const PLACES: [usize; 5] = [OXYGEN, CARBON_DIOXIDE, VAPOUR, LIQUID, ENERGY];
    let theta = work.figures.get(node).map_or(0.0, |[theta, ..]| *theta);
    let (heat_w, rates) = crew::person(activity);
    let heats = &climate.air.flowing_j_kg_k;
    let [oxygen, carbon_dioxide, vapour, liquid] =
        [OXYGEN, CARBON_DIOXIDE, VAPOUR, LIQUID].map(|part| (rates[part], rates[part] * heats[part]));
    let sensible = ((oxygen.1 + carbon_dioxide.1) + (vapour.1 + liquid.1)) * theta;
    let energy = heat_w + (sensible - liquid.0 * climate.air.latent_j_kg);
    let given = [oxygen.0, carbon_dioxide.0, vapour.0, liquid.0, energy].map(|rate| rate * person_s);
    work.books.add(node, PLACES, given);
    state.outside.supply(PLACES, given);
}

/// Heat [W] and masses [kg/s] from outside.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn give(
    climate: &Climate<'_>,
    node: usize,
    step_s: f32,
    heat_w: f32,
    rates: &[f32; PARTS],
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    const PLACES: [usize; 7] = [NITROGEN, OXYGEN, CARBON_DIOXIDE, VAPOUR, TRACE, LIQUID, ENERGY];
    let theta = work.figures.get(node).map_or(0.0, |[theta, ..]| *theta);
    let carried = dot(rates, &climate.air.flowing_j_kg_k) * theta - rates[LIQUID] * climate.air.latent_j_kg;
    let [a, b, c, d, e, f] = *rates;
    let given = [a, b, c, d, e, f, heat_w + carried].map(|rate| rate * step_s);
    work.books.add(node, PLACES, given);
    state.outside.supply(PLACES, given);
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
    every!(UNROLL, climate.walls.iter().zip(state.walls.iter_mut()), (wall, [energy, carry]) => {
        let node = wall.node as usize;
        let air = work.figures.get(node).map_or(0.0, |[theta, ..]| *theta);
        let theta = (wall.start_k - climate.reference_k) + *energy / wall.capacity_j_k;
        let outside = input(at.inputs, wall.first_input) - climate.reference_k;
        let inner = wall.inner_w_k * (air - theta) * at.step_s;
        let outer = wall.outer_w_k * (outside - theta) * at.step_s;
        math::compensated_add(energy, carry, inner);
        math::compensated_add(energy, carry, outer);
        work.books.add(node, [ENERGY], [-inner]);
        state.outside.supply_heat(outer);
    });
}
