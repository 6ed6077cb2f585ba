//! What the flows of a step carry from volume to volume, and what happens to it on the way.

use super::Climate;
use super::buffers::{State, Work};
use super::condenser::{Coil, WallFigures, WallStates};
use super::exchanger;
use super::medium::{LIQUID, NITROGEN};
use super::parts::{Passage, Station};
use super::step::{Given, Stepped, input};
use super::stream::Stream;
use super::volume::{Contents, ENERGY, Stored};
use crate::unroll::every;
use crate::{Line, Network};

/// A stream of air as a row; taken where `sign` is −1, with the same numbers.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn row(stream: &Stream, sign: f32) -> Stored {
    let [a, b, c, d, e, f] = stream.mass_kg;
    [sign * a, sign * b, sign * c, sign * d, sign * e, sign * f, sign * stream.energy_j, 0.0]
}

/// Share of its conductances that fouling has left to an exchanger [1].
fn clean(climate: &Climate<'_>, at: Stepped<'_>, index: usize) -> f32 {
    climate.exchangers.get(index).map_or(1.0, |exchanger| 1.0 - input(at.inputs, exchanger.first_input + 3))
}

/// One coil of the network while it is stepped.
fn coil<'c>(
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

/// Passes every line's stream from the volume upstream through its stations to the volume downstream.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(super) fn move_lines<E, const UNROLL: bool>(
    network: &Network<'_, E>,
    at: Stepped<'_>,
    given: Given<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    let mut stations = network.climate.stations;
    every!(UNROLL, 0..network.lines.len(), index => {
        if let Some(line) = network.lines.get(index) {
            let own = |station: &&Station| station.line as usize == index;
            // A compiler that knows the description finds a line's own among all.
            let count = if UNROLL { 0 } else { stations.iter().take_while(own).count() };
            let (here, rest) = stations.split_at_checked(count).unwrap_or((&[], &[]));
            stations = rest;
            if let Some(moved) = moved_kg(given, index, work) {
                move_line::<E, UNROLL>(network, at, (index, line), moved, here, state, work);
            }
        }
    });
}

/// What a line has given since the last step [kg]: what the method's compensated sum grew by.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn moved_kg(given: Given<'_>, index: usize, work: &mut Work<'_>) -> Option<f32> {
    let &[sum, carry] = given.sums.get(index * given.stride..)?.first_chunk()?;
    let [last_sum, last_carry] = work.given.get_mut(index)?;
    let moved = (sum - *last_sum) - (carry - *last_carry);
    (*last_sum, *last_carry) = (sum, carry);
    Some(moved)
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn move_line<E, const UNROLL: bool>(
    network: &Network<'_, E>,
    at: Stepped<'_>,
    (index, line): (usize, &Line),
    moved: f32,
    here: &[Station],
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    let (from, to) = (line.from as usize, line.to as usize);
    // Said twice, both ends are known where the description is.
    if moved < 0.0 {
        carry_over::<E, UNROLL, true>(network, at, (to, from), -moved, (index, here), state, work);
    } else {
        carry_over::<E, UNROLL, false>(network, at, (from, to), moved, (index, here), state, work);
    }
}

/// Carries `mass` [kg] from the volume `up` to the volume `down`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn carry_over<E, const UNROLL: bool, const REVERSED: bool>(
    network: &Network<'_, E>,
    at: Stepped<'_>,
    (up, down): (usize, usize),
    mass: f32,
    here: (usize, &[Station]),
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    let climate = &network.climate;
    if let Some(figures) = work.figures.get_mut(down) {
        figures[3] += mass;
    }
    let (Some(volume), Some(fractions), Some(figures)) =
        (climate.volumes.get(up), work.fractions.get(up), work.figures.get_mut(up))
    else {
        return;
    };
    figures[4] += mass;
    let [theta, pressure, ..] = *figures;
    if volume.contents == Contents::Air {
        let mut stream = Stream::of(mass, fractions, theta, &climate.air);
        work.books.add_flow(up, &row(&stream, -1.0));
        meet::<UNROLL, REVERSED>(climate, at, here, &mut stream, pressure, state, work);
        work.books.add_flow(down, &row(&stream, 1.0));
    } else {
        let mut stream = Stream::of_coolant(mass, theta, &climate.coolant);
        work.books.add(up, [NITROGEN, ENERGY], [-mass, -stream.energy_j]);
        meet::<UNROLL, REVERSED>(climate, at, here, &mut stream, pressure, state, work);
        work.books.add(down, [NITROGEN, ENERGY], [mass, stream.energy_j]);
    }
}

