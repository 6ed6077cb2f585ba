//! Linearly implicit methods with inertance and storage: `implicit-euler` and `tr-bdf2`.
//!
//! ```text
//! I·dw/dt = p_from − p_to + head(w) − R·w|w|        Cap·dp/dt = Σw_in − Σw_out − drain
//! ```
//!
//! A stage of length τ solves `M·(δ − β) = τ·f(x + δ)` for increments δ since the step's start by Newton
//! iterations of fixed number: each line eliminates its interior ([`line`]), the nodes remain in a sparse
//! M-matrix whose elimination was planned when the network was built ([`matrix`]). Rows without inertance or
//! capacity are solved as 0 = f.
//!
//! - `implicit-euler`: τ = h, β = 0, one solve. First order.
//! - `tr-bdf2`: τ = (1 − 1/√2)·h in both stages; a trapezoidal stage to γ = 2 − √2, then BDF2 with
//!   β = 1.2071·δ_γ; two solves a stage. Second order, L-stable (Bank et al. 1985).
//!
//! Masses move by mean flows over the step, each rounded once, never by the solved pressures.

pub(crate) mod line;
pub(crate) mod matrix;

use self::line::{Columns, Fixed, NodePressure, SegmentLaw, Swept};
use self::matrix::Matrix;
use super::common::{self, Common, Cut};
use crate::element::{Element, Operating};
use crate::operator::{Margin, Proof};
use crate::simulator::{Fault, Place};
use crate::{Line, Method, MethodError, Network, NodeKind, Plan, air, math};

/// (1 − 1/√2): stage length of TR-BDF2 over the step, and weight of the last stage in the mean flow.
const TAU: f32 = 0.292_893_23;
/// 2 − √2: the inner stage of TR-BDF2 as part of the step.
pub(crate) const INNER_STAGE: f32 = 0.585_786_44;
/// (√2 + 1)/2: part of the first stage's increment that starts the second.
const CARRY_OVER: f32 = 1.207_106_8;
/// √2/4: weight of the first stage's increment in the mean flow.
const MEAN: f32 = 0.353_553_4;

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn sizes<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    let (nodes, lines, segments) = (network.nodes.len(), network.lines.len(), network.segments.len());
    let (rows, entries) = (network.plan.order.len(), network.plan.columns.len());
    (
        Common::length(network) + 2 * nodes + 4 * segments,
        6 * nodes + lines + 17 * segments + entries + 3 * rows,
    )
}

pub(crate) fn check<E: Element>(network: &Network<'_, E>, step_us: u32) -> Result<(), MethodError> {
    if step_us == 0 {
        return Err(MethodError::Step { longest_us: u32::MAX });
    }
    network.plan.check_elimination(network.nodes, network.lines).map_err(MethodError::Plan)?;
    for line in network.lines {
        for (index, segment) in (line.first_segment..).zip(network.segments_of(line)) {
            let inputs = network.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
            let law = segment.element.law(&Operating { inputs, mass_flow_kg_s: 0.0, density_ratio: 1.0 });
            let resists_at_rest = law.linear > 0.0 || (law.resistance > 0.0 && line.laminar_below_pa > 0.0);
            if segment.inertance_per_m <= 0.0 && !resists_at_rest {
                return Err(MethodError::NothingResists(index));
            }
        }
    }
    Ok(())
}

struct State<'s> {
    common: Common<'s>,
    /// Pressures of nodes without volume, and carries [Pa gauge].
    junction: &'s mut [[f32; 2]],
    /// Flow of every segment, and carries [kg/s].
    flow: &'s mut [[f32; 2]],
    /// Pressure behind every segment but a line's last, and carries [Pa gauge].
    gauge: &'s mut [[f32; 2]],
}

impl<'s> State<'s> {
    fn of<E>(network: &Network<'_, E>, buffer: &'s mut [f32]) -> Self {
        let cut = &mut Cut(buffer);
        let segments = network.segments.len();
        Self {
            common: Common::cut(network, cut),
            junction: cut.take_rows(network.nodes.len()),
            flow: cut.take_rows(segments),
            gauge: cut.take_rows(segments),
        }
    }
}

struct Work<'w> {
    /// Node pressures [Pa gauge].
    pressure: &'w mut [f32],
    /// dp/dm of every node [Pa/kg]; 0 without volume.
    per_mass: &'w mut [f32],
    /// C/τ of every node [kg/(s·Pa)].
    capacity: &'w mut [f32],
    /// Known part of every node's balance [kg/s].
    node_known: &'w mut [f32],
    /// Present increment of every node [Pa], and that of the first stage.
    node_delta: &'w mut [f32],
    node_first: &'w mut [f32],
    /// Flow below which a line is linear in this stage [kg/s].
    laminar: &'w mut [f32],
    fixed: &'w mut [Fixed],
    law: &'w mut [SegmentLaw],
    known: &'w mut [[f32; 2]],
    delta: &'w mut [[f32; 2]],
    first: &'w mut [[f32; 2]],
    swept: &'w mut [Swept],
    matrix: Matrix<'w>,
}

