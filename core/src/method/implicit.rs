//! Linearly implicit methods with inertance and storage: `implicit-euler` and `tr-bdf2`.
//!
//! ```text
//! I·dw/dt = p_from − p_to + head(w) − R·w|w|        Cap·dp/dt = Σw_in − Σw_out − drain
//! ```
//!
//! A stage of length τ solves `M·(δ − β) = τ·f(x + δ)` for increments δ since the step's start by Newton
//! iterations of fixed number: all segments are linearised ([`segment`]), each line eliminates its interior ([`line`]),
//! the nodes remain in a sparse M-matrix whose elimination was planned when the network was built ([`matrix`]).
//! Segments without volume between them are one flow ([`law`]); rows without inertance or capacity are solved as 0 = f.
//!
//! - `implicit-euler`: τ = h, β = 0, one solve; two where volumes are so small that one would leave them what it rounds.
//!   First order.
//! - `tr-bdf2`: τ = (1 − 1/√2)·h in both stages; a trapezoidal stage to γ = 2 − √2, then BDF2 with
//!   β = `1.2071·δ_γ`; two solves a stage. Second order, L-stable (Bank et al. 1985). The trapezoidal stage has its
//!   one-leg form, the midpoint rule: f is taken once at the middle, `M·δ_m = τ·f(x + δ_m)`, and `δ_γ = 2·δ_m`. For
//!   linear f that is the same; but f at the step's start, which may ask a closing valve for any pressure, stays out.
//!
//! Every solve is for a *correction* of the iterate, whose own imbalance is its right side. So what a solve rounds off
//! is a part of the correction, not of pressures, and the next one sees it as imbalance: volumes so small that a
//! rounding of their pressure drives more flow than a rounding of the flow takes are no less at rest than others.
//!
//! Mass that sources, crew, removers and fog bring into a volume within the step is a known term of the volume's balance.
//!
//! Masses move by mean flows over the step, each rounded once, never by the solved pressures.

pub(crate) mod law;
pub(crate) mod layout;
mod line;
mod matrix;
mod respond;
mod segment;

use self::layout::{State, Work, at, continues, is_joined};
use self::respond::Place as At;
use self::segment::{Columns, Model};
use super::responsive::{self, Given};
use crate::climate::Supplied;
use crate::component::Element;
use crate::operator::Margin;
use crate::simulator::{Fault, Place};
use crate::unroll::every;
use crate::{Line, Method, MethodError, Network, NodeKind, air, math};

pub(crate) use self::layout::sizes;

/// (1 − 1/√2): stage length of TR-BDF2 over the step, and weight of the last stage in the mean flow.
const TAU: f32 = 0.292_893_23;
/// The middle of the inner stage of TR-BDF2 as part of the step, where that stage looks at inputs.
pub(crate) const INNER_STAGE: f32 = TAU;
/// √2 + 1: part of the increment to the inner stage's middle that starts the second stage.
const CARRY_OVER: f32 = 2.414_213_6;
/// 1/√2: weight of the increment to the inner stage's middle in the mean flow.
const MEAN: f32 = 0.707_106_77;

/// Largest pressure difference that a segment is expected to see [Pa]: where it would drive the flow against
/// friction rather than against inertance within one stage, the slope is guarded.
const EXPECTED_DRIVE_PA: f32 = 1e3;

/// Solves of the first stage of a run beyond its first: a start may be anything, and one solve from rest leaves pressures of
/// junctions and of stiff volumes beyond all that drive them.
const FIRST_STEP: u32 = 3;

/// Largest part of its own rounding that one solve may hand back to a volume [1].
const RETURNED: f32 = 1e-3;

pub(crate) fn check<E: Element>(network: &Network<'_, E>, step_us: u32) -> Result<(), MethodError> {
    if step_us == 0 {
        return Err(MethodError::Step { longest_us: u32::MAX });
    }
    network.plan.check_elimination(network.nodes, network.lines).map_err(MethodError::Plan)?;
    network.plan.check_terms(network).map_err(MethodError::Plan)?;
    responsive::check(network, |index, _| !continues(&network.plan, index))?;
    for line in network.lines {
        for (index, segment) in (line.first_segment..).zip(network.segments_of(line)) {
            let law = law::of(segment, network.inputs, 0.0);
            let resists_at_rest = law.linear > 0.0 || (law.resistance > 0.0 && line.laminar_below_pa > 0.0);
            if segment.inertance_per_m <= 0.0 && !resists_at_rest {
                return Err(MethodError::NothingResists(index));
            }
        }
    }
    Ok(())
}

