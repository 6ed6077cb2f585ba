//! Laws of lines that respond to pressures, direction, memory or density: stated anew before every solve.
//!
//! A line of which only the density follows has its laws stated where a stage starts. A network with lines that react to more
//! takes [`MORE`] solves a stage more: where a check valve turns or a flow chokes the first solution still has the law of
//! the other side. A law that changes while the stage is solved leaves its resistance
//! frozen in each solve; the fixed point of the iteration is that of the law itself.

use super::layout::{Work, at, continues};
use super::{CARRY_OVER, Model, law, range, solve};
use crate::component::Element;
use crate::law::Operating;
use crate::method::responsive::{self, Given, Reach};
use crate::{Line, Network, Plan, Responsive, math};

/// Solves a stage on top of those of any network.
const MORE: u32 = 2;

/// Marks of a guarded slope: with the law of forward flow, also where a valve gives back what the first stage moved too
/// much; with that of reversed flow, also where such a valve has shut.
const FORWARD: f32 = 1.0;
const GIVES_BACK: f32 = 1.5;
const REVERSED: f32 = 2.0;
const SHUT: f32 = 3.0;

/// Resistance to what comes back through a valve, over that to what the first stage moved [1].
const GIVING: f32 = 1e-3;
/// Smallest ratio of the reversed to the forward resistance of an element that blocks reversed flow [1].
const BLOCKS: f32 = 4.0;

/// Where laws are stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// At the step's start, for its first stage.
    Start,
    /// Where the first stage ended, for the second.
    NextStage,
    /// Where the last solve of a stage went to; heads stand for the whole stage.
    Iterate,
    /// The same, and what has turned stays turned: the last solves only close.
    Closing,
}

/// Advances the memories by `step_s` [s], at the pressures and flows of the step's start.
#[inline(never)]
pub(super) fn advance<E: Element>(
    network: &Network<'_, E>,
    step_s: f32,
    given: Given<'_>,
    flow: &[f32],
    memory: &mut [f32],
    work: &Work<'_>,
) {
    for entry in network.responsive {
        let Some(line) = network.lines.get(entry.line as usize) else { continue };
        reaches(
            network,
            entry,
            line,
            given,
            |point| at(work.pressure, point),
            |last, _, reach| {
                reach.advance(at(flow, last as u32), step_s, memory);
            },
        );
    }
}

/// Whether a line reacts to more than density.
fn reacts<E: Element>(network: &Network<'_, E>, line: &Line) -> bool {
    network.segments_of(line).iter().any(|segment| segment.element.responds())
}

/// Whether any line of a network does.
pub(super) fn some_react<E: Element>(network: &Network<'_, E>) -> bool {
    let lines = network.responsive.iter().filter_map(|entry| network.lines.get(entry.line as usize));
    lines.into_iter().any(|line| reacts(network, line))
}

/// States the laws of a line of which only the density follows: of the node from which the present flow comes.
fn state_density<E: Element>(
    network: &Network<'_, E>,
    tau: f32,
    given: Given<'_>,
    (entry, line): (&Responsive, &Line),
    flow: &[f32],
    solved: bool,
    work: &mut Work<'_>,
) {
    let gauge =
        |work: &Work<'_>, point| at(work.pressure, point) + if solved { at(work.delta, point) } else { 0.0 };
    let turned = law::is_turned(network, line);
    let flow_place = if turned { law::flow_place(network, line) } else { 0 };
    let (mut first, mut line_forward) = (line.first_segment as usize, false);
    for last in range(line) {
        if continues(&network.plan, last) {
            continue;
        }
        let place = last as u32;
        let b = work.ports.get(last).map_or(0.0, |port| port[0]);
        let step = if solved { at(work.q, place) + b * at(work.differ, place) } else { 0.0 };
        let w = at(flow, place) + step;
        let forward = if w == 0.0 {
            let points = network.plan.between.get(last).copied().unwrap_or([Plan::NOWHERE; 2]);
            gauge(work, points[0]) >= gauge(work, points[1])
        } else {
            w > 0.0
        };
        if last == flow_place {
            line_forward = forward;
        }
        let gas_of = |node| responsive::gas(network, entry, given.virtual_k, node, gauge(work, node));
        let intake = gas_of(line.from);
        let gas = if forward { intake } else { gas_of(line.to) };
        let (mut sums, mut ratio, mut inertance) = ([0.0f32; 3], 1.0f32, 0.0);
        for index in (first..=last).rev() {
            let Some(segment) = network.segments.get(index) else { continue };
            if index < last && forward {
                ratio *= 1.0 + segment.element.removal();
            }
            let inputs = given.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
            let plain = Operating::plain(inputs, if w > 0.0 { ratio * w } else { w });
            let stated = |(density_ratio, temperature_k)| {
                segment.element.law(&Operating { density_ratio, temperature_k, ..plain })
            };
            let mut own = stated(gas);
            if !forward {
                // A head is the intake's in both directions.
                own.head = stated(intake).head;
            }
            sums[0] += own.resistance * (ratio * ratio);
            sums[1] += own.linear * ratio;
            sums[2] += own.head;
            inertance += ratio * (segment.inertance_per_m / tau);
            if let Some(law) = work.law.get_mut(index) {
                *law = [own.resistance, own.linear, own.head];
            }
        }
        let mark = if forward { FORWARD } else { REVERSED };
        for (column, value) in [
            (&mut work.quadratic, sums[0]),
            (&mut work.linear, sums[1]),
            (&mut work.head, sums[2]),
            (&mut work.inertia, inertance),
            (&mut work.guarded, mark),
        ] {
            if let Some(slot) = column.get_mut(last) {
                *slot = value;
            }
        }
        first = last + 1;
    }
    if turned {
        law::turn_laminar(network, line, line_forward, work);
    } else {
        law::set_laminar(line, work);
    }
}

