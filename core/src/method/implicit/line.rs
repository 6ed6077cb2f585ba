//! One line of several segments: its interior unknowns are eliminated before the nodes' are.
//!
//! Unknowns are the corrections c of the pressures, added to their increments δp since the step's start. For reach i
//! between pressures i−1 and i, and the volume j behind it,
//!
//! ```text
//! δw_i = q_i + b_i·(c_{i−1} − c_i)
//! (C_j/τ)·c_j = B_j − (C_j/τ)·δp_j + (w_j + δw_j) − U_j·(w_{j+1} + δw_{j+1})
//! ```
//!
//! The second, with the first put in, is tridiagonal. One sweep from inlet to outlet writes
//! `c_j = α_j + γ_j·c_{j+1} + κ_j·c_from` with every coefficient a sum of positive terms, so that nothing
//! cancels, however nearly closed a valve is. What is left of the line are two ports: flows that depend linearly on
//! the pressures of its two nodes.

use super::layout::{Port, State, Work, at, continues};
use super::range;
use crate::component::Element;
use crate::{Line, Network, math};

/// What a line has at its two nodes: the ports, and what its own volumes hold there [kg/(s·Pa)].
#[derive(Clone, Copy)]
struct Admittance {
    inlet: Port,
    outlet: Port,
    inlet_held: f32,
    outlet_held: f32,
}

/// Notes the flows of the iterate wherever one decides whether a drain acts: the flow at the `START` of a step, later
/// what the last solve made of it. They stand where the last sweep's κ is no longer needed.
///
/// The flow of the linearisation at unmoved pressures is none of these: in a line without inertance a rounding of a
/// small volume's pressure turns it.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn direct<E: Element, const START: bool>(
    network: &Network<'_, E>,
    flow: &[f32],
    work: &mut Work<'_>,
) {
    for line in network.plan.composite.iter().filter_map(|&index| network.lines.get(index as usize)) {
        // As in the sweep: from the volume ahead of a reach, or behind the line's last element.
        let mut drains = false;
        let range = range(line);
        for index in range.clone() {
            let removes = network.segments.get(index).is_some_and(|segment| segment.element.removal() > 0.0);
            if continues(&network.plan, index) {
                drains |= removes;
                continue;
            }
            let decides = drains || (removes && index + 1 == range.end);
            drains = removes;
            if !decides {
                continue;
            }
            let (place, [b, _]) = (index as u32, work.ports.get(index).copied().unwrap_or([0.0; 2]));
            let moved = if START { 0.0 } else { at(work.q, place) + b * at(work.differ, place) };
            if let Some([.., present]) = work.joints.get_mut(index) {
                *present = at(flow, place) + moved;
            }
        }
    }
}

/// Eliminates the interior of all lines of several segments, and writes their ports. A drain acts by the direction
/// of the iterate's flow.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn sweep<E: Element>(network: &Network<'_, E>, work: &mut Work<'_>) {
    for &index in network.plan.composite {
        if let Some(line) = network.lines.get(index as usize) {
            for node in [line.from as usize, line.to as usize] {
                if let (Some(excess), Some(capacity)) = (work.excess.get_mut(node), work.capacity.get(node)) {
                    *excess = *capacity;
                }
            }
        }
    }
    for (place, &index) in network.plan.composite.iter().enumerate() {
        let Some(line) = network.lines.get(index as usize) else { continue };
        let admittance = eliminate(network, line, work);
        for (node, held) in [(line.from, admittance.inlet_held), (line.to, admittance.outlet_held)] {
            if let Some(excess) = work.excess.get_mut(node as usize) {
                *excess += held;
            }
        }
        let first = network.segments.len() + 2 * place;
        if let Some([inlet, outlet]) = work.ports.get_mut(first..first + 2) {
            (*inlet, *outlet) = (admittance.inlet, admittance.outlet);
        }
    }
}

