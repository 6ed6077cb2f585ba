//! Laws of the stage: those that change are asked again, joined segments are summed, laminar flows follow.
//!
//! Segments with no volume between them carry one flow and are one reach: with m the ratio of a segment's flow to the
//! reach's (more than 1 ahead of a drain, in forward flow), ΣI·m, ΣR·m², ΣL·m and Σf are the reach's law.

use super::super::common::flow_ratios;
use super::layout::{Work, at, continues, is_joined};
use crate::component::Element;
use crate::law::{Law, Operating};
use crate::unroll::every;
use crate::{Line, Network, Segment, math};

/// Law of a segment at this flow [kg/s].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn of<E: Element>(segment: &Segment<E>, inputs: &[f32], mass_flow_kg_s: f32) -> Law {
    let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
    segment.element.law(&Operating::plain(inputs, mass_flow_kg_s))
}

/// Evaluates the laws that may have changed at the stage's inputs. `MOVED` flows have the increments of the first
/// stage. `UNROLL` walks all segments, for a description
/// known to the compiler.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn update<E: Element, const UNROLL: bool, const MOVED: bool>(
    network: &Network<'_, E>,
    tau: f32,
    inputs: &[f32],
    flow: &[f32],
    work: &mut Work<'_>,
) {
    if UNROLL {
        every!(many UNROLL, 0..network.segments.len(), index => {
            if let Some(segment) = network.segments.get(index)
                && segment.element.is_active()
            {
                set::<E, UNROLL, MOVED>(network, index, segment, inputs, flow, work);
            }
        });
    } else {
        for active in network.active {
            let index = active.segment as usize;
            if let Some(segment) = network.segments.get(index) {
                set::<E, UNROLL, MOVED>(network, index, segment, inputs, flow, work);
            }
        }
    }
    join::<E, UNROLL, MOVED>(network, tau, inputs, flow, work);
    every!(UNROLL, 0..network.active.len(), place => {
        if let Some(active) = network.active.get(place)
            && let Some(line) = network.lines.get(active.line as usize)
            && !turns(network, line, work)
        {
            set_laminar(line, work);
        }
    });
    if work.turning.first().is_some_and(|turning| *turning > 0.0) {
        turn_laminars::<E, MOVED>(network, flow, work);
    }
}

/// Laminar flows of all lines that follow the direction of their flow; a function of its own, which few networks call.
#[inline(never)]
fn turn_laminars<E: Element, const MOVED: bool>(network: &Network<'_, E>, flow: &[f32], work: &mut Work<'_>) {
    for line in network.lines.iter().filter(|line| is_turned(network, line)) {
        turn_laminar(network, line, present::<MOVED>(flow_place(network, line), flow, work) > 0.0, work);
    }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn set<E: Element, const UNROLL: bool, const MOVED: bool>(
    network: &Network<'_, E>,
    index: usize,
    segment: &Segment<E>,
    inputs: &[f32],
    flow: &[f32],
    work: &mut Work<'_>,
) {
    if continues(&network.plan, index) || is_joined(&network.plan, index) {
        return;
    }
    let law = of(segment, inputs, present::<MOVED>(index, flow, work));
    write(index, [law.resistance, law.linear, law.head], work);
    // Kept for the line's laminar flow only.
    let laminar = !UNROLL || network.lines.iter().any(|line| line.laminar_below_pa > 0.0);
    if let Some(own) = work.law.get_mut(index).filter(|_| laminar) {
        *own = [law.resistance, law.linear, law.head];
    }
}

/// Flow at the stage's start [kg/s].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn present<const MOVED: bool>(index: usize, flow: &[f32], work: &Work<'_>) -> f32 {
    at(flow, index as u32) + if MOVED { at(work.first, index as u32) } else { 0.0 }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn write(index: usize, [resistance, linear, head]: [f32; 3], work: &mut Work<'_>) {
    if let (Some(k), Some(l), Some(f)) =
        (work.quadratic.get_mut(index), work.linear.get_mut(index), work.head.get_mut(index))
    {
        (*k, *l, *f) = (resistance, linear, head);
    }
}

/// Sums every reach of several segments, in the direction in which it flows at the stage's start.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn join<E: Element, const UNROLL: bool, const MOVED: bool>(
    network: &Network<'_, E>,
    tau: f32,
    inputs: &[f32],
    flow: &[f32],
    work: &mut Work<'_>,
) {
    if work.merged.first().is_none_or(|merged| *merged <= 0.0) {
        return;
    }
    let mut first = 0;
    every!(many UNROLL, 0..network.plan.between.len(), last => {
        if !continues(&network.plan, last) {
            if first < last {
                let (reach, w) = (first..last + 1, present::<MOVED>(last, flow, work));
                if UNROLL {
                    sum::<E, true>(network, tau, inputs, w, reach, work);
                } else {
                    sum_apart(network, tau, inputs, w, reach, work);
                }
            }
            first = last + 1;
        }
    });
}

