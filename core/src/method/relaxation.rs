//! Relaxation: the paper's system, whose only fixed point is the steady state, by explicit Euler.
//!
//! For a line A→B whose flow state w sits on element v, with gauge pressures `q_i = p_i − p_A` behind element
//! i, and everything behind v folded into the flow row:
//!
//! ```text
//! q_i' = q_{i−1} − q_i + f_i − R_i·a       i < v, q_0 = 0, a = (m_i·w)·|m_i·w|
//! w'   = φ·(q_{v−1} + p_A − p_B + f − R·w|w|)
//! p_n += h·Rg·T/V·Σw                        after all lines, with their new flows
//! ```
//!
//! `m_i` is the ratio of the flow at element i to the flow at v; it differs from 1 where mass is taken out and
//! the flow runs forward. Source: Qiu et al. 2017, Eqs. (10)–(11) in the reading that reproduces the printed
//! figures; folding and gauge are derived. Valid for h ≤ 10 ms. **Pseudo-time**: transients of this method are
//! not physics. Volumes and inertances inside lines are not used.

use super::common::{self, Common, Cut};
use crate::component::Element;
use crate::law::Operating;
use crate::operator::{self, FlowRow, Margin, Proof};
use crate::simulator::{Fault, Place};
use crate::unroll::every;
use crate::{Active, Line, Method, MethodError, Network, Segment, math};

/// Figures that a line keeps, of all elements whose law never changes: ΣR of its rows; ΣR of the flow row, forward and
/// reverse; head of the flow row; ratio of inlet and of outlet flow to the line's.
const LINE_FIGURES: usize = 6;

/// Largest pressure difference between the nodes of a line at the start [Pa]. The flow row has a unit rate: from rest
/// it gains h·Δp [kg/s] in one step, which at ventilation pressures is little and at a leak to vacuum a cabin's air.
const LARGEST_DIFFERENCE_PA: f32 = 1e4;

/// Smallest flow at which a linear loss is turned into a quadratic one [kg/s].
const SMALLEST_FLOW: f32 = 1e-6;

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn sizes<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    let (nodes, lines, segments) = (network.nodes.len(), network.lines.len(), network.segments.len());
    (Common::length(network) + 2 * segments, 2 * nodes + LINE_FIGURES * lines + 4 * segments)
}

pub(crate) fn check<E: Element>(
    network: &Network<'_, E>,
    step_us: u32,
    longest_us: u32,
) -> Result<(), MethodError> {
    if step_us == 0 || step_us > longest_us {
        return Err(MethodError::Step { longest_us });
    }
    Method::refuse_junctions(network)?;
    if let Some(entry) = network.responsive.first() {
        return Err(MethodError::Responsive(entry.line));
    }
    for (index, line) in (0u32..).zip(network.lines) {
        let gauge = |node: u32| network.nodes.get(node as usize).map_or(0.0, |node| node.start_gauge_pa);
        if (gauge(line.from) - gauge(line.to)).abs() > LARGEST_DIFFERENCE_PA {
            return Err(MethodError::PressureDifference(index));
        }
    }
    let h = step_us as f32 * 1e-6;
    for (index, node) in (0u32..).zip(network.nodes) {
        let stiffness = h * h * node.pressure_per_mass_pa_kg();
        if stiffness <= 0.0 {
            continue;
        }
        // A loop that starts and ends here moves this node only by what it loses. The search is left as soon
        // as one line more would be too many.
        let most = (1.0 / stiffness) as usize;
        let crossing = network.lines.iter().filter(|line| (line.from == index) != (line.to == index));
        if most < network.lines.len() && crossing.take(most + 1).count() > most {
            return Err(MethodError::NodeTooSmall(index));
        }
    }
    Ok(())
}

/// The state buffer by name.
struct State<'s> {
    common: Common<'s>,
    gauge: &'s mut [f32],
    gauge_carry: &'s mut [f32],
}

impl<'s> State<'s> {
    fn of<E>(network: &Network<'_, E>, buffer: &'s mut [f32]) -> Self {
        let segments = network.segments.len();
        let cut = &mut Cut(buffer);
        let common = Common::cut(network, cut);
        Self { common, gauge: cut.take(segments), gauge_carry: cut.take(segments) }
    }
}

/// The work buffer by name.
struct Work<'w> {
    /// Node pressures [Pa gauge].
    pressure: &'w mut [f32],
    /// dp/dm of every node [Pa/kg].
    per_mass: &'w mut [f32],
    /// Sums over each line's segments whose law never changes.
    lines: &'w mut [[f32; LINE_FIGURES]],
    /// Resistance of each row as the line's own flow meets it: forward, `R·m²`, and reverse, R.
    forward: &'w mut [f32],
    reverse: &'w mut [f32],
    /// Head of each row.
    head: &'w mut [f32],
    /// `m_i` of each row.
    ratio: &'w mut [f32],
}