/// Whether an element of a reach lets forward flow pass and blocks reversed flow.
fn blocks<E: Element>(network: &Network<'_, E>, reach: &Reach<'_, '_, E>, w: f32, memory: &[f32]) -> bool {
    let mut blocks = false;
    reach.laws(w, memory, |index, _, [ahead, back]| {
        let by_ends = network.segments.get(index).is_some_and(|segment| segment.element.needs_both_ends());
        let harder = back.linear > ahead.linear || back.resistance > BLOCKS * ahead.resistance;
        blocks |= harder && !by_ends;
    });
    blocks
}

/// States the laws at `place`; `SECOND` in the second stage of a step.
///
/// The first stage of TR-BDF2 goes on to its end with the flow of its middle, so a volume that empties through a valve
/// passes the pressure that it empties into. What the stage moved too much comes back in the second, through the open valve:
/// the valve is shut once the *mean* flow of the step reverses, `w̄ = 1/√2·w_m + (1 − 1/√2)·w`, and then moves its leak.
#[inline(never)]
pub(super) fn state_laws<E: Element, const SECOND: bool>(
    network: &Network<'_, E>,
    tau: f32,
    given: Given<'_>,
    place: Place,
    flow: &[f32],
    memory: &[f32],
    work: &mut Work<'_>,
) {
    let solved = place != Place::Start;
    let some_react = at(work.reacts, 0) > 0.0;
    for entry in network.responsive {
        let Some(line) = network.lines.get(entry.line as usize) else { continue };
        if !some_react || !reacts(network, line) {
            if matches!(place, Place::Start | Place::NextStage) {
                state_density(network, tau, given, (entry, line), flow, solved, work);
            }
            continue;
        }
        // Nothing below moves pressures, flows or increments.
        let (pressure, delta, differ) = (&*work.pressure, &*work.delta, &*work.differ);
        let q = &mut *work.q;
        let (ports, laws) = (&*work.ports, &mut *work.law);
        let (quadratic, linear, head) = (&mut *work.quadratic, &mut *work.linear, &mut *work.head);
        let (inertia, guarded) = (&mut *work.inertia, &mut *work.guarded);
        let (pushed, first) = (&mut *work.pushed, &*work.first);
        let gauge = |point| at(pressure, point) + if solved { at(delta, point) } else { 0.0 };
        let (flow_place, mut line_forward) = (law::flow_place(network, line), false);
        reaches(network, entry, line, given, gauge, |last, ends, reach| {
            let b = ports.get(last).map_or(0.0, |port| port[0]);
            let step = at(q, last as u32) + b * at(differ, last as u32);
            let w = at(flow, last as u32) + if solved { step } else { 0.0 };
            let turned = guarded.get(last).is_some_and(|mark| *mark >= REVERSED);
            // Flow at which the step's mean flow vanishes.
            let moved =
                if SECOND { CARRY_OVER * (at(flow, last as u32) + at(first, last as u32)) } else { 0.0 };
            let returns = moved > 0.0 && w < 0.0 && blocks(network, reach, w, memory);
            let still = if returns { -moved } else { 0.0 };
            let forward = if (w - still).abs() < f32::MIN_POSITIVE { ends[0] >= ends[1] } else { w > still };
            let forward = forward && !(turned && place == Place::Closing);
            if last == flow_place {
                line_forward = forward;
            }
            let (mut sums, mut inert) = ([0.0f32; 3], 0.0);
            reach.laws(w, memory, |index, ratio, [ahead, back]| {
                let (own, ratio) = if forward { (ahead, ratio) } else { (back, 1.0) };
                sums[0] += own.resistance * (ratio * ratio);
                sums[1] += own.linear * ratio;
                sums[2] += own.head;
                inert += ratio * network.segments.get(index).map_or(0.0, |s| s.inertance_per_m / tau);
                if let Some(law) = laws.get_mut(index) {
                    *law = [own.resistance, own.linear, own.head];
                }
            });
            // A valve that shuts within the step does so where nothing drives it any more: what comes back meets next to no
            // resistance, so that the ends of the step's pressures meet.
            if returns {
                let share = if forward { GIVING } else { 1.0 };
                sums = [0.0, share * sums[0] * moved + sums[1], sums[2]];
            }
            // A valve that has just turned is looked at where its leak would put it: the tangents of the others at the
            // flow that it no longer lets through would push on it.
            let drive = ((ends[0] - ends[1]) + sums[2]).abs();
            let root = math::sqrt(sums[1] * sums[1] + 4.0 * sums[0] * drive);
            let driven = 2.0 * drive / math::larger(sums[1] + root, f32::MIN_POSITIVE);
            if solved
                && !forward
                && sums[1] > sums[0] * (still - w)
                && driven < still - w
                && let Some(q) = q.get_mut(last)
            {
                *q = still - driven - at(flow, last as u32) - b * at(differ, last as u32);
            }
            let mark = match (forward, returns) {
                (true, false) => FORWARD,
                (true, true) => GIVES_BACK,
                (false, false) => REVERSED,
                (false, true) => SHUT,
            };
            for (column, value) in [
                (&mut *quadratic, sums[0]),
                (&mut *linear, sums[1]),
                (&mut *inertia, inert),
                (&mut *guarded, mark),
            ] {
                if let Some(slot) = column.get_mut(last) {
                    *slot = value;
                }
            }
            if let Some(slot) =
                head.get_mut(last).filter(|_| matches!(place, Place::Start | Place::NextStage))
            {
                *slot = sums[2];
            }
            // Within the second stage: what carries over, the head, and the leak that counts from the flow at standstill.
            if SECOND
                && place != Place::NextStage
                && let Some(pushed) = pushed.get_mut(last)
            {
                let carried = CARRY_OVER * inert * at(first, last as u32);
                *pushed = carried + at(head, last as u32) + if forward { 0.0 } else { sums[1] * still };
            }
        });
        if law::is_turned(network, line) {
            law::turn_laminar(network, line, line_forward, work);
        } else {
            law::set_laminar(line, work);
        }
    }
}