/// The segments of a line.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn range(line: &Line) -> core::ops::Range<usize> {
    let first = line.first_segment as usize;
    first..first + line.segments as usize
}

/// Length of a stage [s].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn stage(method: Method, h: f32) -> f32 {
    if method == Method::TrBdf2 { TAU * h } else { h }
}

/// Sets the start state and everything that stays constant during a run.
pub(crate) fn start<E: Element>(
    network: &Network<'_, E>,
    method: Method,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    given: Given<'_>,
) {
    let inputs = given.inputs;
    state.fill(0.0);
    work.fill(0.0);
    let state = State::of(network, state);
    let mut work = Work::of(network, work);
    let (tau, nodes) = (stage(method, h), network.nodes.len());
    for (index, (node, [junction, _])) in network.nodes.iter().zip(state.junctions).enumerate() {
        *junction = node.start_gauge_pa;
        let per_mass = node.pressure_per_mass_pa_kg();
        let rise = per_mass * network.climate.isentropic(node);
        let capacity = if rise > 0.0 { 1.0 / (rise * tau) } else { 0.0 };
        for (column, value) in [
            (&mut work.pressure, node.start_gauge_pa),
            (&mut work.per_mass, per_mass),
            (&mut work.capacity, capacity),
            (&mut work.excess, capacity),
        ] {
            if let Some(slot) = column.get_mut(index) {
                *slot = value;
            }
        }
        // A held pressure holds all of itself.
        if let Some(swept) = work.swept.get_mut(index).filter(|_| node.kind == NodeKind::Boundary) {
            *swept = [1.0, 0.0];
        }
    }
    for line in network.lines {
        let node = network.nodes.get(line.from as usize);
        let (temperature, from) = node.map_or((0.0, 0.0), |node| (node.temperature_k, node.start_gauge_pa));
        for (index, segment) in range(line).zip(network.segments_of(line)) {
            let volume = segment.outlet_volume_m3;
            let rise = if volume > 0.0 { air::pressure_per_mass_pa_kg(volume, temperature) } else { 0.0 };
            if let Some([capacity, own_rise, ..]) = work.joints.get_mut(index) {
                (*capacity, *own_rise) = (if rise > 0.0 { 1.0 / (rise * tau) } else { 0.0 }, rise);
            }
            let law = law::of(segment, inputs, line.start_flow_kg_s);
            let inertia = segment.inertance_per_m / tau;
            let guarded = segment::needs_guard(segment.element.is_active(), inertia, law.resistance);
            let (k, l, f) = (law.resistance, law.linear, law.head);
            if let Some(own) = work.law.get_mut(index) {
                *own = [k, l, f];
            }
            let joined = continues(&network.plan, index) || is_joined(&network.plan, index);
            if let (true, Some(merged)) = (joined, work.merged.first_mut()) {
                *merged = 1.0;
            }
            // What belongs to the next segment's reach is solved beside it as 1·w = 0.
            let own = if joined { [1.0, 0.0, 0.0, 0.0] } else { [inertia, k, l, f] };
            for (column, value) in [
                (&mut work.inertia, own[0]),
                (&mut work.quadratic, own[1]),
                (&mut work.linear, own[2]),
                (&mut work.head, own[3]),
                (&mut work.guarded, if guarded || joined { 1.0 } else { 0.0 }),
            ] {
                if let Some(slot) = column.get_mut(index) {
                    *slot = value;
                }
            }
            let flows = !continues(&network.plan, index);
            if let (Some(flow), Some(passed), true) =
                (state.flow.get_mut(index), work.passed.get_mut(index), flows)
            {
                // Shown before the first step as if it had passed in one.
                (*flow, *passed) = (line.start_flow_kg_s, h * line.start_flow_kg_s);
            }
            if let Some(pressure) = work.pressure.get_mut(nodes + index) {
                *pressure = from;
            }
        }
        if law::is_turned(network, line) {
            work.turning.fill(1.0);
            law::turn_laminar(network, line, line.start_flow_kg_s > 0.0, &mut work);
        } else {
            law::set_laminar(line, &mut work);
        }
    }
    work.fresh.fill(1.0);
    if respond::some_react(network) {
        work.reacts.fill(1.0);
    } else if !network.responsive.is_empty() {
        // Densities that one solve finds move the flows that it found.
        work.again.fill(1.0);
    }
    law::join::<E, false, false>(network, tau, inputs, state.flow, &mut work);
    if let (true, Some(again)) = (rounding_returns(network, &work), work.again.first_mut()) {
        *again = 1.0;
    }
    respond::advance(network, f32::INFINITY, given, state.flow, state.memory, &work);
}