impl<'w> Work<'w> {
    fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let (nodes, segments) = (network.nodes.len(), network.segments.len());
        let rows = network.plan.order.len();
        let cut = &mut Cut(buffer);
        Self {
            pressure: cut.take(nodes),
            per_mass: cut.take(nodes),
            capacity: cut.take(nodes),
            node_known: cut.take(nodes),
            node_delta: cut.take(nodes),
            node_first: cut.take(nodes),
            laminar: cut.take(network.lines.len()),
            fixed: cut.take_rows(segments),
            law: cut.take_rows(segments),
            known: cut.take_rows(segments),
            delta: cut.take_rows(segments),
            first: cut.take_rows(segments),
            swept: cut.take_rows(segments),
            matrix: Matrix {
                entries: cut.take(network.plan.columns.len()),
                rhs: cut.take(rows),
                reciprocal: cut.take(rows),
                dense: cut.take(rows),
            },
        }
    }
}

/// Sets the start state and everything that stays constant during a run.
pub(crate) fn start<E: Element>(
    network: &Network<'_, E>,
    method: Method,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    inputs: &[f32],
) {
    state.fill(0.0);
    work.fill(0.0);
    let state = State::of(network, state);
    let work = Work::of(network, work);
    let tau = if method == Method::TrBdf2 { TAU * h } else { h };
    let nodes = work.pressure.iter_mut().zip(work.per_mass).zip(work.capacity).zip(state.junction);
    for (node, (((pressure, per_mass), capacity), [junction, _])) in network.nodes.iter().zip(nodes) {
        *pressure = node.start_gauge_pa;
        *junction = node.start_gauge_pa;
        *per_mass = node.pressure_per_mass_pa_kg();
        *capacity = if *per_mass > 0.0 { 1.0 / (*per_mass * tau) } else { 0.0 };
    }
    for line in network.lines {
        let temperature = network.nodes.get(line.from as usize).map_or(0.0, |node| node.temperature_k);
        let from = network.nodes.get(line.from as usize).map_or(0.0, |node| node.start_gauge_pa);
        let first = line.first_segment as usize;
        let range = first..first + line.segments as usize;
        let (Some(fixed), Some(flow), Some(gauge), Some(law)) = (
            work.fixed.get_mut(range.clone()),
            state.flow.get_mut(range.clone()),
            state.gauge.get_mut(range.clone()),
            work.law.get_mut(range),
        ) else {
            continue;
        };
        let rows = fixed.iter_mut().zip(flow).zip(gauge).zip(law);
        for (segment, (((fixed, [flow, _]), [gauge, _]), law)) in network.segments_of(line).iter().zip(rows) {
            let volume = segment.outlet_volume_m3;
            let capacity =
                if volume > 0.0 { 1.0 / air::pressure_per_mass_pa_kg(volume, temperature) } else { 0.0 };
            *fixed = [segment.inertance_per_m / tau, capacity / tau, segment.element.removal()];
            (*flow, *gauge) = (line.start_flow_kg_s, from);
            *law = law_of(segment, inputs, line.start_flow_kg_s);
        }
    }
}

fn law_of<E: Element>(segment: &crate::Segment<E>, inputs: &[f32], mass_flow_kg_s: f32) -> SegmentLaw {
    let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
    let law = segment.element.law(&Operating { inputs, mass_flow_kg_s, density_ratio: 1.0 });
    [law.resistance, law.linear, law.head]
}

/// Inputs at the step's start, at the inner stage and at the step's end.
#[derive(Clone, Copy)]
pub(crate) struct StageInputs<'i> {
    pub(crate) start: &'i [f32],
    pub(crate) middle: &'i [f32],
    pub(crate) end: &'i [f32],
}

