//! The step in ranges that may be taken side by side, for large networks on a computer with several processors.
//!
//! First all lines, range by range: none looks at another. Then all nodes, range by range: each gathers what its
//! lines passed, in the order of the lines, which is the order in which [`super::step`] adds it. So the bits depend
//! neither on the ranges nor on who takes them.
//!
//! A network of this size does not fit into any cache, and what it costs is what it moves through memory: tables
//! stand in columns of their own with nothing between that a pass does not need.

use super::layout::{LineLaw, LineState, NodeConstants, NodeFigures, Special, State, Sum, Work};
use super::line::{Transfer, index_of, step_plain, step_special};
use super::node::{Range, Watch, move_node};
use super::respond::respond;
use super::{ask_laws, outside};
use crate::element::Element;
use crate::method::common::NodeState;
use crate::method::responsive::Given;
use crate::operator::{self, Margin};
use crate::simulator::Place;
use crate::{End, Network, math};

/// Lines whose pressure differences, and nodes whose transfers, are gathered before their arithmetic, which then runs over
/// arrays.
const BLOCK: usize = 64;

/// Lines, and nodes, that are not split further: some microseconds of work.
const RANGE: usize = 1_024;

/// Marks what a special line passed: its place among the special ones stands beside it.
const SPECIAL: f32 = -1.0;

/// Does two things, side by side where it can.
pub trait Join: Sync {
    /// Returns what both return.
    fn join<A: Send, B: Send>(
        &self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B);
}

/// Does one thing after the other.
#[derive(Debug, Clone, Copy, Default)]
pub struct InTurn;

impl Join for InTurn {
    fn join<A: Send, B: Send>(
        &self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        (first(), second())
    }
}

/// Tables and results of a step in ranges, besides a simulator's own buffers.
#[derive(Debug)]
pub struct SplitBuffers<'b> {
    /// Nodes at the ends of every line.
    pub between: &'b mut [[u32; 2]],
    /// What every line passed in the last step [kg] and its conductance [kg/(s·Pa)].
    pub passed: &'b mut [[f32; 2]],
    /// The same at both ends of every line whose law may change or that drains; [`Self::special_lines`] of them.
    pub both_ends: &'b mut [[[f32; 2]; 2]],
    /// Gauge pressure of every node [Pa].
    pub pressures: &'b mut [f32],
    /// What a node needs that never changes.
    pub constants: &'b mut [[f32; 3]],
}

impl SplitBuffers<'_> {
    /// Number of lines of a network whose law may change or that drain.
    pub fn special_lines<E: Element>(network: &Network<'_, E>) -> usize {
        network.lines.iter().filter(|line| super::layout::is_special(network, line)).count()
    }

    /// Fills the tables at the start.
    pub(crate) fn fill<E: Element>(&mut self, network: &Network<'_, E>, work: &mut [f32]) {
        for (between, line) in self.between.iter_mut().zip(network.lines) {
            *between = [line.from, line.to];
        }
        let nodes = self.pressures.iter_mut().zip(self.constants.iter_mut());
        for ((pressure, constants), figures) in nodes.zip(Work::of(network, work).nodes) {
            let [gauge, _, _, _, start, per_mass, rate, _] = *figures;
            (*pressure, *constants) = (gauge, [start, per_mass, rate]);
        }
    }

    /// Puts pressures and φ back to where they are read.
    pub(crate) fn show<E: Element>(&self, network: &Network<'_, E>, work: &mut [f32]) {
        let sources = Sources { passed: self.passed, both_ends: self.both_ends };
        let nodes = Work::of(network, work).nodes.iter_mut().zip(self.pressures.iter());
        for ((figures, pressure), bounds) in nodes.zip(network.plan.end_start.windows(2)) {
            let &[first, past] = bounds else { break };
            let ends = network.plan.ends.get(first as usize..past as usize).unwrap_or(&[]);
            let [gauge, _, _, _, _, _, rate, phi] = figures;
            let [_, _, conductance] = sources.gather(ends);
            (*gauge, *phi) = (*pressure, operator::phi(*rate * conductance));
        }
    }
}