/// Sweeps a line from inlet to outlet.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
fn eliminate<E: Element>(network: &Network<'_, E>, line: &Line, work: &mut Work<'_>) -> Admittance {
    // Upstream of the present reach: b and flow there; capacity and known part of the volume between.
    let ([mut b_before, mut f_before], [mut capacity, mut known]): (Port, [f32; 2]) = ([0.0; 2], [0.0; 2]);
    // α, κ and ζ = 1 − κ − γ of the volume before; P, Q and Z of c_0 = P + (1 − Q − Z)·c_from + Q·c_j.
    let (mut alpha, mut kappa, mut zeta) = (0.0, 1.0, 0.0);
    let (mut start, mut through, mut held) = (0.0, 1.0, 0.0);
    let mut inlet: Option<(f32, Port)> = None;
    // Ratio of the flow behind the volume before to that of the present reach, when forward.
    let mut ratio = 1.0f32;
    let mut before = 0;
    let (mut removal, mut forward) = (0.0, false);
    for index in range(line) {
        removal = network.segments.get(index).map_or(0.0, |segment| segment.element.removal());
        if continues(&network.plan, index) {
            ratio *= 1.0 + removal;
            continue;
        }
        let [b, f] = work.ports.get(index).copied().unwrap_or([0.0; 2]);
        // Said this way, a line that drains nothing is known not to when the network is compiled in.
        forward = ratio > 1.0 || removal > 0.0;
        forward = forward && work.joints.get(index).is_some_and(|[.., present]| *present > 0.0);
        let leaves = if ratio > 1.0 && forward { ratio } else { 1.0 };
        if inlet.is_none() {
            inlet = Some((leaves, [b, f]));
        } else {
            let residual = known + (f_before - leaves * f);
            let behind = leaves * b;
            let (kept, passed) = (capacity + b_before * zeta, b_before * kappa);
            let share = 1.0 / (kept + passed + behind);
            alpha = (residual + b_before * alpha) * share;
            (zeta, kappa) = (kept * share, passed * share);
            let gamma = behind * share;
            start += through * alpha;
            held += through * zeta;
            through *= gamma;
            if let Some([_, _, _, own_alpha, own_gamma, own_kappa]) = work.joints.get_mut(before) {
                (*own_alpha, *own_gamma, *own_kappa) = (alpha, gamma, kappa);
            }
        }
        if let Some([own_capacity, _, own_known, ..]) = work.joints.get(index) {
            (capacity, known) = (*own_capacity, *own_known);
        }
        (b_before, f_before) = (b, f);
        ratio = 1.0 + removal;
        before = index;
    }
    // What a drain at the last element takes never reaches the outlet node.
    let arrives = if removal > 0.0 && forward { 1.0 / (1.0 + removal) } else { 1.0 };
    let (leaves, [b, f]) = inlet.unwrap_or((1.0, [0.0; 2]));
    let (into, out) = (leaves * b, arrives * b_before);
    Admittance {
        inlet: [into * through, leaves * f - into * start],
        outlet: [out * kappa, arrives * f_before + out * alpha],
        inlet_held: into * held,
        outlet_held: out * zeta,
    }
}

/// Corrects the interior pressures after the nodes', from outlet to inlet. Behind the `START` of a step they had no
/// increments.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn substitute<E: Element, const START: bool>(network: &Network<'_, E>, work: &mut Work<'_>) {
    let nodes = network.nodes.len();
    for &index in network.plan.composite {
        let Some(line) = network.lines.get(index as usize) else { continue };
        let (from, mut behind) = (at(work.change, line.from), at(work.change, line.to));
        // The last segment's volume is its node.
        for joint in range(line).rev().skip(1) {
            if continues(&network.plan, joint) {
                continue;
            }
            if let (Some([capacity, _, known, alpha, gamma, kappa]), Some(delta), Some(change)) = (
                work.joints.get_mut(joint),
                work.delta.get_mut(nodes + joint),
                work.change.get_mut(nodes + joint),
            ) {
                behind = *alpha + *gamma * behind + *kappa * from;
                *change = behind;
                *delta = if START { behind } else { *delta + behind };
                *known -= *capacity * behind;
            }
        }
    }
}

/// Known parts of the interior balances at the step's start: none.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn forget<E>(network: &Network<'_, E>, work: &mut Work<'_>) {
    for line in network.plan.composite.iter().filter_map(|&index| network.lines.get(index as usize)) {
        for [_, _, known, ..] in work.joints.get_mut(range(line)).unwrap_or(&mut []) {
            *known = 0.0;
        }
    }
}