/// Advances by `h` [s]. Returns the margin of this step and the first value that left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn step<E: Element>(
    network: &Network<'_, E>,
    method: Method,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    inputs: StageInputs<'_>,
) -> (Margin, Option<Place>) {
    let (mut state, mut work) = (State::of(network, state), Work::of(network, work));
    work.node_delta.fill(0.0);
    work.delta.as_flattened_mut().fill(0.0);
    let weights = if method == Method::TrBdf2 {
        laws(network, inputs.start, &state, &mut work);
        rates(network, &state, &mut work);
        laws(network, inputs.middle, &state, &mut work);
        solve(network, &state, &mut work);
        solve(network, &state, &mut work);
        carry_over(&mut work);
        laws(network, inputs.end, &state, &mut work);
        solve(network, &state, &mut work);
        solve(network, &state, &mut work);
        [MEAN, TAU]
    } else {
        work.first.as_flattened_mut().fill(0.0);
        work.known.as_flattened_mut().fill(0.0);
        work.node_known.fill(0.0);
        laws(network, inputs.end, &state, &mut work);
        solve(network, &state, &mut work);
        [0.0, 1.0]
    };
    (
        Margin { phi: 1.0, spectral_bound: 1.0, proof: Proof::Dominant },
        commit(network, h, weights, &mut state, &mut work),
    )
}

/// Evaluates the laws that may have changed, and every line's laminar flow.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn laws<E: Element>(network: &Network<'_, E>, inputs: &[f32], state: &State<'_>, work: &mut Work<'_>) {
    for active in network.active {
        let index = active.segment as usize;
        if let (Some(segment), Some([flow, _]), Some([delta, _]), Some(law)) = (
            network.segments.get(index),
            state.flow.get(index),
            work.delta.get(index),
            work.law.get_mut(index),
        ) {
            *law = law_of(segment, inputs, flow + delta);
        }
    }
    for (line, laminar) in network.lines.iter().zip(work.laminar.iter_mut()) {
        let first = line.first_segment as usize;
        let laws = work.law.get(first..first + line.segments as usize).unwrap_or(&[]);
        let resistance: f32 = laws.iter().map(|[quadratic, _, _]| quadratic).sum();
        *laminar = math::sqrt(line.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE));
    }
}

/// Known parts of the trapezoidal stage: the rates of change at the step's start.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn rates<E: Element>(network: &Network<'_, E>, state: &State<'_>, work: &mut Work<'_>) {
    work.node_known.fill(0.0);
    for (index, line) in network.lines.iter().enumerate() {
        let Some(columns) = columns(line, state.flow, state.gauge, work) else { continue };
        let (columns, pressure, node_known, laminar) = columns;
        let (from, to) = ends(line, pressure);
        let laminar = laminar.get(index).copied().unwrap_or(0.0);
        let last = columns.fixed.len().saturating_sub(1);
        let mut upstream = from;
        let mut mass_known_before: Option<&mut f32> = None;
        let mut inflow = 0.0;
        let (mut held, mut removal) = (false, 0.0);
        let rows = columns.fixed.iter().zip(columns.law).zip(columns.flow).zip(columns.gauge);
        for (place, ((((fixed, law), [w, _]), [p, _]), known)) in
            rows.zip(columns.known.iter_mut()).enumerate()
        {
            let downstream = if place == last { to } else { *p };
            let [momentum_known, mass_known] = known;
            let rate = (upstream - downstream) + law[2] - line::loss(law, *w, laminar);
            *momentum_known = if fixed[0] > 0.0 { rate } else { 0.0 };
            let leaves = if *w > 0.0 { (1.0 + removal) * w } else { *w };
            match mass_known_before {
                Some(known) => *known = if held { inflow - leaves } else { 0.0 },
                None => add(node_known, line.from, -*w),
            }
            (inflow, held, removal) = (*w, fixed[1] > 0.0, fixed[2]);
            mass_known_before = Some(mass_known);
            upstream = downstream;
        }
        add(node_known, line.to, if inflow > 0.0 { inflow / (1.0 + removal) } else { inflow });
    }
    for (known, capacity) in work.node_known.iter_mut().zip(work.capacity.iter()) {
        *known = if *capacity > 0.0 { *known } else { 0.0 };
    }
}

/// Known parts of the BDF2 stage: a share of the first stage's increments.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn carry_over(work: &mut Work<'_>) {
    let segments =
        work.known.iter_mut().zip(work.fixed.iter()).zip(work.delta.iter()).zip(work.first.iter_mut());
    for ((([momentum, mass], [inertia, capacity, _]), delta), first) in segments {
        *momentum = CARRY_OVER * inertia * delta[0];
        *mass = CARRY_OVER * capacity * delta[1];
        *first = *delta;
    }
    let nodes = work.node_known.iter_mut().zip(work.capacity.iter()).zip(work.node_delta.iter());
    for (((known, capacity), delta), first) in nodes.zip(work.node_first.iter_mut()) {
        *known = CARRY_OVER * capacity * delta;
        *first = *delta;
    }
}