/// Advances by `h` [s], as [`super::step`] does.
pub(crate) fn step<E: Element>(
    network: &Network<'_, E>,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    given: Given<'_>,
    buffers: &mut SplitBuffers<'_>,
    join: &impl Join,
) -> (Margin, Option<Place>) {
    let mut state = State::of(network, state);
    let mut work = Work::of(network, work);
    if !(network.active.is_empty() && network.responsive.is_empty()) {
        let active = network.active.iter().map(|active| active.line);
        for line in active.chain(network.responsive.iter().map(|entry| entry.line)) {
            // A law may ask for the pressures of its line.
            for node in network.lines.get(line as usize).map_or([0; 2], |line| [line.from, line.to]) {
                let node = node as usize;
                if let (Some([gauge, ..]), Some(pressure)) =
                    (work.nodes.get_mut(node), buffers.pressures.get(node))
                {
                    *gauge = *pressure;
                }
            }
        }
        ask_laws::<E, false>(network, given.inputs, state.lines, &mut work);
        respond(network, h, given, &mut state, &mut work);
    }
    let lines = Lines {
        first: 0,
        between: buffers.between,
        laws: work.laws,
        states: state.lines,
        passed: buffers.passed,
        specials: work.specials,
        special: 0,
        drained: state.drained,
        both_ends: buffers.both_ends,
    };
    let of_lines = step_lines(join, h, buffers.pressures, lines);
    let nodes = Nodes {
        starts: network.plan.end_start,
        states: state.nodes,
        pressures: buffers.pressures,
        constants: buffers.constants,
    };
    let sources = Sources { passed: buffers.passed, both_ends: buffers.both_ends };
    let of_nodes = step_nodes(
        join,
        Range::of(network.judged_reference_pa().unwrap_or(f32::INFINITY)),
        network.plan.ends,
        sources,
        nodes,
    );
    let watch = of_lines.with(of_nodes);
    let place = if watch.is_fine() {
        None
    } else {
        for (figures, pressure) in work.nodes.iter_mut().zip(buffers.pressures.iter()) {
            figures[0] = *pressure;
        }
        outside(watch, network.judged_reference_pa(), state.lines, work.nodes)
    };
    (Margin::by_construction(watch.smallest_phi()), place)
}

/// A range of lines with the special ones among them.
struct Lines<'r> {
    /// Index of the first line.
    first: usize,
    between: &'r [[u32; 2]],
    laws: &'r [LineLaw],
    states: &'r mut [LineState],
    passed: &'r mut [Transfer],
    specials: &'r [Special],
    /// Place of the first special line.
    special: u32,
    drained: &'r mut [Sum],
    both_ends: &'r mut [[Transfer; 2]],
}

impl Lines<'_> {
    /// Cuts the range in two.
    fn halves(self) -> (Self, Self) {
        let at = self.between.len() / 2;
        let middle = self.first + at;
        let special = self.specials.partition_point(|special| (index_of(special) as usize) < middle);
        let (between, laws) = (self.between.split_at(at), self.laws.split_at(at));
        let (states, passed) = (self.states.split_at_mut(at), self.passed.split_at_mut(at));
        let specials = self.specials.split_at(special);
        let (drained, both_ends) = (self.drained.split_at_mut(special), self.both_ends.split_at_mut(special));
        let left = Self {
            first: self.first,
            between: between.0,
            laws: laws.0,
            states: states.0,
            passed: passed.0,
            specials: specials.0,
            special: self.special,
            drained: drained.0,
            both_ends: both_ends.0,
        };
        let right = Self {
            first: middle,
            between: between.1,
            laws: laws.1,
            states: states.1,
            passed: passed.1,
            specials: specials.1,
            special: self.special + special as u32,
            drained: drained.1,
            both_ends: both_ends.1,
        };
        (left, right)
    }
}

/// Steps lines between pressures that do not move meanwhile.
fn step_lines(join: &impl Join, h: f32, pressures: &[f32], lines: Lines<'_>) -> Watch {
    if lines.between.len() < 2 * RANGE {
        return step_range(h, pressures, lines);
    }
    let (left, right) = lines.halves();
    let (left, right) =
        join.join(|| step_lines(join, h, pressures, left), || step_lines(join, h, pressures, right));
    left.with(right)
}