/// Whether one solve would hand some volume's rounding back to it: in a step it stores C·p/τ of a flow that is known to
/// a unit in the last place of b·p. An element that changes may open as wide as its inputs let it.
fn rounding_returns<E: Element>(network: &Network<'_, E>, work: &Work<'_>) -> bool {
    let nodes = network.nodes.len() as u32;
    let capacity = |point: u32| match point.checked_sub(nodes) {
        None => at(work.capacity, point),
        Some(joint) => work.joints.get(joint as usize).map_or(0.0, |joint| joint[0]),
    };
    network.lines.iter().any(|line| {
        range(line).any(|place| {
            let (index, segment) = (place as u32, network.segments.get(place));
            let (Some(segment), Some(points)) = (segment, network.plan.between.get(place)) else {
                return false;
            };
            let changes = segment.element.is_active() || is_joined(&network.plan, place);
            let friction = if !changes {
                at(work.linear, index) + at(work.quadratic, index) * at(work.laminar, index)
            } else if line.segments == 1 {
                // R·w at the laminar flow √(y/R).
                math::sqrt(line.laminar_below_pa * segment.element.least_resistance_pa_s2_kg2())
            } else {
                0.0
            };
            let least = at(work.inertia, index) + friction;
            points.iter().map(|&point| capacity(point)).any(|capacity| {
                let stores = capacity > 0.0;
                stores && RETURNED * least * capacity < f32::EPSILON
            })
        })
    })
}

/// Inputs at the step's start, at the middle of the inner stage and at the step's end.
#[derive(Clone, Copy)]
pub(crate) struct StageInputs<'i> {
    pub(crate) start: &'i [f32],
    pub(crate) middle: &'i [f32],
    pub(crate) end: &'i [f32],
    /// Virtual temperature of every node at the step's start, see [`Given`].
    pub(crate) virtual_k: &'i [f32],
    /// What comes into every volume from outside in this step.
    pub(crate) supplied: Supplied<'i>,
}

/// Adds the supplied flows, which are the same in both stages, to the known part of the nodes' balances.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn add_supplied<E>(network: &Network<'_, E>, step_s: f32, supplied: Supplied<'_>, known: &mut [f32]) {
    let supplied = supplied.flows_kg_s(&network.climate, step_s);
    known.iter_mut().zip(supplied).for_each(|(known, flow)| *known += flow);
}

/// The columns of a pass, out of the work buffer.
macro_rules! columns {
    ($work:expr, $flow:expr) => {
        Columns {
            inertia: &*$work.inertia,
            quadratic: &*$work.quadratic,
            linear: &*$work.linear,
            laminar: &*$work.laminar,
            guarded: &*$work.guarded,
            flow: &*$flow,
        }
    };
}