/// Known parts of the interior balances in the BDF2 stage, which starts where the first stage ended: a share of the
/// first stage's increments, less what they hold.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn carry_over<E>(network: &Network<'_, E>, work: &mut Work<'_>) {
    let increments = work.delta.get(network.nodes.len()..).unwrap_or(&[]);
    for line in network.plan.composite.iter().filter_map(|&index| network.lines.get(index as usize)) {
        let joints = work.joints.get_mut(range(line)).unwrap_or(&mut []);
        for ([capacity, _, known, ..], delta) in
            joints.iter_mut().zip(increments.get(range(line)).unwrap_or(&[]))
        {
            *known = (super::CARRY_OVER - 1.0) * *capacity * delta;
        }
    }
}

/// Moves masses through the lines of several segments by the mean flows of the step; writes their ports and books what
/// was drained. `increments` are the step's.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn transfer<E: Element>(
    network: &Network<'_, E>,
    h: f32,
    weights: [f32; 2],
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    for (place, &index) in network.plan.composite.iter().enumerate() {
        let Some(line) = network.lines.get(index as usize) else { continue };
        let (mut taken, mut carried, mut drained) = (None, 0.0, 0.0);
        let range = range(line);
        let (mut first, past) = (range.start, range.end);
        let mut removal_before = 0.0;
        for last in range {
            if continues(&network.plan, last) {
                continue;
            }
            let through = at(work.passed, last as u32);
            let forward = || h * forward_mean(last, weights, state.flow, work);
            let (mut inlet, mut ratio) = (through, 1.0);
            for joint in (first..last).rev() {
                let removal = network.segments.get(joint).map_or(0.0, |segment| segment.element.removal());
                if removal > 0.0 {
                    let leaving = removal * (ratio * forward());
                    inlet += leaving;
                    drained += leaving;
                    ratio *= 1.0 + removal;
                }
            }
            if taken.is_none() {
                taken = Some(inlet);
            } else {
                let leaving = if removal_before > 0.0 { removal_before * (ratio * forward()) } else { 0.0 };
                drained += leaving;
                let stored = (carried - inlet) - leaving;
                if let (Some(mass), Some(carry)) =
                    (state.mass.get_mut(first - 1), state.mass_carry.get_mut(first - 1))
                {
                    math::compensated_add(mass, carry, stored);
                }
            }
            carried = through;
            let removal = network.segments.get(last).map_or(0.0, |segment| segment.element.removal());
            if last + 1 == past && removal > 0.0 {
                let leaving = removal / (1.0 + removal) * forward();
                drained += leaving;
                carried -= leaving;
            }
            removal_before = removal;
            first = last + 1;
        }
        let port = network.segments.len() + 2 * place;
        if let Some([inlet, outlet]) = work.passed.get_mut(port..port + 2) {
            (*inlet, *outlet) = (taken.unwrap_or(0.0), carried);
        }
        if let Some([_, _, _, _, sum, carry]) = state.common.lines.get_mut(index as usize) {
            math::compensated_add(sum, carry, drained);
        }
    }
}

/// Sets the interior pressures of a line from its masses.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
pub(crate) fn settle<E>(network: &Network<'_, E>, line: &Line, mass: &[f32], work: &mut Work<'_>) {
    let nodes = network.nodes.len();
    let start = network.nodes.get(line.from as usize).map_or(0.0, |node| node.start_gauge_pa);
    for joint in range(line).rev().skip(1) {
        if let (Some([_, rise, ..]), Some(pressure)) =
            (work.joints.get(joint), work.pressure.get_mut(nodes + joint))
        {
            *pressure = start + rise * at(mass, joint as u32);
        }
    }
}

/// Mean of a reach's flow over the step where it runs forward [kg/s], stage by stage as it was solved: a drain
/// takes nothing from reversed flow.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over segments")]
fn forward_mean(index: usize, weights: [f32; 2], flow: &[f32], work: &Work<'_>) -> f32 {
    let index = index as u32;
    let (w, first, dw) = (at(flow, index), at(work.first, index), at(work.q, index));
    let forward = |flow: f32| if flow > 0.0 { flow } else { 0.0 };
    weights[0] * forward(w + first) + weights[1] * forward(w + dw)
}