/// Solves a stage again with laws stated where the last solve went to.
#[inline(never)]
pub(super) fn solve_more<E: Element, const UNROLL: bool, const SECOND: bool>(
    model: &Model<'_, '_, E, UNROLL>,
    given: Given<'_>,
    flow: &[f32],
    memory: &[f32],
    work: &mut Work<'_>,
) {
    for _ in 0..MORE {
        state_laws::<E, SECOND>(model.network, model.tau, given, Place::Closing, flow, memory, work);
        solve::<E, UNROLL, false>(model, flow, work);
    }
}

/// Ends a step of two stages: the flow behind a valve that has shut is its leak, that through a valve that gave something back
/// stands. What passed is booked before.
#[inline(never)]
pub(super) fn shut<E: Element>(network: &Network<'_, E>, flow: &[f32], work: &mut Work<'_>) {
    for entry in network.responsive {
        let Some(line) = network.lines.get(entry.line as usize) else { continue };
        for last in range(line).filter(|&last| !continues(&network.plan, last)) {
            let (w, first, mark) =
                (at(flow, last as u32), at(work.first, last as u32), at(work.guarded, last as u32));
            if let Some(dw) = work.q.get_mut(last) {
                if mark == SHUT {
                    *dw += CARRY_OVER * (w + first);
                } else if mark == GIVES_BACK {
                    *dw = -w;
                }
            }
        }
    }
}

/// Calls `each` with the last segment of every reach of a line, the gauge pressures at its ends, and itself; `gauge_pa` gives the pressure of a point.
fn reaches<'a, 'n, E: Element>(
    network: &'a Network<'n, E>,
    entry: &Responsive,
    line: &Line,
    given: Given<'a>,
    gauge_pa: impl Fn(u32) -> f32,
    mut each: impl FnMut(usize, [f32; 2], &Reach<'a, 'n, E>),
) {
    let nodes = [line.from, line.to].map(&gauge_pa);
    let mut first = line.first_segment as usize;
    for last in range(line) {
        if continues(&network.plan, last) {
            continue;
        }
        let points = network.plan.between.get(last).copied().unwrap_or([Plan::NOWHERE; 2]);
        let ends = points.map(&gauge_pa);
        if let Some(reach) = Reach::new(network, entry, given, first..last + 1, ends, nodes) {
            each(last, ends, &reach);
        }
        first = last + 1;
    }
}
