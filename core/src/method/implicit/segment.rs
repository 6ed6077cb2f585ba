//! One pass over all segments: linearisation of their momentum around the present iterate.
//!
//! ```text
//! δw = q + b·(c_before − c_behind)      b = 1/(I/τ + slope)      q = δw + b·(what is out of balance)
//! ```
//!
//! with the corrections c of the pressures, and δw on the right that of the iterate.
//!
//! Every pass walks plain columns of figures from one end to the other, so that a host takes several at once.

use super::law;
use super::layout::{self, Port, at};
use super::{CARRY_OVER, EXPECTED_DRIVE_PA};
use crate::component::Element;
use crate::method::responsive;
use crate::unroll::every;
use crate::{Network, math};

/// Momentum law of a reach in one stage: I/τ, R, L, laminar flow, and whether its slope needs the guard.
#[derive(Clone, Copy)]
struct Momentum {
    inertia: f32,
    quadratic: f32,
    linear: f32,
    laminar: f32,
    guarded: bool,
    known: Known,
}

impl Momentum {
    /// Pressure loss at flow `w`, linear below the laminar flow [Pa].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over segments")]
    fn loss(self, w: f32) -> f32 {
        let loss = self.quadratic * w * self.at_least(w.abs(), self.laminar);
        if self.known.quadratic { loss } else { loss + self.linear * w }
    }

    /// The larger of the two, where there is a laminar range at all.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over segments")]
    fn at_least(self, size: f32, laminar: f32) -> f32 {
        if self.laminar > 0.0 { math::larger(size, laminar) } else { size }
    }

    /// b and q around the increment `dw` of flow `w` where `acts` [Pa], pressures and what else pushes.
    ///
    /// A tangent near zero flow overshoots without bound where inertance does not hold the flow back. There the slope is that of
    /// the chord between the present flow and the flow that the present pressures would drive, and never less than the
    /// tangent's at the present one: from rest one solve finds the whole driven flow, and pressures stay between those that
    /// drive. A present flow far above the driven one, a valve having shut on it, would not be brought down by two solves: the
    /// law is linearised around the driven flow instead, with the slope that it has at the present one.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over segments")]
    fn linearise(self, w: f32, dw: f32, acts: f32) -> (f32, f32) {
        let (mut present, mut dw) = (w + dw, dw);
        let mut size = self.at_least(present.abs(), 0.5 * self.laminar);
        if self.guarded {
            let drive = acts + self.inertia * w;
            let total = drive.abs();
            let resisting = if self.known.quadratic { self.inertia } else { self.inertia + self.linear };
            let root = math::sqrt(resisting * resisting + 4.0 * self.quadratic * total);
            // Nothing drives and nothing resists: 0·∞, for which the present flow stands.
            let per_pressure = 2.0 / (resisting + root);
            let driven = drive * per_pressure;
            let wild = present.abs() > (MOST_DRIVEN * per_pressure) * (total + EXPECTED_DRIVE_PA);
            size = math::larger(0.5 * (driven.abs() + present.abs()), size);
            (present, dw) = if wild { (driven, driven - w) } else { (present, dw) };
        }
        let slope = 2.0 * self.quadratic * size;
        let slope = if self.known.quadratic { slope } else { slope + self.linear };
        let b = 1.0 / (self.inertia + slope);
        (b, dw + b * ((acts - self.inertia * dw) - self.loss(present)))
    }
}

/// Largest flow around which a guarded reach is linearised, over the flow that the present pressures and
/// [`EXPECTED_DRIVE_PA`] would drive [1]: two Newton steps of a square law quarter a flow.
const MOST_DRIVEN: f32 = 4.0;

/// What a step that is specialised knows of every segment.
#[derive(Clone, Copy)]
struct Known {
    /// The law has no linear part.
    quadratic: bool,
    /// Its line has no laminar range.
    turbulent: bool,
    /// Whether the slope needs the guard.
    guarded: Option<bool>,
}

