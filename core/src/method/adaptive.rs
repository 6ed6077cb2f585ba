//! Adaptive explicit Euler on any network: quasi-steady lines, explicit nodes, no matrix.
//!
//! The series elements of a line combine in closed form: with `y = p_from − p_to + f` and the line's sums ΣR,
//! ΣL of quadratic and linear resistance, `w = G·y` with the secant conductance
//! `G = 2/(ΣL + √(ΣL² + 4·ΣR·max(|y|, y_lin)))`. Nodes are the real volumes:
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

use super::common::{self, Common, Cut, LineState, NodeState};
use crate::element::{Element, Law, Operating};
use crate::operator::{self, Margin};
use crate::simulator::{Fault, Place};
use crate::{Line, Method, MethodError, Network, math};

/// Safety factor of the operator; the proof holds up to 2(√2 − 1).
const THETA: f32 = 0.8;

/// Largest ratio of a line's inlet to its outlet flow for which θ keeps the proof: θ·(1 + √(1 + U²))/2 ≤ 1.
const LARGEST_RATIO: f32 = 1.118;

/// Smallest driving pressure at which a conductance is taken [Pa]: a line without laminar limit and without
/// driving pressure would have an infinite one.
const SMALLEST_DRIVE_PA: f32 = 1e-9;

/// How often a line whose law follows its flow is asked again within a step.
const INNER_ITERATIONS: u32 = 3;

/// Figures of a node: pressure [Pa gauge]; net transfer of this step and what its sum lost [kg]; ΣG
/// [kg/(s·Pa)]; dp/dm [Pa/kg]; h·c/θ (times ΣG the node's stiffness over θ); pressure at the start [Pa gauge];
/// φ of the last step.
pub(crate) const NODE_FIGURES: usize = 8;
type NodeFigures = [f32; NODE_FIGURES];

/// ΣR and ΣL for forward flow, both for reverse flow, and Σf of a line.
type Sums = [f32; 5];

/// Figures of a line: ΣR forward; Σf; smallest driving pressure at which its law is not linear [Pa], negative
/// for a line that is not plain; then what only those need: ΣL forward, ΣR and ΣL reverse, ratio of inlet and of
/// outlet flow to the line's flow, when forward.
///
/// A plain line drains nothing, has no linear loss and resists alike in both directions.
type LineFigures = [f32; 8];

pub(crate) fn sizes<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    let (nodes, lines) = (network.nodes.len(), network.lines.len());
    (Common::length(network), NODE_FIGURES * nodes + (8 + 5) * lines)
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
    Method::refuse_junctions(network)
}

struct Work<'w> {
    nodes: &'w mut [NodeFigures],
    lines: &'w mut [LineFigures],
    /// The part of every line's sums that never changes.
    constant: &'w mut [Sums],
}

impl<'w> Work<'w> {
    fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let cut = &mut Cut(buffer);
        let (nodes, lines) = (cut.take_rows(network.nodes.len()), cut.take_rows(network.lines.len()));
        Self { nodes, lines, constant: cut.take_rows(network.lines.len()) }
    }
}

/// Sets the start state and everything that stays constant during a run.
pub(crate) fn start<E: Element>(
    network: &Network<'_, E>,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    inputs: &[f32],
) {
    state.fill(0.0);
    work.fill(0.0);
    let state = Common::cut(network, &mut Cut(state));
    let work = Work::of(network, work);
    for (node, figures) in network.nodes.iter().zip(work.nodes) {
        let per_mass = node.pressure_per_mass_pa_kg();
        let start = node.start_gauge_pa;
        *figures = [start, 0.0, 0.0, 0.0, per_mass, h * per_mass / THETA, start, 1.0];
    }
    let lines = state.lines.iter_mut().zip(work.constant).zip(work.lines);
    for (line, (([flow, ..], constant), figures)) in network.lines.iter().zip(lines) {
        *flow = line.start_flow_kg_s;
        let mut inlet = 1.0;
        let outlet = common::flow_ratios(network, line, |index, segment, ratio| {
            if index == 0 {
                inlet = ratio;
            }
            if !segment.element.is_active() {
                let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
                let law = segment.element.law(&Operating { inputs, mass_flow_kg_s: 0.0, density_ratio: 1.0 });
                add(constant, &law, ratio);
            }
        });
        let smallest = math::larger(line.laminar_below_pa, SMALLEST_DRIVE_PA);
        *figures = [0.0, 0.0, smallest, 0.0, 0.0, 0.0, inlet, outlet];
        set_sums(figures, constant);
    }
}

