//! Adaptive explicit Euler on any network: quasi-steady lines, explicit nodes, no matrix.
//!
//! The series elements of a line combine in closed form: with `y = p_from − p_to + f` and the line's sums ΣR,
//! ΣL of quadratic and linear resistance, `w = G·y` with the secant conductance
//! `G = 2/(ΣL + √(ΣL² + 4·ΣR·max(|y|, y_s)))`, `y_s = y_lin + ΣL·√(y_lin/ΣR)`. Nodes are the real volumes:
//!
//! ```text
//! p_i += φ_i·h·c_i·Σw        φ_i = min(1, θ/(h·c_i·ΣG)),  c_i = Rg·T/V,  θ = 0.8
//! ```
//!
//! Non-expansion: with constant inputs max|p − p*| never grows, for any steady state p*, topology and step,
//! as long as θ ≤ 2(√2 − 1) = 0.828 and every line's flow rises strictly with y (derived in `docs/theory.md`;
//! the secant is what carries the proof, the tangent dw/dy fails). A node with φ < 1 behaves as if its volume
//! were V/φ: that part of its storage is fictitious and booked as such. Volumes and inertances inside lines
//! are not used.

mod layout;
mod line;
mod node;
mod respond;

use super::common::{self, NodeState};
use super::responsive::{self, Given};
use crate::component::Element;
use crate::law::{Law, Operating};
use crate::operator::Margin;
use crate::simulator::{Fault, Place};
use crate::{Line, Method, MethodError, Network, Segment, math};

pub(crate) use layout::State;
use layout::{LineLaw, LineState, NodeFigures, Special, Sum, Work};
use line::{add, constant_sums, index_of, set_sums, special_flow, step_plain, step_special, sums_of};
use node::{Range, Watch, move_node};
pub(crate) use respond::whole_line;

/// Safety factor of the operator; the proof holds up to 2(√2 − 1).
const THETA: f32 = 0.8;

/// Largest ratio of a line's inlet to its outlet flow for which θ keeps the proof: θ·(1 + √(1 + U²))/2 ≤ 1.
const LARGEST_RATIO: f32 = 1.118;

/// Smallest driving pressure at which a conductance is taken [Pa]: a line without laminar limit and without
/// driving pressure would have an infinite one.
const SMALLEST_DRIVE_PA: f32 = 1e-9;

/// How often a line whose law follows its flow is asked again within a step.
const INNER_ITERATIONS: u32 = 3;

/// Segments that a compiler that knows a description certainly looks at one by one; of a larger description it is
/// cheaper not to ask what lines are made of.
pub(crate) const FEW: usize = 32;

/// Figures of a node in the work: see [`layout::NodeFigures`].
pub(crate) const NODE_FIGURES: usize = size_of::<NodeFigures>() / size_of::<f32>();

#[inline(never)]
pub(crate) fn sizes<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    sizes_known(network)
}

/// The same, folded where the compiler knows a small description.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn sizes_known<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    let special = network.lines.iter().filter(|line| layout::is_special(network, line)).count();
    let (state, work) = layout::lengths(network.nodes.len(), network.lines.len(), special);
    (state + network.memory_slots(), work)
}

/// Where a line stands among the special ones, as the work says.
pub(crate) fn special_index<E: Element>(
    network: &Network<'_, E>,
    line: usize,
    work: &[f32],
) -> Option<usize> {
    let special = network.lines.get(line).is_some_and(|line| layout::is_special(network, line));
    let place = work.get(Work::law_at(network.nodes.len(), line)).filter(|_| special);
    place.map(|place| place.to_bits() as usize)
}

pub(crate) fn check<E: Element>(network: &Network<'_, E>, step_us: u32) -> Result<(), MethodError> {
    if step_us == 0 {
        return Err(MethodError::Step { longest_us: u32::MAX });
    }
    for (index, line) in (0u32..).zip(network.lines) {
        let segments = network.segments_of(line);
        let upstream: f32 = segments.iter().map(|segment| 1.0 + segment.element.removal()).product();
        if upstream > LARGEST_RATIO {
            return Err(MethodError::TooMuchRemoved(index));
        }
    }
    responsive::check(network, |_, _| false)?;
    Method::refuse_junctions(network)
}