impl<'w> Work<'w> {
    fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let (nodes, segments) = (network.nodes.len(), network.segments.len());
        let cut = &mut Cut(buffer);
        let (pressure, per_mass) = (cut.take(nodes), cut.take(nodes));
        let lines = cut.take_rows(network.lines.len());
        let (forward, reverse, head) = (cut.take(segments), cut.take(segments), cut.take(segments));
        Self { pressure, per_mass, lines, forward, reverse, head, ratio: cut.take(segments) }
    }
}

/// Sets the start state and everything that stays constant during a run.
pub(crate) fn start<E: Element>(
    network: &Network<'_, E>,
    state: &mut [f32],
    work: &mut [f32],
    inputs: &[f32],
) {
    state.fill(0.0);
    work.fill(0.0);
    let state = State::of(network, state);
    let work = Work::of(network, work);
    for ((node, pressure), per_mass) in network.nodes.iter().zip(work.pressure).zip(work.per_mass) {
        *pressure = node.start_gauge_pa;
        *per_mass = node.pressure_per_mass_pa_kg();
    }
    for ((line, [flow, ..]), figures) in network.lines.iter().zip(state.common.lines).zip(work.lines) {
        *flow = line.start_flow_kg_s;
        let [rows_sum, fold, fold_plain, fold_head, inlet, outlet] = figures;
        *outlet = common::flow_ratios(network, line, |index, segment, ratio| {
            let place = line.first_segment as usize + index;
            let square = ratio * ratio;
            if index == 0 {
                *inlet = ratio;
            }
            let (Some(forward), Some(reverse), Some(head), Some(own)) = (
                work.forward.get_mut(place),
                work.reverse.get_mut(place),
                work.head.get_mut(place),
                work.ratio.get_mut(place),
            ) else {
                return;
            };
            *own = ratio;
            if segment.element.is_active() {
                return;
            }
            let law = segment.element.law(&operating(segment, inputs, 0.0));
            if index < line.flow_segment as usize {
                (*forward, *reverse, *head) = (law.resistance * square, law.resistance, law.head);
                *rows_sum += *forward;
            } else {
                *fold += law.resistance * square;
                *fold_plain += law.resistance;
                *fold_head += law.head;
            }
        });
    }
}

fn operating<'i, E: Element>(segment: &Segment<E>, inputs: &'i [f32], mass_flow_kg_s: f32) -> Operating<'i> {
    let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
    Operating::plain(inputs, mass_flow_kg_s)
}

/// Advances by `h` [s]. `stabilised` switches the operator on. Returns the margin of this step and the first
/// value that left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn step<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    h: f32,
    stabilised: bool,
    state: &mut [f32],
    work: &mut [f32],
    inputs: &[f32],
) -> (Margin, Option<Place>) {
    let (mut state, mut work) = (State::of(network, state), Work::of(network, work));
    let mut active = network.active;
    let mut margin = Margin::FREE;
    let mut place = None;
    for (index, line) in network.lines.iter().enumerate() {
        let w = state.common.lines.get(index).map_or(0.0, |[w, ..]| *w);
        let sums = refresh::<E, UNROLL>(network, &mut active, inputs, index, line, w, &mut work);
        let own = step_line::<UNROLL>(index, line, h, stabilised, &sums, &mut state, &work);
        margin = if index == 0 { own } else { margin.with(own) };
        if state.common.lines.get(index).is_none_or(|[w, ..]| math::beyond(*w, Fault::FLOW_LIMIT_KG_S)) {
            place = place.or(Some(Place::Line(index as u32)));
        }
    }
    let nodes = state.common.nodes.iter().zip(work.pressure).zip(work.per_mass);
    for ((([mass, ..], pressure), per_mass), (index, node)) in nodes.zip((0u32..).zip(network.nodes)) {
        *pressure = node.start_gauge_pa + *per_mass * *mass;
        if Fault::outside(*pressure, network.reference_pa) {
            place = place.or(Some(Place::Node(index)));
        }
    }
    (margin, place)
}

/// What a line's flow meets in this step.
struct Sums {
    /// ΣR of the rows [Pa·s²/kg²].
    rows: f32,
    /// ΣR [Pa·s²/kg²], ΣL [Pa·s/kg] and head [Pa] of the flow row.
    fold: f32,
    linear: f32,
    head: f32,
}

