//! Flow of one line: its law in closed form, its booking, and what it means for the nodes at its ends.

use super::layout::{LineLaw, LineState, Special, Sum, Sums};
use crate::law::Law;
use crate::math;

/// What one end of a line means for its node: transfer into the node [kg], conductance there [kg/(s·Pa)].
pub(crate) type Transfer = [f32; 2];

/// Flow [kg/s] and secant conductance [kg/(s·Pa)] of a line that is not special.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(super) fn plain_flow(difference_pa: f32, &[resistance, head, smallest]: &LineLaw) -> (f32, f32) {
    let y = difference_pa + head;
    let conductance = 1.0 / math::sqrt(resistance * math::larger(y.abs(), smallest));
    (y * conductance, conductance)
}

/// The same for any line. A law that depends on the direction of flow has sums of its own for either; one that
/// depends on the pressures at both ends states its sums before the lines are stepped.
#[inline(always)]
#[allow(clippy::inline_always, reason = "its sums are known to the compiler where the description is")]
pub(super) fn special_flow(difference_pa: f32, sums: &Sums, smallest_pa: f32) -> (f32, f32) {
    let &[forward, forward_linear, reverse, reverse_linear, head] = sums;
    let y = difference_pa + head;
    let law = if y > 0.0 { [forward, forward_linear] } else { [reverse, reverse_linear] };
    let conductance = secant(y.abs(), law, smallest_pa);
    (y * conductance, conductance)
}

/// Secant conductance w/y [kg/(s·Pa)] of `R·w·max(|w|, w_lin) + L·w = y`, `w_lin = √(y_lin/R)`, at a drive of this
/// `size` [Pa]. Its straight part ends at `y_lin + L·√(y_lin/R)`, which is only asked for where there is an L.
#[inline(always)]
#[allow(clippy::inline_always, reason = "its sums are known to the compiler where the description is")]
fn secant(size: f32, [quadratic, linear]: [f32; 2], smallest_pa: f32) -> f32 {
    let mut straight = quadratic * smallest_pa;
    if linear > 0.0 {
        straight += linear * math::sqrt(straight);
    }
    2.0 / (linear + math::sqrt(linear * linear + 4.0 * math::larger(quadratic * size, straight)))
}

/// Steps a line that is not special and books it. Returns flow [kg/s], transfer to the outlet node [kg] and
/// conductance [kg/(s·Pa)].
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over lines")]
pub(super) fn step_plain(h: f32, difference_pa: f32, law: &LineLaw, state: &mut LineState) -> [f32; 3] {
    let (w, conductance) = plain_flow(difference_pa, law);
    let passed = h * w;
    let [flow, given, carry] = state;
    *flow = w;
    math::compensated_add(given, carry, passed);
    [w, passed, conductance]
}

/// Steps a special line and books it. Returns what it means for the nodes at its inlet and outlet.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(super) fn step_special(
    h: f32,
    difference_pa: f32,
    special: &Special,
    smallest_pa: f32,
    state: &mut LineState,
    drained: &mut Sum,
) -> [Transfer; 2] {
    let &[_, inlet, outlet, chord, ..] = special;
    let (w, mut conductance) = special_flow(difference_pa, &sums_of(special), smallest_pa);
    if chord > 0.0 {
        conductance = widest(difference_pa, &sums_of(special), smallest_pa, chord);
    }
    let [inlet, outlet] = if w > 0.0 { [inlet, outlet] } else { [1.0, 1.0] };
    let passed = h * w;
    let (taken, given) = (inlet * passed, outlet * passed);
    let ([flow, given_sum, given_carry], [drained_sum, drained_carry]) = (state, drained);
    *flow = w;
    math::compensated_add(given_sum, given_carry, given);
    math::compensated_add(drained_sum, drained_carry, taken - given);
    [[-taken, inlet * conductance], [given, outlet * conductance]]
}

/// The conductance that bounds every chord of a responsive line's law [kg/(s·Pa)]: the larger of both directions,
/// times what its κ exceeds that of a root law by.
#[cold]
#[inline(never)]
fn widest(difference_pa: f32, sums: &Sums, smallest_pa: f32, chord: f32) -> f32 {
    let &[forward, forward_linear, reverse, reverse_linear, head] = sums;
    let size = (difference_pa + head).abs();
    let of = |law| secant(size, law, smallest_pa);
    chord * math::larger(of([forward, forward_linear]), of([reverse, reverse_linear]))
}

/// Index of a special line.
pub(super) fn index_of(special: &Special) -> u32 {
    special[0].to_bits()
}

/// All sums of a special line.
pub(super) fn sums_of(special: &Special) -> Sums {
    let &[.., forward, forward_linear, reverse, reverse_linear, head] = special;
    [forward, forward_linear, reverse, reverse_linear, head]
}

/// The part of a special line's sums that never changes.
pub(super) fn constant_sums(special: &Special) -> Sums {
    let &[_, _, _, _, forward, forward_linear, reverse, reverse_linear, head, ..] = special;
    [forward, forward_linear, reverse, reverse_linear, head]
}

pub(super) fn set_sums(special: &mut Special, sums: Sums) {
    let [.., forward, forward_linear, reverse, reverse_linear, head] = special;
    [*forward, *forward_linear, *reverse, *reverse_linear, *head] = sums;
}

/// Adds a law whose forward flow is `ratio` times the line's to the line's sums.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(super) fn add(sums: &mut Sums, law: &Law, ratio: f32) {
    let [forward, forward_linear, reverse, reverse_linear, head] = sums;
    *forward += law.resistance * (ratio * ratio);
    *forward_linear += law.linear * ratio;
    *reverse += law.resistance;
    *reverse_linear += law.linear;
    *head += law.head;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_obeys_the_regularised_law_with_and_without_a_linear_part() {
        for linear in [0.0f32, 3.0, 700.0, 4e6] {
            for (quadratic, limit) in [(500.0f32, 0.3f32), (1e6, 1e-3), (0.0, 0.1), (2e4, 0.0)] {
                if quadratic + linear <= 0.0 {
                    continue;
                }
                for drive in [1e-4f32, 0.02, 0.3, 5.0, 900.0, -0.02, -40.0] {
                    let (w, _) = special_flow(drive, &[quadratic, linear, quadratic, linear, 0.0], limit);
                    let [w, q, l] = [w, quadratic, linear].map(f64::from);
                    let laminar = (f64::from(limit) / q.max(f64::MIN_POSITIVE)).sqrt();
                    let loss = q * w * w.abs().max(laminar) + l * w;
                    let drive = f64::from(drive);
                    assert!((loss / drive - 1.0).abs() < 1e-6, "R {q}, L {l}, {drive} Pa: {loss}");
                }
            }
        }
    }
}