/// Advances by `h` [s]. Returns the margin of this step and the first value that left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn step<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    method: Method,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    inputs: StageInputs<'_>,
) -> (Margin, Option<Place>) {
    let (mut state, mut work) = (State::of(network, state), Work::of(network, work));
    let (state, work) = (&mut state, &mut work);
    let model = &Model::<E, UNROLL> { network, tau: stage(method, h) };
    segment::differences(network, work.pressure, work.drop);
    let responds = !network.responsive.is_empty();
    let reacts = responds && work.reacts.first().is_some_and(|reacts| *reacts > 0.0);
    let given = |stage| Given { inputs: stage, virtual_k: inputs.virtual_k };
    if reacts {
        respond::advance(network, h, given(inputs.start), state.flow, state.memory, work);
    }
    // States the laws of responsive lines; nothing in a network without such lines.
    macro_rules! respond {
        ($inputs:expr, $place:expr, $second:literal) => {
            if reacts || (responds && matches!($place, At::Start | At::NextStage)) {
                respond::state_laws::<E, $second>(
                    network,
                    model.tau,
                    given($inputs),
                    $place,
                    state.flow,
                    state.memory,
                    work,
                );
            }
        };
    }
    let two_stages = method == Method::TrBdf2;
    let first = if two_stages { inputs.middle } else { inputs.end };
    law::update::<E, UNROLL, false>(network, model.tau, first, state.flow, work);
    respond!(first, At::Start, false);
    work.known.fill(0.0);
    add_supplied(network, h, inputs.supplied, work.known);
    line::forget(network, work);
    segment::push::<true>(work.head, work.pushed);
    solve::<E, UNROLL, true>(model, state.flow, work);
    // Lines that react are solved more often in any case.
    let again = u32::from(two_stages || (work.again.first().is_some_and(|again| *again > 0.0) && !reacts));
    let fresh = work.fresh.first_mut().is_some_and(|fresh| core::mem::take(fresh) > 0.0);
    for _ in 0..if fresh { FIRST_STEP } else { again } {
        respond!(first, At::Iterate, false);
        solve::<E, UNROLL, false>(model, state.flow, work);
    }
    if reacts {
        respond::solve_more::<E, UNROLL, false>(model, given(first), state.flow, state.memory, work);
    }
    let weights = if two_stages {
        segment::carry_over([work.inertia, work.differ, work.q], work.ports, work.pushed, work.first);
        for (known, (capacity, delta)) in
            work.known.iter_mut().zip(work.capacity.iter().zip(work.delta.iter()))
        {
            *known = (CARRY_OVER - 1.0) * capacity * delta;
        }
        add_supplied(network, h, inputs.supplied, work.known);
        line::carry_over(network, work);
        law::update::<E, UNROLL, true>(network, model.tau, inputs.end, state.flow, work);
        respond!(inputs.end, At::NextStage, true);
        segment::push::<false>(work.head, work.pushed);
        solve::<E, UNROLL, false>(model, state.flow, work);
        respond!(inputs.end, At::Iterate, true);
        solve::<E, UNROLL, false>(model, state.flow, work);
        if reacts {
            respond::solve_more::<E, UNROLL, true>(model, given(inputs.end), state.flow, state.memory, work);
        }
        [MEAN, TAU]
    } else {
        [0.0, 1.0]
    };
    let place = commit::<E, UNROLL>(network, h, weights, state, work);
    (Margin::by_construction(1.0), place)
}

/// One Newton iteration: all segments are linearised around the iterate, the lines' interiors eliminated, the nodes
/// solved, the lines filled in, and all of it added to the iterate. The `START` of a step is from rest; drains act by the
/// direction that the iterate gives their flows.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn solve<E: Element, const UNROLL: bool, const START: bool>(
    model: &Model<'_, '_, E, UNROLL>,
    flow: &[f32],
    work: &mut Work<'_>,
) {
    let network = model.network;
    line::direct::<E, START>(network, flow, work);
    let columns = columns!(work, flow);
    model.linearise::<START>(columns, [work.differ, work.pushed], work.drop, work.q, work.ports);
    line::sweep(network, work);
    matrix::solve::<E, UNROLL>(network, work);
    line::substitute::<E, START>(network, work);
    let nodes = work.known.iter_mut().zip(work.capacity.iter());
    for ((known, capacity), (delta, change)) in nodes.zip(work.delta.iter_mut().zip(work.change.iter())) {
        *delta = if START { *change } else { *delta + change };
        *known -= capacity * change;
    }
    segment::differences(network, work.change, work.differ);
}