/// Adds a law whose forward flow is `ratio` times the line's to the line's sums.
fn add(sums: &mut Sums, law: &Law, ratio: f32) {
    let [forward, forward_linear, reverse, reverse_linear, head] = sums;
    *forward += law.resistance * (ratio * ratio);
    *forward_linear += law.linear * ratio;
    *reverse += law.resistance;
    *reverse_linear += law.linear;
    *head += law.head;
}

/// Advances by `h` [s]. Returns the margin of this step and the first value that left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn step<E: Element>(
    network: &Network<'_, E>,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    inputs: &[f32],
) -> (Margin, Option<Place>) {
    let state = Common::cut(network, &mut Cut(state));
    let work = &mut Work::of(network, work);
    if !network.active.is_empty() {
        refresh(network, inputs, state.lines, work);
        iterate(network, inputs, state.lines, work);
    }
    let flows = step_lines(h, network.lines, work.lines, work.nodes, state.lines);
    let (phi, pressures, lowest) = step_nodes(state.nodes, work.nodes);
    // Three figures tell whether anything may be wrong; only then is it looked for.
    let fine = flows < Fault::FLOW_LIMIT_KG_S * Fault::FLOW_LIMIT_KG_S
        && pressures < Fault::GAUGE_LIMIT_PA * Fault::GAUGE_LIMIT_PA
        && lowest >= -network.reference_pa;
    let place = if fine { None } else { first_outside(state.lines, work.nodes, network.reference_pa) };
    (Margin::by_construction(phi), place)
}

/// Sums of a line in the order in which laws are added to them.
fn sums_of(figures: &LineFigures) -> Sums {
    let &[forward, head, _, forward_linear, reverse, reverse_linear, _, _] = figures;
    [forward, forward_linear, reverse, reverse_linear, head]
}

/// Puts sums into a line's figures and marks whether it is plain.
fn set_sums(figures: &mut LineFigures, sums: &Sums) {
    let [forward, forward_linear, reverse, reverse_linear, head] = *sums;
    let &mut [_, _, smallest, _, _, _, inlet, outlet] = figures;
    let alike = (forward - reverse).abs() <= 0.0 && forward_linear + reverse_linear <= 0.0;
    let plain = alike && inlet <= outlet;
    let smallest = if plain { smallest.abs() } else { -smallest.abs() };
    *figures = [forward, head, smallest, forward_linear, reverse, reverse_linear, inlet, outlet];
}

/// Evaluates the laws that may have changed, at the flows of the last step.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn refresh<E: Element>(network: &Network<'_, E>, inputs: &[f32], states: &[LineState], work: &mut Work<'_>) {
    for active in network.active {
        let line = active.line as usize;
        if let (Some(figures), Some(constant)) = (work.lines.get_mut(line), work.constant.get(line)) {
            set_sums(figures, constant);
        }
    }
    for active in network.active {
        let line = active.line as usize;
        let (Some(segment), Some(description), Some(&[w, ..]), Some(figures)) = (
            network.segments.get(active.segment as usize),
            network.lines.get(line),
            states.get(line),
            work.lines.get_mut(line),
        ) else {
            continue;
        };
        let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
        let ratio = ratio_at(network, description, active.segment, figures);
        let mass_flow_kg_s = if w > 0.0 { ratio * w } else { w };
        let law = segment.element.law(&Operating { inputs, mass_flow_kg_s, density_ratio: 1.0 });
        let mut sums = sums_of(figures);
        add(&mut sums, &law, ratio);
        set_sums(figures, &sums);
    }
}

/// Ratio of the flow at a segment to the line's flow; 1 wherever the line drains nothing.
fn ratio_at<E: Element>(network: &Network<'_, E>, line: &Line, segment: u32, figures: &LineFigures) -> f32 {
    let [.., inlet, outlet] = *figures;
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
fn iterate<E: Element>(
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
            if let (Some(description), Some([w, ..]), Some(figures)) =
                (network.lines.get(line), states.get_mut(line), work.lines.get(line))
            {
                let pressure =
                    |node: u32| work.nodes.get(node as usize).map_or(0.0, |[pressure, ..]| *pressure);
                (*w, _) = flow_of(pressure(description.from) - pressure(description.to), figures);
            }
        }
        refresh(network, inputs, states, work);
    }
}

fn follows_flow<E: Element>(network: &Network<'_, E>, segment: u32) -> bool {
    network.segments.get(segment as usize).is_some_and(|segment| segment.element.follows_flow())
}