/// A function of its own, which few networks call.
#[inline(never)]
fn sum_apart<E: Element>(
    network: &Network<'_, E>,
    tau: f32,
    inputs: &[f32],
    w: f32,
    reach: core::ops::Range<usize>,
    work: &mut Work<'_>,
) {
    sum::<E, false>(network, tau, inputs, w, reach, work);
}

/// Sums one reach that flows at `w` [kg/s] behind it.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn sum<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    tau: f32,
    inputs: &[f32],
    w: f32,
    reach: core::ops::Range<usize>,
    work: &mut Work<'_>,
) {
    let last = reach.end - 1;
    let (mut ratio, mut inertia, mut sums) = (1.0, 0.0, [0.0f32; 3]);
    every!(few UNROLL, reach.rev(), index => {
        if let (Some(segment), Some(own)) = (network.segments.get(index), work.law.get_mut(index)) {
            if index < last && w > 0.0 {
                ratio *= 1.0 + segment.element.removal();
            }
            let active = segment.element.is_active();
            if active {
                let law = of(segment, inputs, ratio * w);
                *own = [law.resistance, law.linear, law.head];
            }
            // What does not change the compiler knows as well.
            let [resistance, linear, head] = if UNROLL && !active {
                let law = of(segment, &[], 0.0);
                [law.resistance, law.linear, law.head]
            } else {
                *own
            };
            inertia += ratio * (segment.inertance_per_m / tau);
            sums = [sums[0] + ratio * ratio * resistance, sums[1] + ratio * linear, sums[2] + head];
        }
    });
    write(last, sums, work);
    if let Some(own) = work.inertia.get_mut(last) {
        *own = inertia;
    }
}

/// Flow below which all segments of a line are linear, from the line's whole resistance.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn set_laminar(line: &Line, work: &mut Work<'_>) {
    if line.laminar_below_pa > 0.0 {
        let range = super::range(line);
        let laws = work.law.get(range.clone()).unwrap_or(&[]);
        let resistance = laws.iter().fold(0.0, |sum, [resistance, ..]| sum + resistance);
        let laminar = math::sqrt(line.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE));
        for slot in work.laminar.get_mut(range).unwrap_or(&mut []) {
            *slot = laminar;
        }
    }
}

/// Whether the laminar flow of a line follows the direction of its flow: drains make the flows in it differ.
#[inline(always)]
#[allow(clippy::inline_always, reason = "nothing where the compiler knows the line")]
pub(crate) fn is_turned<E: Element>(network: &Network<'_, E>, line: &Line) -> bool {
    let drains = |segment: &Segment<E>| segment.element.removal() > 0.0;
    line.laminar_below_pa > 0.0 && line.segments > 1 && network.segments_of(line).iter().any(drains)
}

/// The same for a run, which knows whether any line is.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one comparison")]
fn turns<E: Element>(network: &Network<'_, E>, line: &Line, work: &Work<'_>) -> bool {
    work.turning.first().is_some_and(|turning| *turning > 0.0) && is_turned(network, line)
}

/// Last segment of the reach that has the flow of a line.
pub(crate) fn flow_place<E>(network: &Network<'_, E>, line: &Line) -> usize {
    let own = super::range(line).skip(line.flow_segment as usize);
    own.into_iter().find(|&index| !continues(&network.plan, index)).unwrap_or(0)
}

/// Laminar flows of a line with drains in one direction. The limit is a pressure lost by the line, ΣR·(m·w)², so with m
/// the ratio of a segment's flow to the line's they are m·√(y/Σm²R).
#[inline(never)]
pub(crate) fn turn_laminar<E: Element>(
    network: &Network<'_, E>,
    line: &Line,
    forward: bool,
    work: &mut Work<'_>,
) {
    let first = line.first_segment as usize;
    let ratio_of = |ratio: f32| if forward { ratio } else { 1.0 };
    let mut resistance = 0.0;
    flow_ratios(network, line, |place, _, ratio| {
        let ratio = ratio_of(ratio);
        let [own, ..] = work.law.get(first + place).copied().unwrap_or([0.0; 3]);
        resistance += ratio * ratio * own;
    });
    let laminar = math::sqrt(line.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE));
    flow_ratios(network, line, |place, _, ratio| {
        if let Some(own) = work.laminar.get_mut(first + place) {
            *own = ratio_of(ratio) * laminar;
        }
    });
}