/// Moves masses by the mean flows of the step and takes the last stage's increments over.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn commit<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    h: f32,
    weights: [f32; 2],
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> Option<Place> {
    segment::pass(h, weights, [work.differ, work.first, state.flow], work.ports, work.q, work.passed);
    line::transfer(network, h, weights, state, work);
    if weights[0] > 0.0 && work.reacts.first().is_some_and(|reacts| *reacts > 0.0) {
        respond::shut(network, state.flow, work);
    }
    let mut beyond = segment::take_over(work.q, state.flow, state.flow_carry, Fault::FLOW_LIMIT_KG_S);
    let mut composite = network.plan.composite.iter().zip((network.segments.len() as u32..).step_by(2));
    let mut next = composite.next();
    for (index, (line, sums)) in (0u32..).zip(network.lines.iter().zip(state.common.lines.iter_mut())) {
        let [_, _, given, carry, ..] = sums;
        let mut port = line.last_segment();
        if let Some((&own, inlet)) = next
            && own == index
        {
            (port, next) = (inlet + 1, composite.next());
            line::settle(network, line, state.mass, work);
        }
        math::compensated_add(given, carry, at(work.passed, port));
    }
    beyond |= if UNROLL {
        move_nodes::<E, true>(network, state, work)
    } else {
        move_nodes_apart(network, state, work)
    };
    // One flag tells whether anything is wrong; only then is it looked for.
    if beyond { first_outside(network, state.flow, work.pressure) } else { None }
}

/// A function of its own, whose loop then has the processor's registers for itself.
#[inline(never)]
fn move_nodes_apart<E>(network: &Network<'_, E>, state: &mut State<'_>, work: &mut Work<'_>) -> bool {
    move_nodes::<E, false>(network, state, work)
}

/// Moves the masses of all nodes by what passed their ports. Returns whether a pressure left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn move_nodes<E, const UNROLL: bool>(
    network: &Network<'_, E>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> bool {
    let (passed, delta, mut beyond) = (&*work.passed, &*work.delta, false);
    let reference_pa = network.judged_reference_pa();
    // By index, which a compiler that knows the description resolves.
    every!(UNROLL, 0..network.nodes.len(), index => {
        if let (Some(node), Some([mass, carry, ..]), Some(junction), Some(pressure)) = (
            network.nodes.get(index),
            state.common.nodes.get_mut(index),
            state.junctions.get_mut(index),
            work.pressure.get_mut(index),
        ) {
            let (mut sum, mut lost) = (*mass, *carry);
            every!(few UNROLL, network.plan.terms_of(index as u32).iter(), &[end, ..] => {
                math::compensated_add(&mut sum, &mut lost, matrix::inward(at(passed, end >> 1), end));
            });
            (*mass, *carry) = (sum, lost);
            if let Some(reference_pa) = reference_pa {
                *pressure = if node.kind == NodeKind::Junction {
                    let [gauge, carry] = junction;
                    math::compensated_add(gauge, carry, at(delta, index as u32));
                    *gauge
                } else {
                    node.start_gauge_pa + at(work.per_mass, index as u32) * sum
                };
                beyond |= Fault::outside(*pressure, reference_pa);
            }
        }
    });
    beyond
}

/// Names what left its range; only asked for when something did.
#[cold]
fn first_outside<E>(network: &Network<'_, E>, flow: &[f32], pressure: &[f32]) -> Option<Place> {
    let wild = |line: &Line| {
        let flows = flow.get(range(line)).unwrap_or(&[]);
        flows.iter().any(|w| math::beyond(*w, Fault::FLOW_LIMIT_KG_S))
    };
    let line = network.lines.iter().position(wild).map(|index| Place::Line(index as u32));
    let nodes = pressure.get(..network.nodes.len()).unwrap_or(&[]);
    let reference_pa = network.judged_reference_pa();
    let beyond = |gauge: f32| reference_pa.is_some_and(|reference| Fault::outside(gauge, reference));
    let node = || nodes.iter().position(|gauge| beyond(*gauge));
    line.or_else(|| node().map(|index| Place::Node(index as u32)))
}
