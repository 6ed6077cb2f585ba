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

use super::common::{self, Common, Cut, LineSums};
use crate::element::{Element, Law, Operating};
use crate::operator::{self, Margin, Proof};
use crate::simulator::{Fault, Place};
use crate::{Line, Method, MethodError, Network, math};

/// Safety factor of the operator; the proof holds up to 2(√2 − 1).
const THETA: f32 = 0.8;

/// Smallest driving pressure at which a conductance is taken [Pa]: a line without laminar limit and without
/// driving pressure would have an infinite one.
const SMALLEST_DRIVE_PA: f32 = 1e-9;

/// How often a line whose law follows its flow is asked again within a step.
const INNER_ITERATIONS: u32 = 3;

/// ΣR and ΣL for forward flow, both for reverse flow, and Σf of a line.
type Sums = [f32; 5];

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn sizes<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    let (nodes, lines) = (network.nodes.len(), network.lines.len());
    (Common::length(network) + lines, 4 * nodes + 16 * lines)
}

pub(crate) fn check<E: Element>(network: &Network<'_, E>, step_us: u32) -> Result<(), MethodError> {
    if step_us == 0 {
        return Err(MethodError::Step { longest_us: u32::MAX });
    }
    Method::refuse_junctions(network)?;
    network.plan.check_ends(network.nodes, network.lines).map_err(MethodError::Plan)
}

struct State<'s> {
    common: Common<'s>,
    flow: &'s mut [f32],
}

impl<'s> State<'s> {
    fn of<E>(network: &Network<'_, E>, buffer: &'s mut [f32]) -> Self {
        let cut = &mut Cut(buffer);
        Self { common: Common::cut(network, cut), flow: cut.take(network.lines.len()) }
    }
}

struct Work<'w> {
    /// Node pressures [Pa gauge].
    pressure: &'w mut [f32],
    /// dp/dm of every node [Pa/kg].
    per_mass: &'w mut [f32],
    /// h·c/θ of every node: times ΣG it is the node's stiffness over θ.
    rate: &'w mut [f32],
    /// φ of every node in the last step.
    phi: &'w mut [f32],
    /// Sums of every line.
    sums: &'w mut [Sums],
    /// The part of them that never changes.
    constant: &'w mut [Sums],
    /// Ratio of inlet and of outlet flow to the line's flow, when forward.
    ratio: &'w mut [[f32; 2]],
    /// Transfer into the node [kg] and conductance [kg/(s·Pa)] at every end of every line.
    ends: &'w mut [[f32; 2]],
}

impl<'w> Work<'w> {
    fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let (nodes, lines) = (network.nodes.len(), network.lines.len());
        let cut = &mut Cut(buffer);
        let (pressure, per_mass) = (cut.take(nodes), cut.take(nodes));
        let (rate, phi) = (cut.take(nodes), cut.take(nodes));
        let (sums, constant) = (cut.take_rows(lines), cut.take_rows(lines));
        Self {
            pressure,
            per_mass,
            rate,
            phi,
            sums,
            constant,
            ratio: cut.take_rows(lines),
            ends: cut.take_rows(2 * lines),
        }
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
    let state = State::of(network, state);
    let work = Work::of(network, work);
    let nodes = work.pressure.iter_mut().zip(work.per_mass).zip(work.rate).zip(work.phi);
    for (node, (((pressure, per_mass), rate), phi)) in network.nodes.iter().zip(nodes) {
        *pressure = node.start_gauge_pa;
        *per_mass = node.pressure_per_mass_pa_kg();
        *rate = h * *per_mass / THETA;
        *phi = 1.0;
    }
    let lines = state.flow.iter_mut().zip(work.constant).zip(work.sums).zip(work.ratio);
    for (line, (((flow, constant), sums), [inlet, outlet])) in network.lines.iter().zip(lines) {
        *flow = line.start_flow_kg_s;
        *outlet = common::flow_ratios(network, line, |index, segment, ratio| {
            if index == 0 {
                *inlet = ratio;
            }
            if !segment.element.is_active() {
                let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
                let law = segment.element.law(&Operating { inputs, mass_flow_kg_s: 0.0, density_ratio: 1.0 });
                add(constant, &law, ratio);
            }
        });
        *sums = *constant;
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
    let (mut state, mut work) = (State::of(network, state), Work::of(network, work));
    refresh(network, inputs, state.flow, &mut work);
    iterate(network, inputs, state.flow, &mut work);
    let lines =
        state.flow.iter_mut().zip(state.common.sums.iter_mut()).zip(work.sums.iter().zip(work.ratio.iter()));
    let lines = network.lines.iter().zip(lines).zip(work.ends.as_chunks_mut::<2>().0);
    let mut runaway = 0.0f32;
    for ((line, ((flow, ledger), (sums, ratio))), ends) in lines {
        let (w, conductance) = flow_of(line, sums, work.pressure);
        *flow = w;
        pass(h, w, conductance, ratio, ledger, ends);
        runaway = math::larger(runaway, if math::beyond(w, Fault::FLOW_LIMIT_KG_S) { 1.0 } else { 0.0 });
    }
    let (phi, place) = step_nodes(network, &mut state.common, &mut work);
    let line = (runaway > 0.0).then(|| first_runaway(state.flow)).flatten();
    (Margin { phi, spectral_bound: 1.0, proof: Proof::Dominant }, line.or(place))
}

/// Evaluates the laws that may have changed, at the flows of the last step.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn refresh<E: Element>(network: &Network<'_, E>, inputs: &[f32], flow: &[f32], work: &mut Work<'_>) {
    for active in network.active {
        let line = active.line as usize;
        if let (Some(sums), Some(constant)) = (work.sums.get_mut(line), work.constant.get(line)) {
            *sums = *constant;
        }
    }
    for active in network.active {
        let line = active.line as usize;
        let (Some(segment), Some(description), Some(&w), Some(sums)) = (
            network.segments.get(active.segment as usize),
            network.lines.get(line),
            flow.get(line),
            work.sums.get_mut(line),
        ) else {
            continue;
        };
        let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
        let ratio = ratio_at(network, description, active.segment, work.ratio.get(line));
        let mass_flow_kg_s = if w > 0.0 { ratio * w } else { w };
        add(sums, &segment.element.law(&Operating { inputs, mass_flow_kg_s, density_ratio: 1.0 }), ratio);
    }
}