/// A line's columns, and next to them what else of the work a loop over lines needs.
#[allow(clippy::type_complexity, reason = "parts of one struct, borrowed apart")]
fn columns<'c>(
    line: &Line,
    flow: &'c [[f32; 2]],
    gauge: &'c [[f32; 2]],
    work: &'c mut Work<'_>,
) -> Option<(ColumnsMut<'c>, &'c [f32], &'c mut [f32], &'c [f32])> {
    let first = line.first_segment as usize;
    let range = first..first + line.segments as usize;
    Some((
        ColumnsMut {
            fixed: work.fixed.get(range.clone())?,
            law: work.law.get(range.clone())?,
            flow: flow.get(range.clone())?,
            gauge: gauge.get(range.clone())?,
            known: work.known.get_mut(range)?,
        },
        work.pressure,
        work.node_known,
        work.laminar,
    ))
}

/// Columns of a line while its known parts are written.
struct ColumnsMut<'c> {
    fixed: &'c [Fixed],
    law: &'c [SegmentLaw],
    flow: &'c [[f32; 2]],
    gauge: &'c [[f32; 2]],
    known: &'c mut [[f32; 2]],
}

fn ends(line: &Line, pressure: &[f32]) -> (f32, f32) {
    let at = |node: u32| pressure.get(node as usize).copied().unwrap_or(0.0);
    (at(line.from), at(line.to))
}

fn add(slots: &mut [f32], index: u32, value: f32) {
    if let Some(slot) = slots.get_mut(index as usize) {
        *slot += value;
    }
}

/// One Newton iteration: all lines are swept, the nodes solved, the lines filled in.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn solve<E: Element>(network: &Network<'_, E>, state: &State<'_>, work: &mut Work<'_>) {
    let plan = &network.plan;
    work.matrix.entries.fill(0.0);
    for ((&node, &diagonal), rhs) in plan.order.iter().zip(plan.diagonal).zip(work.matrix.rhs.iter_mut()) {
        let node = node as usize;
        *rhs = work.node_known.get(node).copied().unwrap_or(0.0);
        if let (Some(entry), Some(capacity)) =
            (work.matrix.entries.get_mut(diagonal as usize), work.capacity.get(node))
        {
            *entry = *capacity;
        }
    }
    for ((line, laminar), stamps) in network.lines.iter().zip(work.laminar.iter()).zip(plan.stamps) {
        let first = line.first_segment as usize;
        let range = first..first + line.segments as usize;
        let (Some(fixed), Some(law), Some(flow), Some(gauge), Some(known), Some(delta), Some(swept)) = (
            work.fixed.get(range.clone()),
            work.law.get(range.clone()),
            state.flow.get(range.clone()),
            state.gauge.get(range.clone()),
            work.known.get(range.clone()),
            work.delta.get(range.clone()),
            work.swept.get_mut(range),
        ) else {
            continue;
        };
        let at = |node: u32| NodePressure {
            start: work.pressure.get(node as usize).copied().unwrap_or(0.0),
            delta: work.node_delta.get(node as usize).copied().unwrap_or(0.0),
        };
        let (from, to) = (at(line.from), at(line.to));
        // What a drain at the last element takes never reaches the outlet node.
        let forward = flow.last().zip(delta.last()).is_some_and(|([w, _], [dw, _])| w + dw > 0.0);
        let removal = fixed.last().map_or(0.0, |[_, _, removal]| *removal);
        let arrives = if forward { 1.0 / (1.0 + removal) } else { 1.0 };
        let columns = &mut Columns { fixed, law, flow, gauge, known, delta, swept };
        let admittance = line::sweep(columns, from, to, *laminar);
        stamp(&mut work.matrix, plan, line, *stamps, &admittance, arrives);
    }
    work.matrix.solve(plan);
    for (&node, &solution) in plan.order.iter().zip(work.matrix.rhs.iter()) {
        if let Some(delta) = work.node_delta.get_mut(node as usize) {
            *delta = solution;
        }
    }
    for line in network.lines {
        let first = line.first_segment as usize;
        let range = first..first + line.segments as usize;
        let (from, to) = ends(line, work.node_delta);
        if let (Some(delta), Some(swept)) = (work.delta.get_mut(range.clone()), work.swept.get(range)) {
            line::substitute(delta, swept, from, to);
        }
    }
}

