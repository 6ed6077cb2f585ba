//! The coils of all condensing heat exchangers: their walls before and after the streams of a step have passed.

use super::Climate;
use super::buffers::{State, Work};
use super::condenser::{Coil, WallFigures, WallStates};
use super::exchanger;
use super::medium::LIQUID;
use super::step::{Stepped, input};
use super::stream::Stream;
use super::volume::ENERGY;

/// Share of its conductances that fouling has left to an exchanger [1].
pub(super) fn clean(climate: &Climate<'_>, at: Stepped<'_>, index: usize) -> f32 {
    climate.exchangers.get(index).map_or(1.0, |exchanger| 1.0 - input(at.inputs, exchanger.first_input + 3))
}

/// One coil of the network while it is stepped.
pub(super) fn coil<'c>(
    climate: &'c Climate<'_>,
    clean: f32,
    index: usize,
    walls: &'c mut [WallStates],
    figures: &'c mut [WallFigures],
) -> Option<Coil<'c>> {
    let exchanger = climate.exchangers.get(index)?;
    Some(Coil {
        condenser: &exchanger.condenser,
        air: &climate.air,
        clean,
        reference_k: climate.reference_k,
        start_theta_k: exchanger.start_k - climate.reference_k,
        walls: walls.get_mut(index)?,
        figures: figures.get_mut(index)?,
    })
}

/// Derives the temperatures of all walls.
pub(super) fn begin_coils(climate: &Climate<'_>, state: &mut State<'_>, work: &mut Work<'_>) {
    for index in 0..climate.exchangers.len() {
        if let Some(mut coil) = coil(climate, 1.0, index, state.coils, work.coils) {
            coil.begin();
        }
    }
}

/// Coolant from outside, then heat and water of all coils.
pub(super) fn settle_coils(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    for (index, exchanger) in climate.exchangers.iter().enumerate() {
        let inputs = at.inputs.get(exchanger.first_input as usize..).and_then(<[f32]>::first_chunk);
        let Some(&[efficiency, flow, temperature, fouling, discharge]) = inputs else { continue };
        let Some(mut coil) = coil(climate, 1.0 - fouling, index, state.coils, work.coils) else { continue };
        if exchanger.own_coolant {
            let mass = flow * at.step_s;
            let theta = temperature - climate.reference_k;
            let mut stream = Stream::of_coolant(mass, theta, &climate.coolant);
            let before = stream.energy_j;
            coil.pass_coolant(&mut stream, at.step_s, &climate.coolant);
            state.outside.supply_heat(before - stream.energy_j);
            if let Some([_, _, _, taken]) = work.shown.get_mut(index) {
                *taken = stream.energy_j - before;
            }
        }
        let drained = coil.settle();
        let Some(stores) = state.stores.get_mut(index) else { continue };
        let lost = exchanger::separate(exchanger, stores, drained, efficiency, discharge >= 0.5, at.step_s);
        work.books.add(exchanger.outlet_node as usize, [LIQUID, ENERGY], [lost.water_kg, lost.energy_j]);
    }
}