/// Nothing is known.
const UNKNOWN: Known = Known { quadratic: false, turbulent: false, guarded: None };

/// Whether the slope of a reach needs its guard: its law changes, and may become as stiff as it likes within one
/// step, or the expected pressure would drive its flow against friction rather than against inertance.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn needs_guard(active: bool, inertia: f32, quadratic: f32) -> bool {
    active || inertia * inertia < 4.0 * quadratic * EXPECTED_DRIVE_PA
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn known<E: Element, const UNROLL: bool>(network: &Network<'_, E>, tau: f32, index: usize) -> Known {
    if !UNROLL || responsive::has_segment(network, index) {
        return UNKNOWN;
    }
    let Some(segment) = network.segments.get(index) else {
        return UNKNOWN;
    };
    let turbulent =
        network.lines.iter().all(|line| line.laminar_below_pa <= 0.0 || !super::range(line).contains(&index));
    let mut quadratic = !segment.element.is_active() || !segment.element.may_be_linear();
    if layout::is_joined(&network.plan, index) {
        let mut before = index;
        while before > 0 && layout::continues(&network.plan, before - 1) {
            before -= 1;
            let own = network.segments.get(before);
            quadratic &= own.is_some_and(|own| !own.element.is_active() || !own.element.may_be_linear());
        }
        return Known { quadratic, turbulent, guarded: Some(true) };
    }
    let active = segment.element.is_active();
    let resistance = if active { 0.0 } else { law::of(segment, &[], 0.0).resistance };
    let guarded = needs_guard(active, segment.inertance_per_m / tau, resistance);
    Known { quadratic, turbulent, guarded: Some(guarded) }
}

impl Known {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over segments")]
    fn momentum(self, [inertia, quadratic, linear, laminar, guarded]: [f32; 5]) -> Momentum {
        Momentum {
            inertia,
            quadratic,
            linear,
            laminar: if self.turbulent { 0.0 } else { laminar },
            guarded: self.guarded.unwrap_or(guarded > 0.0),
            known: self,
        }
    }
}

/// Differences between the two points of every segment.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn differences<E>(network: &Network<'_, E>, points: &[f32], out: &mut [f32]) {
    for (out, [before, behind]) in out.iter_mut().zip(network.plan.between) {
        *out = at(points, *before) - at(points, *behind);
    }
}

/// Columns that a pass reads: I/τ, R, L, laminar flow, guard, and the flow at the step's start.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'c> {
    pub(crate) inertia: &'c [f32],
    pub(crate) quadratic: &'c [f32],
    pub(crate) linear: &'c [f32],
    pub(crate) laminar: &'c [f32],
    pub(crate) guarded: &'c [f32],
    pub(crate) flow: &'c [f32],
}

/// One segment's figures from the columns, in their order.
type Row = ([f32; 5], f32);

impl<'c> Columns<'c> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    fn rows(self) -> impl Iterator<Item = Row> + use<'c> {
        let inner = self.inertia.iter().zip(self.quadratic).zip(self.linear);
        let outer = self.laminar.iter().zip(self.guarded).zip(self.flow);
        inner
            .zip(outer)
            .map(|(((i, k), l), ((laminar, guarded), flow))| ([*i, *k, *l, *laminar, *guarded], *flow))
    }
}

/// A description with the stage's length τ [s], and whether the compiler knows it.
pub(crate) struct Model<'n, 'd, E, const UNROLL: bool> {
    pub(crate) network: &'n Network<'d, E>,
    pub(crate) tau: f32,
}