/// Sets the start state and everything that stays constant during a run.
pub(crate) fn start<E: Element>(
    network: &Network<'_, E>,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    given: Given<'_>,
) {
    let inputs = given.inputs;
    state.fill(0.0);
    work.fill(0.0);
    let mut state = State::of(network, state);
    let mut work = Work::of(network, work);
    for (node, figures) in network.nodes.iter().zip(work.nodes.iter_mut()) {
        let (start, per_mass) = (node.start_gauge_pa, node.pressure_per_mass_pa_kg());
        let stiffness = h * per_mass * network.climate.stiffening(node);
        *figures = [start, 0.0, 0.0, 0.0, start, per_mass, stiffness / THETA, 1.0];
    }
    let mut specials = (0u32..).zip(work.specials.iter_mut());
    let rows = state.lines.iter_mut().zip(work.laws.iter_mut());
    for ((index, line), ([flow, ..], law)) in (0u32..).zip(network.lines).zip(rows) {
        *flow = line.start_flow_kg_s;
        let smallest = math::larger(line.laminar_below_pa, SMALLEST_DRIVE_PA);
        let mut sums = [0.0; 5];
        let mut inlet = 1.0;
        let outlet = common::flow_ratios(network, line, |place, segment, ratio| {
            if place == 0 {
                inlet = ratio;
            }
            if !segment.element.is_active() {
                let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
                let law = segment.element.law(&Operating::plain(inputs, 0.0));
                add(&mut sums, &law, ratio);
            }
        });
        let [resistance, .., head] = sums;
        *law = [resistance, head, smallest];
        if layout::is_special(network, line)
            && let Some((place, special)) = specials.next()
        {
            let [forward, forward_linear, reverse, reverse_linear, head] = sums;
            *law = [f32::from_bits(place), 0.0, smallest];
            *special = [
                f32::from_bits(index),
                inlet,
                outlet,
                responsive::of_line(network, line)
                    .map_or(0.0, |entry| responsive::chord_factor(network, entry)),
                forward,
                forward_linear,
                reverse,
                reverse_linear,
                head,
                forward,
                forward_linear,
                reverse,
                reverse_linear,
                head,
            ];
        }
    }
    respond::respond(network, f32::INFINITY, given, &mut state, &mut work);
}

/// Advances by `h` [s]. Returns the margin of this step and the first value that left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn step<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    given: Given<'_>,
) -> (Margin, Option<Place>) {
    let inputs = given.inputs;
    let mut state = State::of(network, state);
    let mut work = Work::of(network, work);
    ask_laws::<E, UNROLL>(network, inputs, state.lines, &mut work);
    if !network.responsive.is_empty() {
        respond::respond(network, h, given, &mut state, &mut work);
    }
    let mut watch = Watch::NOTHING;
    step_lines(h, network.lines, &mut state, &mut work, &mut watch);
    let range = Range::of(network.judged_reference_pa().unwrap_or(f32::INFINITY));
    // A loop that stands alone has all registers of a small processor; a description that the compiler knows is
    // better off without the call.
    let step_nodes = if UNROLL { step_nodes } else { step_nodes_alone };
    watch = step_nodes(range, state.nodes, work.nodes, watch);
    (
        Margin::by_construction(watch.smallest_phi()),
        outside(watch, network.judged_reference_pa(), state.lines, work.nodes),
    )
}

#[inline(never)]
fn step_nodes_alone(
    range: Range,
    states: &mut [NodeState],
    figures: &mut [NodeFigures],
    watch: Watch,
) -> Watch {
    step_nodes(range, states, figures, watch)
}

/// Moves all nodes by what arrived at them, and clears it.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn step_nodes(
    range: Range,
    states: &mut [NodeState],
    figures: &mut [NodeFigures],
    mut watch: Watch,
) -> Watch {
    let mut square = 0.0;
    for (state, figures) in states.iter_mut().zip(figures) {
        let [pressure, net, lost, conductance, start, per_mass, rate, last] = figures;
        (*pressure, *last) = move_node(state, [*start, *per_mass, *rate], [*net, *lost, *conductance]);
        (*net, *lost, *conductance) = (0.0, 0.0, 0.0);
        watch.node(range, *pressure, *last);
        square += *pressure * *pressure;
    }
    watch.squares(square, Fault::GAUGE_LIMIT_PA);
    watch
}

/// The first value that left its range; only looked for when there may be one.
fn outside(
    watch: Watch,
    reference_pa: Option<f32>,
    lines: &[LineState],
    nodes: &[NodeFigures],
) -> Option<Place> {
    if watch.is_fine() { None } else { first_outside(lines, nodes, reference_pa) }
}

