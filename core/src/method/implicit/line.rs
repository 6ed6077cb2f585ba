//! One line in an implicit stage: its interior unknowns are eliminated before the nodes' are.
//!
//! Unknowns are increments since the step's start. For segment i between pressures i−1 and i
//!
//! ```text
//! δw_i = q_i + b_i·(δp_{i−1} − δp_i)      b = 1/(I/τ + slope)
//! (C_j/τ)·δp_j = B_j + (w_j + δw_j) − U_j·(w_{j+1} + δw_{j+1})
//! ```
//!
//! The second, with the first put in, is tridiagonal. One sweep from inlet to outlet writes
//! `δp_j = α_j + γ_j·δp_{j+1} + κ_j·δp_from` with every coefficient a sum of positive terms, so that nothing
//! cancels, however nearly closed a valve is. What is left of the line is two flows that depend linearly on
//! the pressures of its two nodes.

use crate::math;

/// Number of figures of a segment.
pub(crate) const CELL: usize = 20;

/// Figures of a segment and of the pressure behind it: I/τ [Pa·s/kg]; C/τ of the volume behind [kg/(s·Pa)];
/// removal [1]; 1 where the slope needs its guard, else 0; R, L and head of the law in this stage; known part of
/// the momentum [Pa], from [`push`] on with head and pressure difference of the step's start in it; known part
/// of the mass balance [kg/s]; flow [kg/s] and pressure behind [Pa gauge] at the step's
/// start; their increments in the present iterate; the flow's increment in the first stage; rise of pressure per
/// mass [Pa/kg]; b, q, α, γ, κ of the sweep.
pub(crate) type Cell = [f32; CELL];

/// A line's flows as functions of its nodes' increments: in = `inlet + (held + through)·δp_from −
/// through·δp_to` with the inlet's parts, out likewise with the outlet's and the signs of an outlet.
#[derive(Clone, Copy, Default)]
pub(crate) struct Admittance {
    pub(crate) inlet: f32,
    pub(crate) outlet: f32,
    /// Held by the line's own volumes: at the inlet and at the outlet.
    pub(crate) inlet_held: f32,
    pub(crate) outlet_held: f32,
    /// Passed through: effect of `δp_to` on the inlet, and of `δp_from` on the outlet.
    pub(crate) inlet_through: f32,
    pub(crate) outlet_through: f32,
}

/// The larger of the two, where there is a laminar range at all.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over segments")]
fn at_least(size: f32, laminar: f32) -> f32 {
    if laminar > 0.0 { math::larger(size, laminar) } else { size }
}

/// Pressure loss at flow `w`, linear below `laminar` [kg/s].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over segments")]
fn loss(quadratic: f32, linear: f32, w: f32, laminar: f32) -> f32 {
    quadratic * w * at_least(w.abs(), laminar) + linear * w
}

/// Slope dΔp/dw at which a segment is linearised.
///
/// A tangent near zero flow overshoots without bound where inertance does not hold the flow back. There the
/// slope is taken at the larger of the present flow and of the flow that the present pressures would drive.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over segments")]
fn slope(cell: &Cell, present: f32, driving: f32, laminar: f32) -> f32 {
    let &[inertia, _, _, guarded, quadratic, linear, ..] = cell;
    let mut size = at_least(present.abs(), 0.5 * laminar);
    if guarded > 0.0 {
        let (total, resisting) = (driving.abs(), inertia + linear);
        let root = math::sqrt(resisting * resisting + 4.0 * quadratic * total);
        // Nothing drives and nothing resists: 0/0, for which the present flow stands.
        size = math::larger(2.0 * total / (resisting + root), size);
    }
    2.0 * quadratic * size + linear
}

/// Adds to the known part of every momentum what does not change within a stage: head, and the pressures of the
/// step's start, of which the last cell's is the outlet node's and `from` the inlet node's [Pa gauge].
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(crate) fn push(cells: &mut [Cell], from: f32) {
    let mut upstream = from;
    for cell in cells {
        let [_, _, _, _, _, _, head, momentum, _, _, p, ..] = cell;
        *momentum += (upstream - *p) + *head;
        upstream = *p;
    }
}