impl<E: Element, const UNROLL: bool> Model<'_, '_, E, UNROLL> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over segments")]
    fn momentum(&self, index: usize, figures: [f32; 5]) -> Momentum {
        known::<E, UNROLL>(self.network, self.tau, index).momentum(figures)
    }

    /// Linearises around the increments that the last solution gave, or around rest at the step's `START`. `drop` goes
    /// along with the iterate, whose last change makes `differ`.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn linearise<const START: bool>(
        &self,
        columns: Columns<'_>,
        known: [&[f32]; 2],
        drop: &mut [f32],
        q: &mut [f32],
        ports: &mut [Port],
    ) {
        if UNROLL {
            self.linearise_all::<START>(columns, known, drop, q, ports);
        } else {
            self.linearise_apart::<START>(columns, known, drop, q, ports);
        }
    }

    /// A function of its own, whose loop then has the processor's registers for itself.
    #[inline(never)]
    fn linearise_apart<const START: bool>(
        &self,
        columns: Columns<'_>,
        known: [&[f32]; 2],
        drop: &mut [f32],
        q: &mut [f32],
        ports: &mut [Port],
    ) {
        self.linearise_all::<START>(columns, known, drop, q, ports);
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over segments")]
    fn linearise_all<const START: bool>(
        &self,
        columns: Columns<'_>,
        [differ, pushed]: [&[f32]; 2],
        drop: &mut [f32],
        q: &mut [f32],
        ports: &mut [Port],
    ) {
        let known = differ.iter().zip(pushed).zip(drop);
        let rows = columns.rows().zip(known).zip(q.iter_mut().zip(ports)).enumerate();
        every!(many UNROLL, rows, (index, (((figures, w), ((differ, pushed), drop)), (q, port))) => {
            if UNROLL && layout::continues(&self.network.plan, index) {
                // Solved as 1·w = 0, which nothing reads.
                (*q, *port) = (0.0, [1.0, 0.0]);
            } else {
                let dw = if START { 0.0 } else {
                    *drop += differ;
                    *q + port[0] * differ
                };
                let (b, fresh) = self.momentum(index, figures).linearise(w, dw, *drop + pushed);
                *q = fresh;
                *port = [b, w + fresh];
            }
        });
    }
}

/// What pushes the flows beside pressures, by the head of the stage: the `FIRST` knows nothing else.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn push<const FIRST: bool>(head: &[f32], pushed: &mut [f32]) {
    for (pushed, head) in pushed.iter_mut().zip(head) {
        *pushed = if FIRST { *head } else { *pushed + head };
    }
}

/// What pushes the flows in the BDF2 stage but for heads: inertance, by a share of the first stage's increments,
/// which are kept.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn carry_over(
    [inertia, differ, q]: [&[f32]; 3],
    ports: &[Port],
    pushed: &mut [f32],
    first: &mut [f32],
) {
    let known = inertia.iter().zip(differ.iter().zip(q)).zip(ports);
    for (((inertia, (differ, q)), [b, _]), (pushed, first)) in known.zip(pushed.iter_mut().zip(first)) {
        let dw = q + b * differ;
        *first = dw;
        *pushed = CARRY_OVER * inertia * dw;
    }
}

/// Turns `q` into the step's increments and writes the mass that passes every port of its own [kg] by mean flows.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn pass(
    h: f32,
    weights: [f32; 2],
    [differ, first, flow]: [&[f32]; 3],
    ports: &[Port],
    q: &mut [f32],
    passed: &mut [f32],
) {
    let known = differ.iter().zip(first).zip(flow).zip(ports);
    for ((((differ, first), flow), [b, _]), (q, passed)) in known.zip(q.iter_mut().zip(passed)) {
        let dw = *q + b * differ;
        *q = dw;
        *passed = h * (flow + (weights[0] * first + weights[1] * dw));
    }
}

/// Takes the increments over into the flows. Returns whether one left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn take_over(increments: &[f32], flow: &mut [f32], carry: &mut [f32], limit: f32) -> bool {
    let mut beyond = 0;
    for (dw, (flow, carry)) in increments.iter().zip(flow.iter_mut().zip(carry)) {
        math::compensated_add(flow, carry, *dw);
        beyond |= u32::from(math::beyond(*flow, limit));
    }
    beyond != 0
}