/// What a stream meets on its way along a line: what is `here`, or for a description that the compiler knows, what of
/// all stations is on this line.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn meet<const UNROLL: bool, const REVERSED: bool>(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    (line, here): (usize, &[Station]),
    stream: &mut Stream,
    pressure: f32,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    if !UNROLL {
        if here.is_empty() {
            return;
        }
        return meet_apart(climate, at, here, stream, (pressure, REVERSED), state, work);
    }
    let stations = climate.stations;
    every!(UNROLL, 0..stations.len(), place => {
        let place = if REVERSED { stations.len() - 1 - place } else { place };
        if let Some(station) = stations.get(place)
            && station.line as usize == line
        {
            pass(climate, at, &station.passage, stream, (pressure, REVERSED), state, work);
        }
    });
}

/// A function of its own, which most lines do not call.
#[inline]
fn meet_apart(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    here: &[Station],
    stream: &mut Stream,
    (pressure, reversed): (f32, bool),
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    for place in 0..here.len() {
        let place = if reversed { here.len() - 1 - place } else { place };
        if let Some(station) = here.get(place) {
            pass(climate, at, &station.passage, stream, (pressure, reversed), state, work);
        }
    }
}

/// What a stream at `pressure` [Pa] meets at one station.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn pass(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    passage: &Passage,
    stream: &mut Stream,
    (pressure, reversed): (f32, bool),
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    match *passage {
        Passage::Machine { power_w, speed_input } => {
            let speed = input(at.inputs, speed_input);
            let heat = power_w * speed * speed * speed * at.step_s;
            stream.energy_j += heat;
            state.outside.supply_heat(heat);
        }
        Passage::Heater { power_input } => {
            let heat = input(at.inputs, power_input) * at.step_s;
            stream.energy_j += heat;
            state.outside.supply_heat(heat);
        }
        Passage::Condenser(of) => {
            let index = of as usize;
            let before = *stream;
            if let Some(mut coil) = coil(climate, clean(climate, at, index), index, state.coils, work.coils) {
                coil.pass_air(stream, at.step_s, pressure, reversed);
            }
            if let Some([heat, water, theta, _]) = work.shown.get_mut(index) {
                *water = before.vapour_kg() - stream.vapour_kg();
                *theta = stream.theta_k(&climate.air);
                // What condenses leaves as a liquid, which lies below its vapour by the evaporation enthalpy.
                let liquid = climate.air.flowing_j_kg_k[LIQUID] * *theta - climate.air.latent_j_kg;
                *heat = (before.energy_j - stream.energy_j) - *water * liquid;
            }
        }
        Passage::LiquidSide(of) => {
            let index = of as usize;
            let before = stream.energy_j;
            if let Some(mut coil) = coil(climate, clean(climate, at, index), index, state.coils, work.coils) {
                coil.pass_liquid(stream, at.step_s, &climate.coolant, reversed);
            }
            if let Some([heat, _, theta, _]) = work.shown.get_mut(index) {
                (*heat, *theta) = (before - stream.energy_j, stream.theta_k(&climate.coolant));
            }
        }
        Passage::CoolantSide(of) => {
            let index = of as usize;
            let before = stream.energy_j;
            if let Some(mut coil) = coil(climate, clean(climate, at, index), index, state.coils, work.coils) {
                coil.pass_coolant(stream, at.step_s, &climate.coolant);
            }
            if let Some([_, _, _, taken]) = work.shown.get_mut(index) {
                *taken = stream.energy_j - before;
            }
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
