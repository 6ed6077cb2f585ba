//! What the flows of a step carry from volume to volume, and what happens to it on the way.

use super::Climate;
use super::buffers::{State, Work};
use super::step::{Given, Stepped};
use super::supply::own_blocks;
use super::volume::Contents;
use crate::component::{Block, Passage, Passing, Range, StepContext};
use crate::fluid::Stream;
use crate::fluid::books::{Accounts, Books, Outside};
use crate::fluid::medium::NITROGEN;
use crate::fluid::stream::{ENERGY, Stored};
use crate::unroll::every;
use crate::{Line, Network};

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
    let mut passages = network.climate.passages;
    let step = network.climate.context(at.step_s, at.inputs);
    every!(UNROLL, 0..network.lines.len(), index => {
        if let Some(line) = network.lines.get(index) {
            let own = |passage: &&Passage| passage.line as usize == index;
            let count = passages.iter().take_while(own).count();
            let (here, rest) = passages.split_at_checked(count).unwrap_or((&[], &[]));
            passages = rest;
            if let Some(moved) = moved_kg(given, index, work) {
                move_line(network, &step, line, moved, here, state, work);
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
fn move_line<E>(
    network: &Network<'_, E>,
    step: &StepContext<'_>,
    line: &Line,
    moved: f32,
    here: &[Passage],
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    let (from, to) = (line.from as usize, line.to as usize);
    // Spelled out per direction so that both node indices are constants in a compiled-in network.
    if moved < 0.0 {
        carry_over::<E, true>(network, step, (to, from), -moved, here, state, work);
    } else {
        carry_over::<E, false>(network, step, (from, to), moved, here, state, work);
    }
}

/// Carries `mass` [kg] from the volume `up` to the volume `down`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn carry_over<E, const REVERSED: bool>(
    network: &Network<'_, E>,
    step: &StepContext<'_>,
    (up, down): (usize, usize),
    mass: f32,
    here: &[Passage],
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
    let way = Passing { side: 0, medium, pressure_pa, reversed: REVERSED };
    if volume.contents == Contents::Air {
        let mut stream = Stream::of(mass, fractions, theta, &climate.air);
        work.books.add_flow(up, &row(&stream, -1.0));
        let left = meet(climate, step, here, &mut stream, way, state, work);
        stream.energy_j += share(left, up, work);
        work.books.add_flow(down, &row(&stream, 1.0));
    } else {
        let mut stream = Stream::of_coolant(mass, theta, &climate.coolant);
        work.books.add(up, [NITROGEN, ENERGY], [-mass, -stream.energy_j]);
        let left = meet(climate, step, here, &mut stream, way, state, work);
        stream.energy_j += share(left, up, work);
        work.books.add(down, [NITROGEN, ENERGY], [mass, stream.energy_j]);
    }
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

/// Lets a stream pass the components of its line. Returns the heat that it could not carry [J].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn meet(
    climate: &Climate<'_>,
    step: &StepContext<'_>,
    here: &[Passage],
    stream: &mut Stream,
    way: Passing<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> f32 {
    if here.is_empty() {
        return 0.0;
    }
    let mut left = 0.0;
    for place in 0..here.len() {
        let place = if way.reversed { here.len() - 1 - place } else { place };
        if let Some(passage) = here.get(place) {
            left += pass(climate, step, passage, stream, way, state, work).unwrap_or(0.0);
        }
    }
    left
}

/// Lets a stream pass one component. Returns the heat that it cannot carry [J].
fn pass(
    climate: &Climate<'_>,
    step: &StepContext<'_>,
    passage: &Passage,
    stream: &mut Stream,
    way: Passing<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> Option<f32> {
    let table = climate.tables.get(passage.table as usize)?;
    let placed = climate.components.get(passage.component as usize)?;
    let Range { first, first_state, first_scratch, blocks: [own_state, own_scratch], .. } = table.range;
    let place = passage.component - first;
    let block = Block {
        state: state.components.get_mut(Range::words(first_state, own_state, place))?,
        scratch: work.scratch.get_mut(Range::words(first_scratch, own_scratch, place))?,
    };
    let heat = table.kind().pass(placed, step, &Passing { side: passage.side, ..way }, block, stream);
    if heat.outside_j != 0.0 {
        state.outside.supply_heat(heat.outside_j);
    }
    Some(heat.left_j)
}

/// Runs the components that work before the streams of a step pass.
pub(super) fn begin(
    climate: &Climate<'_>,
    step: &StepContext<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    for table in climate.tables {
        let kind = table.kind();
        if let [_, true] = kind.acts() {
            kind.begin(climate.placed_of(table), step, own_blocks(table, state.components, work.scratch));
        }
    }
}

/// Runs the components that work after the streams of a step have passed.
pub(super) fn settle(
    climate: &Climate<'_>,
    step: &StepContext<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    let Books { net, lost } = &mut work.books;
    let mut accounts = Accounts::new(Books { net, lost }, Outside(state.outside.0));
    for table in climate.tables {
        let kind = table.kind();
        if let [_, true] = kind.acts() {
            let blocks = own_blocks(table, state.components, work.scratch);
            kind.settle(climate.placed_of(table), step, blocks, &mut accounts);
        }
    }
    accounts.close();
}