/// Sweeps a line from inlet to outlet around the present iterate; `from` is the inlet node's increment and the
/// last cell's the outlet node's [Pa].
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(crate) fn sweep(cells: &mut [Cell], from: f32, laminar: f32) -> Admittance {
    let mut result = Admittance::default();
    // Upstream of the present segment: its pressure, b, flow and q, capacity and removal of the volume there.
    let mut dp_before = from;
    let (mut b_before, mut w_before, mut q_before) = (0.0, 0.0, 0.0);
    let (mut capacity, mut removal, mut mass_known) = (0.0, 0.0, 0.0);
    // α, κ and ζ = 1 − κ − γ of the volume before; P, Q and Z of δp_0 = P + (1 − Q − Z)·δp_from + Q·δp_j.
    let (mut alpha, mut kappa, mut zeta) = (0.0, 1.0, 0.0);
    let (mut start, mut through, mut held) = (0.0, 1.0, 0.0);
    let mut first_b = 0.0;
    for (index, cell) in cells.iter_mut().enumerate() {
        let [inertia, own_capacity, own_removal, _, quadratic, linear, _, pushed, mass, w, _, dw, dp, ..] =
            *cell;
        let present = w + dw;
        let slope = slope(cell, present, pushed + (dp_before - dp) + inertia * w, laminar);
        let b = 1.0 / (inertia + slope);
        let q = b * (pushed - loss(quadratic, linear, present, laminar) + slope * dw);
        let mut gamma = 0.0;
        if index == 0 {
            first_b = b;
            result.inlet = w + q;
        } else {
            let leaves = if present > 0.0 { 1.0 + removal } else { 1.0 };
            let residual = mass_known + (w_before - leaves * w) + (q_before - leaves * q);
            let pivot = 1.0 / (capacity + b_before * (kappa + zeta) + leaves * b);
            alpha = (residual + b_before * alpha) * pivot;
            zeta = (capacity + b_before * zeta) * pivot;
            kappa = b_before * kappa * pivot;
            gamma = leaves * b * pivot;
            start += through * alpha;
            held += through * zeta;
            through *= gamma;
        }
        let [.., cell_b, cell_q, cell_alpha, cell_gamma, cell_kappa] = cell;
        (*cell_b, *cell_q, *cell_alpha, *cell_gamma, *cell_kappa) = (b, q, alpha, gamma, kappa);
        dp_before = dp;
        (b_before, w_before, q_before) = (b, w, q);
        (capacity, removal, mass_known) = (own_capacity, own_removal, mass);
    }
    result.inlet -= first_b * start;
    result.inlet_held = first_b * held;
    result.inlet_through = first_b * through;
    result.outlet = w_before + q_before + b_before * alpha;
    result.outlet_held = b_before * zeta;
    result.outlet_through = b_before * kappa;
    result
}

/// Sets the line's iterate from the nodes' increments, from outlet to inlet.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(crate) fn substitute(cells: &mut [Cell], from: f32, to: f32) {
    let mut downstream = to;
    for (index, cell) in cells.iter_mut().enumerate().rev() {
        let [.., b, q, alpha, gamma, kappa] = *cell;
        // A segment's coefficients belong to the pressure before it, which is the one behind its neighbour.
        let upstream = if index == 0 { from } else { alpha + gamma * downstream + kappa * from };
        let [_, _, _, _, _, _, _, _, _, _, _, dw, dp, ..] = cell;
        (*dw, *dp) = (q + b * (upstream - downstream), downstream);
        downstream = upstream;
    }
}

/// Whether some joint of the line stores so little that noise in its pressure could outweigh its mass balance.
pub(crate) fn has_stiff_joint(cells: &[Cell]) -> bool {
    cells.array_windows().any(|[[before, capacity, ..], [behind, ..]]| {
        let inertia = if before < behind { before } else { behind };
        capacity * inertia < 1.0
    })
}

/// Index of the segment that resists most, by the last sweep.
fn anchor(cells: &[Cell]) -> usize {
    let mut found = (0, f32::INFINITY);
    for (index, &[.., b, _, _, _, _]) in cells.iter().enumerate() {
        if b < found.1 {
            found = (index, b);
        }
    }
    found.0
}

/// Puts the pressure of joints without volume where the losses of segments without inertance between them and
/// their node say, on either side of the segment that resists most: such a pressure has no memory, and what the
/// rounding of many steps left in it would be noise.
pub(crate) fn rebase(cells: &mut [Cell], from: f32, laminar: f32) {
    let Some((upstream, downstream)) = cells.split_at_mut_checked(anchor(cells)) else { return };
    let mut before = from;
    for cell in upstream {
        let [inertia, capacity, _, _, quadratic, linear, head, _, _, w, p, ..] = *cell;
        let free = inertia <= 0.0 && capacity <= 0.0;
        before = if free { before - loss(quadratic, linear, w, laminar) + head } else { p };
        cell[10] = before;
    }
    let mut rest = downstream;
    while let Some((cell, before)) = rest.split_last_mut() {
        let [inertia, _, _, _, quadratic, linear, head, _, _, w, p, ..] = *cell;
        if let Some([_, capacity, _, _, _, _, _, _, _, _, joint, ..]) = before.last_mut()
            && inertia <= 0.0
            && *capacity <= 0.0
        {
            *joint = p + loss(quadratic, linear, w, laminar) - head;
        }
        rest = before;
    }
}