/// States the laws that may have changed, at the flows of the last step.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn ask_laws<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    inputs: &[f32],
    states: &mut [LineState],
    work: &mut Work<'_>,
) {
    if network.active.is_empty() {
        return;
    }
    refresh::<E, UNROLL>(network, inputs, states, work);
    iterate::<E, UNROLL>(network, inputs, states, work);
}

/// The special line that an active segment belongs to.
fn special_of<'w>(line: usize, laws: &[LineLaw], specials: &'w mut [Special]) -> Option<&'w mut Special> {
    laws.get(line).and_then(|[place, ..]| specials.get_mut(place.to_bits() as usize))
}

/// `UNROLL` walks all segments, for a description known to the compiler, which then keeps only those that are
/// active; the order is the same.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn refresh<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    inputs: &[f32],
    states: &[LineState],
    work: &mut Work<'_>,
) {
    if UNROLL && network.segments.len() <= FEW {
        let mut specials = work.specials.iter_mut();
        for (line, [w, ..]) in network.lines.iter().zip(states) {
            if layout::is_special(network, line)
                && let Some(special) = specials.next()
            {
                let mut sums = constant_sums(special);
                for (place, segment) in (line.first_segment..).zip(network.segments_of(line)) {
                    if segment.element.is_active() {
                        let ratio = ratio_at(network, line, place, special);
                        add(&mut sums, &law_at(segment, inputs, ratio, *w), ratio);
                    }
                }
                set_sums(special, sums);
            }
        }
        return;
    }
    // The active segments of a line follow each other.
    let mut sums = [0.0; 5];
    let mut before = u32::MAX;
    let mut rest = network.active.iter();
    while let Some(active) = rest.next() {
        let line = active.line as usize;
        let (Some(segment), Some(description), Some(&[w, ..]), Some(special)) = (
            network.segments.get(active.segment as usize),
            network.lines.get(line),
            states.get(line),
            special_of(line, work.laws, work.specials),
        ) else {
            continue;
        };
        if active.line != before {
            sums = constant_sums(special);
            before = active.line;
        }
        let ratio = ratio_at(network, description, active.segment, special);
        add(&mut sums, &law_at(segment, inputs, ratio, w), ratio);
        if rest.as_slice().first().is_none_or(|next| next.line != active.line) {
            set_sums(special, sums);
        }
    }
}

/// Law of a segment whose forward flow is `ratio` times the line's, `w` [kg/s].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn law_at<E: Element>(segment: &Segment<E>, inputs: &[f32], ratio: f32, w: f32) -> Law {
    let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
    let mass_flow_kg_s = if w > 0.0 { ratio * w } else { w };
    segment.element.law(&Operating::plain(inputs, mass_flow_kg_s))
}

/// Ratio of the flow at a segment to the line's flow; 1 wherever the line drains nothing.
fn ratio_at<E: Element>(network: &Network<'_, E>, line: &Line, segment: u32, special: &Special) -> f32 {
    let &[_, inlet, outlet, ..] = special;
    if inlet <= outlet {
        return 1.0;
    }
    let mut ratio = inlet;
    let before = (segment - line.first_segment) as usize;
    for segment in network.segments_of(line).get(..before).unwrap_or(&[]) {
        ratio /= 1.0 + segment.element.removal();
    }
    ratio
}

/// Asks lines whose law follows their flow again, at the flow that the last answer gave. The bound of the
/// step does not depend on how far this has converged: G is always w/y of the flow that is used.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn iterate<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    inputs: &[f32],
    states: &mut [LineState],
    work: &mut Work<'_>,
) {
    if !network.active.iter().any(|active| follows_flow(network, active.segment)) {
        return;
    }
    for _ in 1..INNER_ITERATIONS {
        for active in network.active {
            if !follows_flow(network, active.segment) {
                continue;
            }
            let line = active.line as usize;
            let law = work.laws.get(line).copied();
            if let (Some(description), Some([w, ..]), Some([_, _, smallest]), Some(special)) = (
                network.lines.get(line),
                states.get_mut(line),
                law,
                special_of(line, work.laws, work.specials),
            ) {
                (*w, _) = special_flow(difference(description, work.nodes), &sums_of(special), smallest);
            }
        }
        refresh::<E, UNROLL>(network, inputs, states, work);
    }
}

fn follows_flow<E: Element>(network: &Network<'_, E>, segment: u32) -> bool {
    network.segments.get(segment as usize).is_some_and(|segment| segment.element.follows_flow())
}

