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

/// Fixed data of a segment: I/τ [Pa·s/kg], C/τ of the volume behind it [kg/(s·Pa)], removal s [1].
pub(crate) type Fixed = [f32; 3];
/// Law of a segment in this stage: R, L, head.
pub(crate) type SegmentLaw = [f32; 3];
/// What the back substitution needs of a segment: b, q, α, γ, κ.
pub(crate) type Swept = [f32; 5];

/// Columns of one line's segments, all of equal length.
pub(crate) struct Columns<'c> {
    pub(crate) fixed: &'c [Fixed],
    pub(crate) law: &'c [SegmentLaw],
    /// Flow at the step's start and its carry [kg/s].
    pub(crate) flow: &'c [[f32; 2]],
    /// Gauge pressure behind the segment at the step's start and its carry [Pa].
    pub(crate) gauge: &'c [[f32; 2]],
    /// Known part of the momentum and of the mass balance of this stage.
    pub(crate) known: &'c [[f32; 2]],
    /// Present iterate: increment of the flow and of the pressure behind the segment.
    pub(crate) delta: &'c [[f32; 2]],
    pub(crate) swept: &'c mut [Swept],
}

/// Pressure of a node at the step's start and its present increment [Pa].
#[derive(Clone, Copy)]
pub(crate) struct NodePressure {
    pub(crate) start: f32,
    pub(crate) delta: f32,
}

/// A line's flows as functions of its nodes' increments:
/// in = `inlet + inlet_own·δp_from − inlet_other·δp_to`, out likewise with the signs of an outlet.
#[derive(Clone, Copy, Default)]
pub(crate) struct Admittance {
    pub(crate) inlet: f32,
    pub(crate) outlet: f32,
    /// Held by the line's own volumes: inlet and outlet.
    pub(crate) inlet_held: f32,
    pub(crate) outlet_held: f32,
    /// Passed through: effect of δp_to on the inlet, and of δp_from on the outlet.
    pub(crate) inlet_through: f32,
    pub(crate) outlet_through: f32,
}

/// Pressure loss of a law at flow `w`, linear below `laminar` [kg/s].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over segments")]
pub(crate) fn loss(&[quadratic, linear, _]: &SegmentLaw, w: f32, laminar: f32) -> f32 {
    quadratic * w * math::larger(w.abs(), laminar) + linear * w
}

/// Sweeps a line from inlet to outlet around the present iterate.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(crate) fn sweep(
    columns: &mut Columns<'_>,
    from: NodePressure,
    to: NodePressure,
    laminar: f32,
) -> Admittance {
    let last = columns.fixed.len().saturating_sub(1);
    let mut result = Admittance::default();
    // Upstream of the present segment: its pressure, b, flow and q, capacity and removal of the volume there.
    let mut upstream = from;
    let (mut b_before, mut w_before, mut q_before) = (0.0, 0.0, 0.0);
    let (mut capacity, mut removal, mut mass_known) = (0.0, 0.0, 0.0);
    // α, κ and ζ = 1 − κ − γ of the volume before; P, Q and Z of δp_0 = P + (1 − Q − Z)·δp_from + Q·δp_j.
    let (mut alpha, mut kappa, mut zeta) = (0.0, 1.0, 0.0);
    let (mut first_b, mut start, mut through, mut held) = (0.0, 0.0, 1.0, 0.0);
    let rows = columns.fixed.iter().zip(columns.law).zip(columns.flow).zip(columns.gauge).zip(columns.known);
    let rows = rows.zip(columns.delta.iter()).zip(columns.swept.iter_mut()).enumerate();
    for (index, ((((((fixed, law), [w, _]), [p, _]), known), [dw, dp]), swept)) in rows {
        let [inertia, own_capacity, own_removal] = *fixed;
        let [momentum_known, own_mass_known] = *known;
        let downstream = if index == last { to } else { NodePressure { start: *p, delta: *dp } };
        let (b, q) = {
            let [quadratic, linear, head] = *law;
            let push = momentum_known + (upstream.start - downstream.start) + head;
            // Flow that the present pressures would drive, solved exactly: the slope is taken at the larger of
            // this and the present flow, because a tangent near zero flow overshoots without bound.
            let total = push + (upstream.delta - downstream.delta) + inertia * w;
            let resisting = inertia + linear;
            let driven = 2.0 * total
                / (resisting + math::sqrt(resisting * resisting + 4.0 * (quadratic * total.abs())));
            let present = w + dw;
            let size = math::larger(math::larger(present.abs(), driven.abs()), 0.5 * laminar);
            let slope = 2.0 * quadratic * size + linear;
            let b = 1.0 / (inertia + slope);
            (b, b * (push - loss(law, present, laminar) + slope * dw))
        };
        let mut gamma = 0.0;
        if index == 0 {
            first_b = b;
            result.inlet = w + q;
        } else {
            let leaves = if w + dw > 0.0 { 1.0 + removal } else { 1.0 };
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
        *swept = [b, q, alpha, gamma, kappa];
        upstream = downstream;
        (b_before, w_before, q_before) = (b, *w, q);
        (capacity, removal, mass_known) = (own_capacity, own_removal, own_mass_known);
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
pub(crate) fn substitute(delta: &mut [[f32; 2]], swept: &[Swept], from: f32, to: f32) {
    let mut downstream = to;
    for (index, (delta, &[b, q, alpha, gamma, kappa])) in delta.iter_mut().zip(swept).enumerate().rev() {
        // A segment's coefficients belong to the pressure before it, which is the one behind its neighbour.
        let upstream = if index == 0 { from } else { alpha + gamma * downstream + kappa * from };
        *delta = [q + b * (upstream - downstream), downstream];
        downstream = upstream;
    }
}