/// Makes flows of neighbours agree where the joint between them stores next to nothing.
///
/// There `b·(δp − δp)` is the small difference of two rounded pressures times a large number. The flow of the
/// segment that resists most is taken as it is, and the others follow from it by the joints' mass balances, as
/// long as their own b is the larger source of noise.
pub(crate) fn settle(cells: &mut [Cell]) {
    let Some((upstream, downstream)) = cells.split_at_mut_checked(anchor(cells)) else { return };
    let Some((anchor, downstream)) = downstream.split_first_mut() else { return };
    let mut before = *anchor;
    for cell in downstream {
        let [_, capacity, removal, _, _, _, _, _, known, w_before, _, dw_before, dp_before, ..] = before;
        let [.., b, _, _, _, _] = *cell;
        if b > capacity {
            let arrives = known + w_before + dw_before - capacity * dp_before;
            let leaves = if arrives > 0.0 { arrives / (1.0 + removal) } else { arrives };
            cell[11] = leaves - cell[9];
        }
        before = *cell;
    }
    let mut behind = *anchor;
    for cell in upstream.iter_mut().rev() {
        let [_, _, _, _, _, _, _, _, _, w_behind, _, dw_behind, ..] = behind;
        let [_, capacity, removal, _, _, _, _, _, known, w, _, _, dp, ..] = *cell;
        let [.., b, _, _, _, _] = *cell;
        if b > capacity {
            let flow = w_behind + dw_behind;
            let leaves = if flow > 0.0 { (1.0 + removal) * flow } else { flow };
            cell[11] = leaves + capacity * dp - known - w;
        }
        behind = *cell;
    }
}

/// Rates of change at the step's start as the known parts of a trapezoidal stage; returns the flows at inlet
/// and outlet [kg/s].
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(crate) fn rates(cells: &mut [Cell], from: f32, laminar: f32) -> (f32, f32) {
    let mut before: Option<&mut Cell> = None;
    let (mut upstream, mut inlet) = (from, 0.0);
    for cell in cells {
        let [inertia, _, _, _, quadratic, linear, head, _, _, w, p, ..] = *cell;
        let rate = (upstream - p) + head - loss(quadratic, linear, w, laminar);
        cell[7] = if inertia > 0.0 { rate } else { 0.0 };
        match before {
            Some(before) => {
                let [_, capacity, removal, _, _, _, _, _, mass, inflow, ..] = before;
                let leaves = if w > 0.0 { (1.0 + *removal) * w } else { w };
                *mass = if *capacity > 0.0 { *inflow - leaves } else { 0.0 };
            }
            None => inlet = w,
        }
        upstream = p;
        before = Some(cell);
    }
    let outlet = before.map_or(0.0, |last| {
        let [_, _, removal, _, _, _, _, _, _, w, ..] = *last;
        if w > 0.0 { w / (1.0 + removal) } else { w }
    });
    (inlet, outlet)
}

/// What one step of one line moved [kg], and whether a flow left its range.
#[derive(Clone, Copy, Default)]
pub(crate) struct Moved {
    pub(crate) taken: f32,
    pub(crate) given: f32,
    pub(crate) drained: f32,
    pub(crate) beyond: bool,
}

/// Takes the last stage's increments over and moves masses by the mean flows of the step.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(crate) fn commit(
    cells: &[Cell],
    states: &mut [[f32; 4]],
    h: f32,
    weights: [f32; 2],
    limit: f32,
) -> Moved {
    let mut moved = Moved::default();
    let mut carried = 0.0;
    // The volume before the present segment.
    let mut before: Option<(&mut [f32; 4], &Cell)> = None;
    for (cell, state) in cells.iter().zip(states) {
        let [_, _, _, _, _, _, _, _, _, w, _, dw, _, first, ..] = *cell;
        let mut passed = h * (w + (weights[0] * first + weights[1] * dw));
        let [flow, flow_carry, ..] = state;
        math::compensated_add(flow, flow_carry, dw);
        moved.beyond |= math::beyond(*flow, limit);
        match before {
            None => moved.taken = passed,
            Some(([_, _, pressure, carry], volume)) => {
                let [_, capacity, removal, _, _, _, _, _, _, _, start, _, solved, _, rise, ..] = *volume;
                let leaving = if removal > 0.0 { removal * h * forward_mean(cell, weights) } else { 0.0 };
                moved.drained += leaving;
                if capacity > 0.0 {
                    math::compensated_add(pressure, carry, ((carried - passed) - leaving) * rise);
                } else {
                    // Nothing can be stored here, so what came in and was not drained is what goes on.
                    passed = carried - leaving;
                    (*pressure, *carry) = (start + solved, 0.0);
                }
            }
        }
        carried = passed;
        before = Some((state, cell));
    }
    if let Some((_, cell)) = before {
        let removal = cell[2];
        if removal > 0.0 {
            let leaving = removal / (1.0 + removal) * (h * forward_mean(cell, weights));
            moved.drained += leaving;
            carried -= leaving;
        }
    }
    moved.given = carried;
    moved
}

/// Mean of a segment's flow over the step where it runs forward [kg/s], stage by stage as it was solved: a drain
/// takes nothing from reversed flow.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over segments")]
fn forward_mean(cell: &Cell, weights: [f32; 2]) -> f32 {
    let [_, _, _, _, _, _, _, _, _, w, _, dw, _, first, ..] = *cell;
    let forward = |flow: f32| if flow > 0.0 { flow } else { 0.0 };
    weights[0] * (forward(w) + forward(w + first)) + weights[1] * forward(w + dw)
}