/// Steps a range of lines: runs of ordinary ones, and the special ones between.
fn step_range(h: f32, pressures: &[f32], lines: Lines<'_>) -> Watch {
    let Lines {
        mut first,
        mut between,
        mut laws,
        mut states,
        mut passed,
        specials,
        special,
        drained,
        both_ends,
    } = lines;
    let mut watch = Watch::NOTHING;
    let specials = specials.iter().zip(drained).zip(both_ends);
    for (place, ((special, drained), both_ends)) in (special..).zip(specials) {
        let before = (index_of(special) as usize).saturating_sub(first);
        let (Some((ends, [own_ends, later_ends @ ..])), Some((run_laws, [law, later_laws @ ..]))) =
            (between.split_at_checked(before), laws.split_at_checked(before))
        else {
            break;
        };
        let (
            Some((run_states, [state, later_states @ ..])),
            Some((run_passed, [own_passed, later_passed @ ..])),
        ) = (states.split_at_mut_checked(before), passed.split_at_mut_checked(before))
        else {
            return watch;
        };
        watch = watch.with(step_run(h, pressures, ends, run_laws, run_states, run_passed));
        *both_ends = step_special(h, difference(*own_ends, pressures), special, law[2], state, drained);
        *own_passed = [f32::from_bits(place), SPECIAL];
        watch.flow(state[0]);
        first = (index_of(special) as usize).saturating_add(1);
        (between, laws, states, passed) = (later_ends, later_laws, later_states, later_passed);
    }
    watch.with(step_run(h, pressures, between, laws, states, passed))
}

/// Pressure difference between two nodes [Pa].
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
fn difference([from, to]: [u32; 2], pressures: &[f32]) -> f32 {
    let pressure = |node: u32| pressures.get(node as usize).copied().unwrap_or(0.0);
    pressure(from) - pressure(to)
}

/// Steps lines none of which is special: scattered reads first, then arithmetic over arrays.
fn step_run(
    h: f32,
    pressures: &[f32],
    between: &[[u32; 2]],
    laws: &[LineLaw],
    states: &mut [LineState],
    passed: &mut [Transfer],
) -> Watch {
    let mut watch = Watch::NOTHING;
    let mut differences = [0.0; BLOCK];
    let blocks = between.chunks(BLOCK).zip(laws.chunks(BLOCK));
    let blocks = blocks.zip(states.chunks_mut(BLOCK).zip(passed.chunks_mut(BLOCK)));
    for ((between, laws), (states, passed)) in blocks {
        for (gathered, ends) in differences.iter_mut().zip(between) {
            *gathered = difference(*ends, pressures);
        }
        let lines = differences.iter().zip(laws).zip(states).zip(passed);
        for (((difference, law), state), passed) in lines {
            let [w, moved, conductance] = step_plain(h, *difference, law, state);
            *passed = [moved, conductance];
            watch.flow(w);
        }
    }
    watch
}

/// A range of nodes. `starts` has one entry more.
struct Nodes<'r> {
    starts: &'r [u32],
    states: &'r mut [NodeState],
    pressures: &'r mut [f32],
    constants: &'r [NodeConstants],
}

impl Nodes<'_> {
    /// Cuts the range in two.
    fn halves(self) -> (Self, Self) {
        let at = self.states.len() / 2;
        let (states, pressures) = (self.states.split_at_mut(at), self.pressures.split_at_mut(at));
        let constants = self.constants.split_at(at);
        let starts = (self.starts.get(..=at).unwrap_or(&[]), self.starts.get(at..).unwrap_or(&[]));
        let left =
            Self { starts: starts.0, states: states.0, pressures: pressures.0, constants: constants.0 };
        let right =
            Self { starts: starts.1, states: states.1, pressures: pressures.1, constants: constants.1 };
        (left, right)
    }
}

/// What all lines passed.
#[derive(Clone, Copy)]
struct Sources<'s> {
    passed: &'s [Transfer],
    both_ends: &'s [[Transfer; 2]],
}

