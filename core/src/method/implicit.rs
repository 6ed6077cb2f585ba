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
//!   β = `1.2071·δ_γ`; two solves a stage. Second order, L-stable (Bank et al. 1985).
//!
//! Masses move by mean flows over the step, each rounded once, never by the solved pressures.

pub(crate) mod line;
pub(crate) mod matrix;

use self::line::{CELL, Cell};
use self::matrix::Matrix;
use super::common::{self, Common, Cut};
use crate::element::{Element, Operating};
use crate::operator::Margin;
use crate::simulator::{Fault, Place};
use crate::{Line, Method, MethodError, Network, NodeKind, Plan, Segment, air, math};

/// (1 − 1/√2): stage length of TR-BDF2 over the step, and weight of the last stage in the mean flow.
const TAU: f32 = 0.292_893_23;
/// 2 − √2: the inner stage of TR-BDF2 as part of the step.
pub(crate) const INNER_STAGE: f32 = 0.585_786_44;
/// (√2 + 1)/2: part of the first stage's increment that starts the second.
const CARRY_OVER: f32 = 1.207_106_8;
/// √2/4: weight of the first stage's increment in the mean flow.
const MEAN: f32 = 0.353_553_4;

/// Largest pressure difference that a segment is expected to see [Pa]: where it would drive the flow against
/// friction rather than against inertance within one stage, the slope is guarded.
const EXPECTED_DRIVE_PA: f32 = 1e3;

/// Figures of a node: pressure [Pa gauge]; its increment; dp/dm [Pa/kg]; C/τ [kg/(s·Pa)]; known part of the
/// balance [kg/s].
pub(crate) const NODE_FIGURES: usize = 5;
type NodeFigures = [f32; NODE_FIGURES];

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn sizes<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    let (nodes, lines, segments) = (network.nodes.len(), network.lines.len(), network.segments.len());
    let (rows, entries) = (network.plan.order.len(), network.plan.columns.len());
    (
        Common::length(network) + 2 * nodes + 4 * segments,
        NODE_FIGURES * nodes + 2 * lines + CELL * segments + entries + 3 * rows,
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
    junctions: &'s mut [[f32; 2]],
    /// Flow of every segment and its carry [kg/s], pressure behind it and its carry [Pa gauge].
    segments: &'s mut [[f32; 4]],
}

impl<'s> State<'s> {
    fn of<E>(network: &Network<'_, E>, buffer: &'s mut [f32]) -> Self {
        let cut = &mut Cut(buffer);
        let common = Common::cut(network, cut);
        let junctions = cut.take_rows(network.nodes.len());
        Self { common, junctions, segments: cut.take_rows(network.segments.len()) }
    }
}

struct Work<'w> {
    nodes: &'w mut [NodeFigures],
    /// Flow below which a line is linear in this stage [kg/s].
    laminar: &'w mut [f32],
    /// 1 where a line has a joint that stores next to nothing, else 0.
    stiff: &'w mut [f32],
    cells: &'w mut [Cell],
    matrix: Matrix<'w>,
}

impl<'w> Work<'w> {
    fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let rows = network.plan.order.len();
        let cut = &mut Cut(buffer);
        let nodes = cut.take_rows(network.nodes.len());
        let (laminar, stiff) = (cut.take(network.lines.len()), cut.take(network.lines.len()));
        let cells = cut.take_rows(network.segments.len());
        let (entries, rhs) = (cut.take(network.plan.columns.len()), cut.take(rows));
        let matrix = Matrix { entries, rhs, reciprocal: cut.take(rows), dense: cut.take(rows) };
        Self { nodes, laminar, stiff, cells, matrix }
    }
}