/// Flow [kg/s] and secant conductance [kg/(s·Pa)] of any line over the pressure difference of its nodes [Pa].
fn flow_of(difference: f32, figures: &LineFigures) -> (f32, f32) {
    let &[forward, head, smallest, forward_linear, reverse, reverse_linear, _, _] = figures;
    let y = difference + head;
    let (quadratic, linear) = if y > 0.0 { (forward, forward_linear) } else { (reverse, reverse_linear) };
    let drive = math::larger(y.abs(), smallest.abs());
    let conductance = 2.0 / (linear + math::sqrt(linear * linear + 4.0 * (quadratic * drive)));
    (y * conductance, conductance)
}

/// Steps lines between pressures that do not move meanwhile, books them, and adds their transfers and
/// conductances to the nodes at their ends. A node's terms are added in the order of the lines. Returns Σw², which
/// is not a small number when any flow is not.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn step_lines(
    h: f32,
    lines: &[Line],
    figures: &[LineFigures],
    nodes: &mut [NodeFigures],
    states: &mut [LineState],
) -> f32 {
    let mut square = 0.0;
    for ((line, figures), state) in lines.iter().zip(figures).zip(states) {
        let (from, to) = (line.from as usize, line.to as usize);
        let (Some(&[p_from, ..]), Some(&[p_to, ..])) = (nodes.get(from), nodes.get(to)) else { continue };
        let &[resistance, head, smallest, ..] = figures;
        if smallest < 0.0 {
            let [taken, given] = step_special(h, p_from - p_to, figures, state);
            arrive(nodes, from, taken);
            arrive(nodes, to, given);
            square += state[0] * state[0];
            continue;
        }
        let y = (p_from - p_to) + head;
        let conductance = 1.0 / math::sqrt(resistance * math::larger(y.abs(), smallest));
        let w = y * conductance;
        let passed = h * w;
        let [flow, _, given_sum, given_carry, ..] = state;
        *flow = w;
        math::compensated_add(given_sum, given_carry, passed);
        arrive(nodes, from, [-passed, conductance]);
        arrive(nodes, to, [passed, conductance]);
        square += w * w;
    }
    square
}

/// The same for a line that is not plain. Returns transfer and conductance at both ends.
#[inline(never)]
fn step_special(h: f32, difference: f32, figures: &LineFigures, state: &mut LineState) -> [[f32; 2]; 2] {
    let (w, conductance) = flow_of(difference, figures);
    let &[.., inlet, outlet] = figures;
    let [inlet, outlet] = if w > 0.0 { [inlet, outlet] } else { [1.0, 1.0] };
    let passed = h * w;
    let (taken, given) = (inlet * passed, outlet * passed);
    state[0] = w;
    common::book(state, given, taken - given);
    [[-taken, inlet * conductance], [given, outlet * conductance]]
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

/// Moves nodes by what arrived at them and clears it. Returns the smallest φ, Σp², which is not a small
/// number when any pressure is not, and the lowest pressure [Pa gauge, ≤ 0].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn step_nodes(states: &mut [NodeState], figures: &mut [NodeFigures]) -> (f32, f32, f32) {
    let (mut smallest, mut square, mut lowest) = (1.0f32, 0.0f32, 0.0f32);
    for (state, figures) in states.iter_mut().zip(figures) {
        let [mass, carry, owed, owed_carry] = state;
        let [pressure, net, lost, conductance, per_mass, rate, start, slowed] = figures;
        let phi = operator::phi(*rate * *conductance);
        let stored = phi * *net;
        *carry += phi * *lost;
        math::compensated_add(mass, carry, stored);
        if phi < 1.0 {
            math::compensated_add(owed, owed_carry, *net - stored);
            smallest = if phi < smallest { phi } else { smallest };
        }
        *slowed = phi;
        (*net, *lost, *conductance) = (0.0, 0.0, 0.0);
        *pressure = *start + *per_mass * *mass;
        square += *pressure * *pressure;
        lowest = if *pressure < lowest { *pressure } else { lowest };
    }
    (smallest, square, lowest)
}

/// Names what left its range; only asked for when something did.
#[cold]
fn first_outside(lines: &[LineState], nodes: &[NodeFigures], reference_pa: f32) -> Option<Place> {
    let line = lines.iter().position(|[w, ..]| math::beyond(*w, Fault::FLOW_LIMIT_KG_S));
    let node = || nodes.iter().position(|[pressure, ..]| Fault::outside(*pressure, reference_pa));
    line.map(|index| Place::Line(index as u32)).or_else(|| node().map(|index| Place::Node(index as u32)))
}