impl Sources<'_> {
    /// What arrives at a node with these ends of lines: net transfer and what its sum lost [kg]; ΣG [kg/(s·Pa)].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "the body of the loop over nodes")]
    fn gather(&self, ends: &[End]) -> [f32; 3] {
        let Some((&first, rest)) = ends.split_first() else { return [0.0; 3] };
        let Some([transfer, mut sum]) = self.at(first) else { return [0.0; 3] };
        // Nothing is lost of the first.
        let (mut net, mut lost) = (0.0 + transfer, 0.0);
        for &end in rest {
            let Some([transfer, conductance]) = self.at(end) else { break };
            math::compensated_add(&mut net, &mut lost, transfer);
            sum += conductance;
        }
        [net, lost, sum]
    }

    /// What one end of a line means for its node.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "the body of the loop over nodes")]
    fn at(&self, end: End) -> Option<Transfer> {
        let &[moved, conductance] = self.passed.get((end / 2) as usize)?;
        let is_outlet = end % 2;
        if conductance.is_sign_negative() {
            return Some(self.of_special(moved, is_outlet));
        }
        // Taken at the inlet, given at the outlet.
        Some([f32::from_bits(moved.to_bits() ^ ((is_outlet ^ 1) << 31)), conductance])
    }

    #[inline(never)]
    fn of_special(&self, place: f32, is_outlet: u32) -> Transfer {
        let ends = self.both_ends.get(place.to_bits() as usize).copied().unwrap_or_default();
        if is_outlet == 1 { ends[1] } else { ends[0] }
    }
}

/// Moves nodes by what their lines passed: scattered reads first, then arithmetic over arrays.
fn step_nodes(join: &impl Join, range: Range, ends: &[End], sources: Sources<'_>, nodes: Nodes<'_>) -> Watch {
    if nodes.states.len() >= 2 * RANGE {
        let (left, right) = nodes.halves();
        let (left, right) = join.join(
            || step_nodes(join, range, ends, sources, left),
            || step_nodes(join, range, ends, sources, right),
        );
        return left.with(right);
    }
    let Nodes { mut starts, states, pressures, constants } = nodes;
    let mut watch = Watch::NOTHING;
    let [mut net, mut lost, mut conductance] = [[0.0; BLOCK]; 3];
    let blocks = states.chunks_mut(BLOCK).zip(pressures.chunks_mut(BLOCK)).zip(constants.chunks(BLOCK));
    for ((states, pressures), constants) in blocks {
        let sums = net.iter_mut().zip(&mut lost).zip(&mut conductance);
        for (((net, lost), conductance), bounds) in sums.zip(starts.windows(2)) {
            let &[first, past] = bounds else { break };
            [*net, *lost, *conductance] =
                sources.gather(ends.get(first as usize..past as usize).unwrap_or(&[]));
        }
        starts = starts.get(states.len()..).unwrap_or(&[]);
        let arrived = net.iter().zip(&lost).zip(&conductance);
        let rows = states.iter_mut().zip(pressures).zip(constants).zip(arrived);
        for (((state, pressure), constants), ((net, lost), conductance)) in rows {
            let phi;
            (*pressure, phi) = move_node(state, *constants, [*net, *lost, *conductance]);
            watch.node(range, *pressure, phi);
        }
    }
    watch
}

/// What a simulator's own figures are sized like.
pub(crate) fn fits<E: Element>(
    network: &Network<'_, E>,
    buffers: &SplitBuffers<'_>,
) -> Option<(&'static str, usize, usize)> {
    let (nodes, lines) = (network.nodes.len(), network.lines.len());
    let special = SplitBuffers::special_lines(network);
    let lengths = [
        ("between", lines, buffers.between.len()),
        ("passed", lines, buffers.passed.len()),
        ("both_ends", special, buffers.both_ends.len()),
        ("pressures", nodes, buffers.pressures.len()),
        ("constants", nodes, buffers.constants.len()),
    ];
    lengths.into_iter().find(|(_, needed, given)| needed != given)
}

const _: () = assert!(size_of::<NodeFigures>() == 32, "a node's row is read by place");