/// Pressure difference between the nodes of a line [Pa].
fn difference(line: &Line, nodes: &[NodeFigures]) -> f32 {
    let pressure = |node: u32| nodes.get(node as usize).map_or(0.0, |[pressure, ..]| *pressure);
    pressure(line.from) - pressure(line.to)
}

/// Steps all lines between pressures that do not move meanwhile, books them, and adds their transfers and
/// conductances to the nodes at their ends. A node's terms are added in the order of the lines.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn step_lines(h: f32, lines: &[Line], state: &mut State<'_>, work: &mut Work<'_>, watch: &mut Watch) {
    let nodes = &mut *work.nodes;
    let specials = work.specials.iter().zip(state.drained.iter_mut());
    if specials.len() == lines.len() {
        // Nothing to look up, least of all where the compiler knows the description.
        for (((line, law), state), (special, drained)) in
            lines.iter().zip(work.laws.iter()).zip(state.lines.iter_mut()).zip(specials)
        {
            step_one(h, line, law, special, (state, drained), nodes, watch);
        }
        return;
    }
    let (mut lines, mut laws, mut states) = (lines, &*work.laws, &mut *state.lines);
    let (mut first, mut square) = (0, 0.0);
    for (special, drained) in specials {
        let before = index_of(special).wrapping_sub(first) as usize;
        let (Some((run, [line, later @ ..])), Some((run_laws, [law, later_laws @ ..]))) =
            (lines.split_at_checked(before), laws.split_at_checked(before))
        else {
            return;
        };
        let Some((run_states, [state, later_states @ ..])) = states.split_at_mut_checked(before) else {
            return;
        };
        if !run.is_empty() {
            square += step_run(h, run, run_laws, run_states, nodes);
        }
        step_one(h, line, law, special, (state, drained), nodes, watch);
        (lines, laws, states) = (later, later_laws, later_states);
        first = index_of(special).wrapping_add(1);
    }
    if !lines.is_empty() {
        square += step_run(h, lines, laws, states, nodes);
    }
    watch.squares(square, Fault::FLOW_LIMIT_KG_S);
}

/// The same for one special line.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn step_one(
    h: f32,
    line: &Line,
    [_, _, smallest]: &LineLaw,
    special: &Special,
    (state, drained): (&mut LineState, &mut Sum),
    nodes: &mut [NodeFigures],
    watch: &mut Watch,
) {
    let [taken, given] = step_special(h, difference(line, nodes), special, *smallest, state, drained);
    watch.flow(state[0]);
    arrive(nodes, line.from as usize, taken);
    arrive(nodes, line.to as usize, given);
}

/// The same for a run of lines that are not special. Returns Σw², which is not a small number when any flow is
/// not. Stands alone because the loop needs all registers of a small processor.
#[inline(never)]
fn step_run(
    h: f32,
    lines: &[Line],
    laws: &[LineLaw],
    states: &mut [LineState],
    nodes: &mut [NodeFigures],
) -> f32 {
    let mut square = 0.0;
    for ((line, law), state) in lines.iter().zip(laws).zip(states) {
        let (from, to) = (line.from as usize, line.to as usize);
        let (Some(&[p_from, ..]), Some(&[p_to, ..])) = (nodes.get(from), nodes.get(to)) else { break };
        let [w, passed, conductance] = step_plain(h, p_from - p_to, law, state);
        arrive(nodes, from, [-passed, conductance]);
        arrive(nodes, to, [passed, conductance]);
        square += w * w;
    }
    square
}

/// Adds one end of a line to its node.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
fn arrive(nodes: &mut [NodeFigures], node: usize, [transfer, conductance]: [f32; 2]) {
    if let Some([_, net, lost, sum, ..]) = nodes.get_mut(node) {
        math::compensated_add(net, lost, transfer);
        *sum += conductance;
    }
}

/// Names what left its range; only asked for when something did.
#[cold]
fn first_outside(lines: &[LineState], nodes: &[NodeFigures], reference_pa: Option<f32>) -> Option<Place> {
    let line = lines.iter().position(|[w, ..]| math::beyond(*w, Fault::FLOW_LIMIT_KG_S));
    let wild = |pressure: f32| reference_pa.is_some_and(|reference| Fault::outside(pressure, reference));
    let node = || nodes.iter().position(|[pressure, ..]| wild(*pressure));
    line.map(|index| Place::Line(index as u32)).or_else(|| node().map(|index| Place::Node(index as u32)))
}