/// Ratio of the flow at a segment to the line's flow; 1 wherever the line drains nothing.
fn ratio_at<E: Element>(network: &Network<'_, E>, line: &Line, segment: u32, ends: Option<&[f32; 2]>) -> f32 {
    let Some(&[inlet, outlet]) = ends else { return 1.0 };
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
fn iterate<E: Element>(network: &Network<'_, E>, inputs: &[f32], flow: &mut [f32], work: &mut Work<'_>) {
    if !network.active.iter().any(|active| follows_flow(network, active.segment)) {
        return;
    }
    for _ in 1..INNER_ITERATIONS {
        for active in network.active {
            if !follows_flow(network, active.segment) {
                continue;
            }
            let line = active.line as usize;
            if let (Some(description), Some(w), Some(sums)) =
                (network.lines.get(line), flow.get_mut(line), work.sums.get(line))
            {
                (*w, _) = flow_of(description, sums, work.pressure);
            }
        }
        refresh(network, inputs, flow, work);
    }
}

fn follows_flow<E: Element>(network: &Network<'_, E>, segment: u32) -> bool {
    network.segments.get(segment as usize).is_some_and(|segment| segment.element.follows_flow())
}

/// Flow [kg/s] and secant conductance [kg/(s·Pa)] of a line between its nodes' pressures.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
fn flow_of(
    line: &Line,
    &[forward, forward_linear, reverse, reverse_linear, head]: &Sums,
    pressure: &[f32],
) -> (f32, f32) {
    let (Some(from), Some(to)) = (pressure.get(line.from as usize), pressure.get(line.to as usize)) else {
        return (0.0, 0.0);
    };
    let y = (from - to) + head;
    let (quadratic, linear) = if y > 0.0 { (forward, forward_linear) } else { (reverse, reverse_linear) };
    let drive = math::larger(math::larger(y.abs(), line.laminar_below_pa), SMALLEST_DRIVE_PA);
    let conductance = 2.0 / (linear + math::sqrt(linear * linear + 4.0 * (quadratic * drive)));
    (y * conductance, conductance)
}

/// Turns a line's flow into transfers, books them and puts them at the line's ends.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
fn pass(h: f32, w: f32, conductance: f32, ratio: &[f32; 2], ledger: &mut LineSums, ends: &mut [[f32; 2]; 2]) {
    let [inlet, outlet] = if w > 0.0 { *ratio } else { [1.0, 1.0] };
    let passed = h * w;
    let (taken, given) = (inlet * passed, outlet * passed);
    common::book(ledger, given, taken - given);
    *ends = [[-taken, inlet * conductance], [given, outlet * conductance]];
}

/// Moves every node by its transfers. Returns the smallest φ and the first node out of range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn step_nodes<E: Element>(
    network: &Network<'_, E>,
    common: &mut Common<'_>,
    work: &mut Work<'_>,
) -> (f32, Option<Place>) {
    let mut smallest = 1.0f32;
    let mut place = None;
    let nodes = common.mass.iter_mut().zip(common.fictitious.iter_mut());
    let nodes = nodes.zip(work.pressure.iter_mut().zip(work.phi.iter_mut()));
    let nodes = nodes.zip(work.per_mass.iter().zip(work.rate.iter()));
    let nodes = nodes.zip(network.plan.end_start.array_windows());
    for (
        (((([mass, carry], [owed, owed_carry]), (pressure, phi)), (per_mass, rate)), &[first, past]),
        (index, node),
    ) in nodes.zip((0u32..).zip(network.nodes))
    {
        let (mut net, mut lost, mut conductance) = (0.0, 0.0, 0.0);
        for &end in network.plan.ends.get(first as usize..past as usize).unwrap_or(&[]) {
            if let Some([transfer, end_conductance]) = work.ends.get(end as usize) {
                math::compensated_add(&mut net, &mut lost, *transfer);
                conductance += end_conductance;
            }
        }
        *phi = operator::phi(rate * conductance);
        let stored = *phi * net;
        *carry += *phi * lost;
        math::compensated_add(mass, carry, stored);
        math::compensated_add(owed, owed_carry, net - stored);
        *pressure = node.start_gauge_pa + per_mass * *mass;
        smallest = if *phi < smallest { *phi } else { smallest };
        if math::beyond(*pressure, Fault::GAUGE_LIMIT_PA) {
            place = place.or(Some(Place::Node(index)));
        }
    }
    (smallest, place)
}

/// Names the line; only asked for when there is one.
#[cold]
fn first_runaway(flows: &[f32]) -> Option<Place> {
    let index = flows.iter().position(|flow| math::beyond(*flow, Fault::FLOW_LIMIT_KG_S))?;
    Some(Place::Line(index as u32))
}