/// Evaluates the laws of a line that may have changed, and sums. `UNROLL` walks all segments, for a description known
/// to the compiler, which then keeps only those that are active; otherwise these are taken from the front of `active`,
/// which is in the order of the lines.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn refresh<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    active: &mut &[Active],
    inputs: &[f32],
    index: usize,
    line: &Line,
    w: f32,
    work: &mut Work<'_>,
) -> Sums {
    let Some(&[rows, forward, reverse, head, _, _]) = work.lines.get(index) else {
        return Sums { rows: 0.0, fold: 0.0, linear: 0.0, head: 0.0 };
    };
    let fold = if w > 0.0 { forward } else { reverse };
    let mut sums = Sums { rows, fold, linear: 0.0, head };
    if UNROLL {
        for (place, segment) in (line.first_segment as usize..).zip(network.segments_of(line)) {
            if segment.element.is_active() {
                refresh_one(segment, line, w, place, inputs, &mut sums, work);
            }
        }
    } else {
        while let Some((first, rest)) = active.split_first() {
            if first.line as usize != index {
                break;
            }
            *active = rest;
            let place = first.segment as usize;
            if let Some(segment) = network.segments.get(place) {
                refresh_one(segment, line, w, place, inputs, &mut sums, work);
            }
        }
    }
    sums
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn refresh_one<E: Element>(
    segment: &Segment<E>,
    line: &Line,
    w: f32,
    place: usize,
    inputs: &[f32],
    sums: &mut Sums,
    work: &mut Work<'_>,
) {
    let (Some(forward), Some(reverse), Some(head), Some(&own)) = (
        work.forward.get_mut(place),
        work.reverse.get_mut(place),
        work.head.get_mut(place),
        work.ratio.get(place),
    ) else {
        return;
    };
    // Nothing is drained from reversed flow.
    let ratio = if w > 0.0 { own } else { 1.0 };
    let law = segment.element.law(&operating(segment, inputs, ratio * w));
    if place < (line.first_segment + line.flow_segment) as usize {
        *reverse = law.resistance;
        if law.linear > 0.0 {
            *reverse += law.linear / math::larger(ratio * w.abs(), SMALLEST_FLOW);
        }
        *forward = *reverse * (own * own);
        *head = law.head;
        sums.rows += *forward;
    } else {
        sums.fold += law.resistance * (ratio * ratio);
        // Most have neither, and the compiler knows it of those it sees.
        if law.linear > 0.0 {
            sums.linear += law.linear * ratio;
        }
        if law.head != 0.0 {
            sums.head += law.head;
        }
    }
}

/// One line: its rows with the flow of the step's start, then its flow, then what it moves between its nodes.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the only loop over lines")]
fn step_line<const UNROLL: bool>(
    index: usize,
    line: &Line,
    h: f32,
    stabilised: bool,
    sums: &Sums,
    state: &mut State<'_>,
    work: &Work<'_>,
) -> Margin {
    let (from, to) = (line.from as usize, line.to as usize);
    let first = line.first_segment as usize;
    let rows = first..first + line.flow_segment as usize;
    let (Some(&[.., inlet, outlet]), Some([flow, flow_carry, ..]), Some(&p_from), Some(&p_to)) = (
        work.lines.get(index),
        state.common.lines.get_mut(index),
        work.pressure.get(from),
        work.pressure.get(to),
    ) else {
        return Margin { phi: 0.0, spectral_bound: f32::INFINITY, proof: Proof::None };
    };
    let w = *flow;
    let resistance = if w > 0.0 { &work.forward } else { &work.reverse };
    let (Some(gauge), Some(carry), Some(resistance), Some(head)) = (
        state.gauge.get_mut(rows.clone()),
        state.gauge_carry.get_mut(rows.clone()),
        resistance.get(rows.clone()),
        work.head.get(rows),
    ) else {
        return Margin { phi: 0.0, spectral_bound: f32::INFINITY, proof: Proof::None };
    };
    let &Sums { rows: others, fold: folded, linear, head: fold_head } = sums;

    // w|w|, linear below the flow at which the whole line's loss is `laminar_below_pa`
    let (mut size, mut slope) = (w.abs(), 2.0 * w.abs());
    if line.laminar_below_pa > 0.0 {
        let laminar = math::sqrt(line.laminar_below_pa / (others + folded));
        if size < laminar {
            (size, slope) = (laminar, laminar);
        }
    }
    let square = w * size;

    let mut before = 0.0;
    let rows_of_line = gauge.iter_mut().zip(carry).zip(resistance.iter().zip(head));
    every!(UNROLL, rows_of_line, ((q, c), (&r, &f)) => {
        let rate = before - *q + f - r * square;
        before = *q;
        math::compensated_add(q, c, h * rate);
    });

    let rows = line.flow_segment as f32;
    let row = FlowRow { step: h, slope, own: folded, own_linear: linear, others, rows };
    let phi = if stabilised { operator::phi(row.stiffness()) } else { 1.0 };
    let driving = before + (p_from - p_to) + fold_head;
    let mut lost = folded * square;
    if linear > 0.0 {
        lost += linear * w;
    }
    math::compensated_add(flow, flow_carry, h * phi * (driving - lost));

    // Each transfer is rounded once; taken − given is exact because the two are within a factor of two.
    let passed = h * *flow;
    let (taken, given) = if *flow > 0.0 { (inlet * passed, outlet * passed) } else { (passed, passed) };
    common::transfer(&mut state.common, index, line, taken, given, taken - given);
    if stabilised { row.margin_with_phi(phi) } else { row.margin(phi) }
}