/// The cells of a line.
fn range(line: &Line) -> core::ops::Range<usize> {
    let first = line.first_segment as usize;
    first..first + line.segments as usize
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
    for ((node, figures), [junction, _]) in network.nodes.iter().zip(work.nodes).zip(state.junctions) {
        *junction = node.start_gauge_pa;
        let per_mass = node.pressure_per_mass_pa_kg();
        let capacity = if per_mass > 0.0 { 1.0 / (per_mass * tau) } else { 0.0 };
        *figures = [node.start_gauge_pa, 0.0, per_mass, capacity, 0.0];
    }
    for (line, stiff) in network.lines.iter().zip(work.stiff) {
        let node = network.nodes.get(line.from as usize);
        let (temperature, from) = node.map_or((0.0, 0.0), |node| (node.temperature_k, node.start_gauge_pa));
        let (Some(cells), Some(states)) =
            (work.cells.get_mut(range(line)), state.segments.get_mut(range(line)))
        else {
            continue;
        };
        for ((segment, cell), state) in network.segments_of(line).iter().zip(cells.iter_mut()).zip(states) {
            let volume = segment.outlet_volume_m3;
            let rise = if volume > 0.0 { air::pressure_per_mass_pa_kg(volume, temperature) } else { 0.0 };
            let inertia = segment.inertance_per_m / tau;
            *state = [line.start_flow_kg_s, 0.0, from, 0.0];
            set_law(cell, segment, inputs, line.start_flow_kg_s);
            // A law that changes may become as stiff as it likes within one step.
            let guarded =
                segment.element.is_active() || inertia * inertia < 4.0 * cell[4] * EXPECTED_DRIVE_PA;
            cell[0] = inertia;
            cell[1] = if rise > 0.0 { 1.0 / (rise * tau) } else { 0.0 };
            cell[2] = segment.element.removal();
            cell[3] = if guarded { 1.0 } else { 0.0 };
            cell[14] = rise;
        }
        *stiff = if line::has_stiff_joint(cells) { 1.0 } else { 0.0 };
    }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn set_law<E: Element>(cell: &mut Cell, segment: &Segment<E>, inputs: &[f32], mass_flow_kg_s: f32) {
    let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
    let law = segment.element.law(&Operating { inputs, mass_flow_kg_s, density_ratio: 1.0 });
    let [_, _, _, _, resistance, linear, head, ..] = cell;
    (*resistance, *linear, *head) = (law.resistance, law.linear, law.head);
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
pub(crate) fn step<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    method: Method,
    h: f32,
    state: &mut [f32],
    work: &mut [f32],
    inputs: StageInputs<'_>,
) -> (Margin, Option<Place>) {
    let (mut state, mut work) = (State::of(network, state), Work::of(network, work));
    let work = &mut work;
    begin(network, &state, work);
    let weights = if method == Method::TrBdf2 {
        laws::<E, UNROLL>(network, inputs.start, work);
        rates(network, work);
        laws::<E, UNROLL>(network, inputs.middle, work);
        push(network, work);
        for _ in 0..2 {
            solve(network, work);
        }
        settle(network, work);
        carry_over(work);
        laws::<E, UNROLL>(network, inputs.end, work);
        push(network, work);
        for _ in 0..2 {
            solve(network, work);
        }
        settle(network, work);
        [MEAN, TAU]
    } else {
        laws::<E, UNROLL>(network, inputs.end, work);
        push(network, work);
        solve(network, work);
        settle(network, work);
        [0.0, 1.0]
    };
    let place = commit(network, h, weights, &mut state, work);
    (Margin::by_construction(1.0), place)
}

/// Takes flows and pressures of the step's start over into the cells and clears the iterate.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn begin<E: Element>(network: &Network<'_, E>, state: &State<'_>, work: &mut Work<'_>) {
    for [_, delta, _, _, known] in work.nodes.iter_mut() {
        (*delta, *known) = (0.0, 0.0);
    }
    for (cell, [flow, _, gauge, _]) in work.cells.iter_mut().zip(state.segments.iter()) {
        let [_, _, _, _, _, _, _, momentum, mass, w, p, dw, dp, first, ..] = cell;
        (*momentum, *mass, *w, *p) = (0.0, 0.0, *flow, *gauge);
        (*dw, *dp, *first) = (0.0, 0.0, 0.0);
    }
    let columns = work.laminar.iter().zip(work.stiff.iter());
    for (line, (laminar, stiff)) in network.lines.iter().zip(columns) {
        let pressure = |node: u32| work.nodes.get(node as usize).map_or(0.0, |[pressure, ..]| *pressure);
        let (from, to) = (pressure(line.from), pressure(line.to));
        let Some(cells) = work.cells.get_mut(range(line)) else { continue };
        if let Some([_, _, _, _, _, _, _, _, _, _, p, ..]) = cells.last_mut() {
            *p = to;
        }
        if *stiff > 0.0 {
            line::rebase(cells, from, *laminar);
        }
    }
}

