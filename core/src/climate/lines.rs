//! What the flows of a step carry from volume to volume, and what happens to it on the way.

use super::Climate;
use super::buffers::{State, Work};
use super::coils::{clean, coil};
use super::medium::{LIQUID, Medium, NITROGEN};
use super::parts::{Passage, Station};
use super::step::{Given, Stepped, input};
use super::stream::Stream;
use super::volume::{Contents, ENERGY, LEAST_K, MOST_K, Stored};
use crate::unroll::every;
use crate::{Line, Network, math};

/// A stream of air as a row; taken where `sign` is −1, with the same numbers.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn row(stream: &Stream, sign: f32) -> Stored {
    let [a, b, c, d, e, f] = stream.mass_kg;
    [sign * a, sign * b, sign * c, sign * d, sign * e, sign * f, sign * stream.energy_j, 0.0]
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
    let [theta, pressure_pa, ..] = *figures;
    let medium = volume.medium(&climate.air, &climate.coolant);
    let way = Way { medium, pressure_pa, reversed: REVERSED };
    if volume.contents == Contents::Air {
        let mut stream = Stream::of(mass, fractions, theta, &climate.air);
        work.books.add_flow(up, &row(&stream, -1.0));
        let left = meet::<UNROLL, REVERSED>(climate, at, here, &mut stream, way, state, work);
        stream.energy_j += share(left, up, work);
        work.books.add_flow(down, &row(&stream, 1.0));
    } else {
        let mut stream = Stream::of_coolant(mass, theta, &climate.coolant);
        work.books.add(up, [NITROGEN, ENERGY], [-mass, -stream.energy_j]);
        let left = meet::<UNROLL, REVERSED>(climate, at, here, &mut stream, way, state, work);
        stream.energy_j += share(left, up, work);
        work.books.add(down, [NITROGEN, ENERGY], [mass, stream.energy_j]);
    }
}

/// How a stream passes a line.
#[derive(Clone, Copy)]
struct Way<'m> {
    /// What it is.
    medium: &'m Medium,
    /// Pressure of the volume upstream [Pa].
    pressure_pa: f32,
    /// Whether it flows against the line's direction.
    reversed: bool,
}

/// Heat that a stream could not carry warms both ends of its line alike: nothing carries it either way. Returns what goes to
/// the volume downstream [J].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn share(left_j: f32, up: usize, work: &mut Work<'_>) -> f32 {
    let half = 0.5 * left_j;
    if half != 0.0 {
        work.books.add(up, [ENERGY], [half]);
    }
    half
}

/// Gives a stream heat, as far as it then stays within the temperatures that are followed. Returns what it cannot carry [J].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn warm(climate: &Climate<'_>, heat_j: f32, medium: &Medium, stream: &mut Stream) -> f32 {
    let capacity = stream.capacity_j_k(medium);
    let sensible = stream.energy_j + stream.mass_kg[LIQUID] * medium.latent_j_kg;
    let most = capacity * (MOST_K - climate.reference_k) - sensible;
    let least = capacity * (LEAST_K - climate.reference_k) - sensible;
    let carried = math::larger(math::smaller(least, 0.0), math::smaller(math::larger(most, 0.0), heat_j));
    stream.energy_j += carried;
    heat_j - carried
}

/// What a stream meets on its way along a line: what is `here`, or for a description that the compiler knows, what of
/// all stations is on this line. Returns the heat that it could not carry [J].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn meet<const UNROLL: bool, const REVERSED: bool>(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    (line, here): (usize, &[Station]),
    stream: &mut Stream,
    way: Way<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> f32 {
    let mut left = 0.0;
    if !UNROLL {
        if here.is_empty() {
            return left;
        }
        return meet_apart(climate, at, here, stream, way, state, work);
    }
    let stations = climate.stations;
    every!(UNROLL, 0..stations.len(), place => {
        let place = if REVERSED { stations.len() - 1 - place } else { place };
        if let Some(station) = stations.get(place)
            && station.line as usize == line
        {
            left += pass(climate, at, &station.passage, stream, way, state, work);
        }
    });
    left
}

/// A function of its own, which most lines do not call.
#[inline]
fn meet_apart(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    here: &[Station],
    stream: &mut Stream,
    way: Way<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> f32 {
    let mut left = 0.0;
    for place in 0..here.len() {
        let place = if way.reversed { here.len() - 1 - place } else { place };
        if let Some(station) = here.get(place) {
            left += pass(climate, at, &station.passage, stream, way, state, work);
        }
    }
    left
}

/// What a stream meets at one station. Returns the heat that it cannot carry [J].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn pass(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    passage: &Passage,
    stream: &mut Stream,
    way: Way<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> f32 {
    match *passage {
        Passage::Machine { power_w, speed_input } => {
            let speed = input(at.inputs, speed_input);
            let heat = power_w * speed * speed * speed * at.step_s;
            state.outside.supply_heat(heat);
            return warm(climate, heat, way.medium, stream);
        }
        Passage::Heater { power_input } => {
            let heat = input(at.inputs, power_input) * at.step_s;
            state.outside.supply_heat(heat);
            return warm(climate, heat, way.medium, stream);
        }
        Passage::Condenser(of) => {
            let index = of as usize;
            let before = *stream;
            if let Some(mut coil) = coil(climate, clean(climate, at, index), index, state.coils, work.coils) {
                coil.pass_air(stream, at.step_s, way.pressure_pa, way.reversed);
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
                coil.pass_liquid(stream, at.step_s, &climate.coolant, way.reversed);
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
    0.0
}