/// Adds a line to the node equations.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn stamp(
    matrix: &mut Matrix<'_>,
    plan: &Plan<'_>,
    line: &Line,
    stamps: [u32; 4],
    admittance: &line::Admittance,
    arrives: f32,
) {
    let a = admittance;
    let row = |node: u32| plan.row_of.get(node as usize).copied().unwrap_or(Plan::NOWHERE);
    matrix.add_rhs(row(line.from), -a.inlet);
    matrix.add_rhs(row(line.to), arrives * a.outlet);
    let [from_from, from_to, to_from, to_to] = stamps;
    if line.from == line.to {
        // The two through-parts belong to the same pressure and cancel exactly.
        matrix.add(from_from, a.inlet_held + arrives * a.outlet_held);
        return;
    }
    matrix.add(from_from, a.inlet_held + a.inlet_through);
    matrix.add(from_to, -a.inlet_through);
    matrix.add(to_from, -(arrives * a.outlet_through));
    matrix.add(to_to, arrives * (a.outlet_held + a.outlet_through));
}

/// Moves masses by the mean flows of the step and takes the last stage's increments over.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn commit<E: Element>(
    network: &Network<'_, E>,
    h: f32,
    weights: [f32; 2],
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> Option<Place> {
    let mut place = None;
    for (index, line) in (0u32..).zip(network.lines) {
        let first = line.first_segment as usize;
        let range = first..first + line.segments as usize;
        let (Some(flow), Some(gauge), Some(fixed), Some(delta), Some(early)) = (
            state.flow.get_mut(range.clone()),
            state.gauge.get_mut(range.clone()),
            work.fixed.get(range.clone()),
            work.delta.get(range.clone()),
            work.first.get(range),
        ) else {
            continue;
        };
        let last = flow.len().saturating_sub(1);
        let (mut taken, mut drained, mut carried) = (0.0, 0.0, 0.0);
        // The volume before the present segment: its pressure, capacity over τ, removal, solved increment.
        let mut before: Option<(&mut [f32; 2], f32, f32, f32)> = None;
        let rows = flow.iter_mut().zip(gauge.iter_mut()).zip(fixed).zip(delta).zip(early);
        for (place_in_line, (((([w, carry], gauge), fixed), [dw, dp]), [dw_early, _])) in rows.enumerate() {
            let mean = *w + (weights[0] * dw_early + weights[1] * dw);
            math::compensated_add(w, carry, *dw);
            if math::beyond(*w, Fault::FLOW_LIMIT_KG_S) {
                place = place.or(Some(Place::Line(index)));
            }
            let mut moved = h * mean;
            match before.take() {
                None => taken = moved,
                Some(([pressure, pressure_carry], capacity, removal, solved)) => {
                    let leaving = drain(removal, moved);
                    if capacity > 0.0 {
                        drained += leaving;
                        let rise = ((carried - moved) - leaving) * (h_over_tau(weights) / (h * capacity));
                        math::compensated_add(pressure, pressure_carry, rise);
                    } else {
                        // Nothing can be stored here, so what went in and was not drained is what goes on.
                        let leaving = drain(removal, carried / (1.0 + removal));
                        drained += leaving;
                        moved = carried - leaving;
                        math::compensated_add(pressure, pressure_carry, solved);
                    }
                }
            }
            carried = moved;
            if place_in_line < last {
                before = Some((gauge, fixed[1], fixed[2], *dp));
            } else {
                let leaving = drain(fixed[2], carried / (1.0 + fixed[2]));
                drained += leaving;
                carried -= leaving;
            }
        }
        common::transfer(&mut state.common, index as usize, line, taken, carried, drained);
    }
    commit_nodes(network, state, work).or(place)
}

/// h/τ of the method that these weights belong to.
fn h_over_tau(weights: [f32; 2]) -> f32 {
    1.0 / weights[1]
}

/// Mass drained beside `leaves` [kg]: nothing where the flow runs backward.
fn drain(removal: f32, leaves: f32) -> f32 {
    if leaves > 0.0 { removal * leaves } else { 0.0 }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn commit_nodes<E: Element>(
    network: &Network<'_, E>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) -> Option<Place> {
    let mut place = None;
    let nodes = work.pressure.iter_mut().zip(work.per_mass.iter()).zip(work.node_delta.iter());
    let nodes = nodes.zip(state.common.nodes.iter()).zip(state.junction.iter_mut());
    for ((index, node), ((((pressure, per_mass), delta), [mass, ..]), [junction, carry])) in
        (0u32..).zip(network.nodes).zip(nodes)
    {
        *pressure = if node.kind == NodeKind::Junction {
            math::compensated_add(junction, carry, *delta);
            *junction
        } else {
            node.start_gauge_pa + per_mass * mass
        };
        if math::beyond(*pressure, Fault::GAUGE_LIMIT_PA) {
            place = place.or(Some(Place::Node(index)));
        }
    }
    place
}