/// Evaluates the laws that may have changed, and every line's laminar flow. `UNROLL` walks all segments, for a
/// description known to the compiler.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn laws<E: Element, const UNROLL: bool>(network: &Network<'_, E>, inputs: &[f32], work: &mut Work<'_>) {
    let mut set = |index: usize, segment: &Segment<E>| {
        if let Some(cell) = work.cells.get_mut(index) {
            let [_, _, _, _, _, _, _, _, _, w, _, dw, ..] = *cell;
            set_law(cell, segment, inputs, w + dw);
        }
    };
    if UNROLL {
        for (index, segment) in network.segments.iter().enumerate() {
            if segment.element.is_active() {
                set(index, segment);
            }
        }
    } else {
        for active in network.active {
            if let Some(segment) = network.segments.get(active.segment as usize) {
                set(active.segment as usize, segment);
            }
        }
    }
    for (line, laminar) in network.lines.iter().zip(work.laminar.iter_mut()) {
        if line.laminar_below_pa > 0.0 {
            let cells = work.cells.get(range(line)).unwrap_or(&[]);
            let resistance: f32 = cells.iter().map(|[_, _, _, _, resistance, ..]| *resistance).sum();
            *laminar = math::sqrt(line.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE));
        }
    }
}

/// Known parts of the trapezoidal stage: the rates of change at the step's start.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn rates<E: Element>(network: &Network<'_, E>, work: &mut Work<'_>) {
    for (line, laminar) in network.lines.iter().zip(work.laminar.iter()) {
        let laminar = if line.laminar_below_pa > 0.0 { *laminar } else { 0.0 };
        let Some(cells) = work.cells.get_mut(range(line)) else { continue };
        let from = work.nodes.get(line.from as usize).map_or(0.0, |[pressure, ..]| *pressure);
        let (inlet, outlet) = line::rates(cells, from, laminar);
        if line.from == line.to {
            add_known(work.nodes, line.from, outlet - inlet);
        } else {
            add_known(work.nodes, line.from, -inlet);
            add_known(work.nodes, line.to, outlet);
        }
    }
}

/// Adds to the known part of a node's balance; where nothing is stored, nothing is known.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn add_known(nodes: &mut [NodeFigures], node: u32, value: f32) {
    if let Some([_, _, _, capacity, known]) = nodes.get_mut(node as usize)
        && *capacity > 0.0
    {
        *known += value;
    }
}

/// Known parts of the BDF2 stage: a share of the first stage's increments.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn carry_over(work: &mut Work<'_>) {
    for cell in work.cells.iter_mut() {
        let [inertia, capacity, _, _, _, _, _, momentum, mass, _, _, dw, dp, first, ..] = cell;
        *momentum = CARRY_OVER * *inertia * *dw;
        *mass = CARRY_OVER * *capacity * *dp;
        *first = *dw;
    }
    for [_, delta, _, capacity, known] in work.nodes.iter_mut() {
        *known = CARRY_OVER * *capacity * *delta;
    }
}

/// Completes the known parts of all momenta for a stage.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn push<E: Element>(network: &Network<'_, E>, work: &mut Work<'_>) {
    for line in network.lines {
        let from = work.nodes.get(line.from as usize).map_or(0.0, |[pressure, ..]| *pressure);
        if let Some(cells) = work.cells.get_mut(range(line)) {
            line::push(cells, from);
        }
    }
}

/// One Newton iteration: all lines are swept, the nodes solved, the lines filled in.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn solve<E: Element>(network: &Network<'_, E>, work: &mut Work<'_>) {
    let plan = &network.plan;
    work.matrix.entries.fill(0.0);
    for ((&node, &diagonal), rhs) in plan.order.iter().zip(plan.diagonal).zip(work.matrix.rhs.iter_mut()) {
        if let (Some(entry), Some([_, _, _, capacity, known])) =
            (work.matrix.entries.get_mut(diagonal as usize), work.nodes.get(node as usize))
        {
            (*entry, *rhs) = (*capacity, *known);
        }
    }
    for ((line, laminar), stamps) in network.lines.iter().zip(work.laminar.iter()).zip(plan.stamps) {
        // Said this way, a line without laminar range is known to have none when the network is compiled in.
        let laminar = if line.laminar_below_pa > 0.0 { *laminar } else { 0.0 };
        let (Some(cells), Some(from), Some(to)) = (
            work.cells.get_mut(range(line)),
            work.nodes.get(line.from as usize),
            work.nodes.get(line.to as usize),
        ) else {
            continue;
        };
        let mut arrives = 1.0;
        if let Some([_, _, removal, _, _, _, _, _, _, w, _, dw, dp, ..]) = cells.last_mut() {
            *dp = to[1];
            // What a drain at the last element takes never reaches the outlet node.
            if *removal > 0.0 && *w + *dw > 0.0 {
                arrives = 1.0 / (1.0 + *removal);
            }
        }
        let admittance = line::sweep(cells, from[1], laminar);
        stamp(&mut work.matrix, plan, line, *stamps, &admittance, arrives);
    }
    work.matrix.solve(plan);
    for (&node, &solution) in plan.order.iter().zip(work.matrix.rhs.iter()) {
        if let Some([_, delta, ..]) = work.nodes.get_mut(node as usize) {
            *delta = solution;
        }
    }
    for line in network.lines {
        let delta = |node: u32| work.nodes.get(node as usize).map_or(0.0, |[_, delta, ..]| *delta);
        if let Some(cells) = work.cells.get_mut(range(line)) {
            line::substitute(cells, delta(line.from), delta(line.to));
        }
    }
}

/// Makes the flows of a stage agree where a line stores next to nothing between them.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn settle<E: Element>(network: &Network<'_, E>, work: &mut Work<'_>) {
    for (line, stiff) in network.lines.iter().zip(work.stiff.iter()) {
        if let Some(cells) = work.cells.get_mut(range(line)).filter(|_| *stiff > 0.0) {
            line::settle(cells);
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
    let [from_from, from_to, to_from, to_to] = stamps;
    if line.from == line.to {
        // The two through-parts belong to the same pressure and cancel exactly.
        matrix.add_rhs(row(line.from), arrives * a.outlet - a.inlet);
        matrix.add(from_from, a.inlet_held + arrives * a.outlet_held);
        return;
    }
    matrix.add_rhs(row(line.from), -a.inlet);
    matrix.add_rhs(row(line.to), arrives * a.outlet);
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
        let (Some(cells), Some(states)) = (work.cells.get(range(line)), state.segments.get_mut(range(line)))
        else {
            continue;
        };
        let moved = line::commit(cells, states, h, weights, Fault::FLOW_LIMIT_KG_S);
        if moved.beyond {
            place = place.or(Some(Place::Line(index)));
        }
        common::transfer(&mut state.common, index as usize, line, moved.taken, moved.given, moved.drained);
    }
    let nodes = work.nodes.iter_mut().zip(state.common.nodes.iter()).zip(state.junctions.iter_mut());
    for ((([pressure, delta, per_mass, ..], [mass, ..]), [junction, carry]), (index, node)) in
        nodes.zip((0u32..).zip(network.nodes))
    {
        *pressure = if node.kind == NodeKind::Junction {
            math::compensated_add(junction, carry, *delta);
            *junction
        } else {
            node.start_gauge_pa + *per_mass * *mass
        };
        if Fault::outside(*pressure, network.reference_pa) {
            place = place.or(Some(Place::Node(index)));
        }
    }
    place
}
