//! One node's step, and what its pressure may be.

use super::layout::NodeConstants;
use crate::method::common::NodeState;
use crate::simulator::Fault;
use crate::{math, operator};

/// Bits of an `f32` without its sign.
const MAGNITUDE: u32 = 0x7fff_ffff;

/// Moves a node by what arrived at it: net transfer, what its sum lost [kg] and ΣG [kg/(s·Pa)]. Returns gauge
/// pressure [Pa] and φ [1].
///
/// What φ keeps from being stored is owed, and added in every step, also when it is nothing: no step takes longer
/// than another.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over nodes")]
pub(super) fn move_node(
    state: &mut NodeState,
    [start_pa, per_mass, rate]: NodeConstants,
    [net, lost, conductance]: [f32; 3],
) -> (f32, f32) {
    let [mass, carry, owed, owed_carry] = state;
    let phi = operator::phi(rate * conductance);
    let stored = phi * net;
    *carry += phi * lost;
    math::compensated_add(mass, carry, stored);
    math::compensated_add(owed, owed_carry, net - stored);
    (start_pa + per_mass * *mass, phi)
}

/// What is watched over all nodes and lines of a step. Every figure joins in any order to the same bits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    /// Bits of the smallest φ; those of positive numbers are ordered as the numbers are.
    smallest_phi: i32,
    /// The highest bit is set where a value may have left its range.
    beyond: u32,
}

impl Watch {
    pub(super) const NOTHING: Self = Self { smallest_phi: 1.0f32.to_bits().cast_signed(), beyond: 0 };

    /// Looks at a flow [kg/s].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "the body of the loop over lines")]
    pub(super) fn flow(&mut self, w: f32) {
        self.beyond |= Fault::FLOW_LIMIT_KG_S.to_bits().wrapping_sub(w.to_bits() & MAGNITUDE);
    }

    /// Looks at a moved node; the upper end of its range is found by the sum of squares in [`Self::squares`].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "the body of the loop over nodes")]
    pub(super) fn node(&mut self, range: Range, pressure: f32, phi: f32) {
        let phi = phi.to_bits().cast_signed();
        self.smallest_phi = if phi < self.smallest_phi { phi } else { self.smallest_phi };
        self.beyond |= (pressure + range.offset_pa).to_bits();
    }

    /// Looks at many values by the sum of their squares, which is no small number where any of them is not.
    pub(super) fn squares(&mut self, sum: f32, limit: f32) {
        self.beyond |= (limit * limit).to_bits().wrapping_sub(sum.to_bits());
    }

    pub(super) fn smallest_phi(self) -> f32 {
        f32::from_bits(self.smallest_phi.cast_unsigned())
    }

    /// Whether everything is in range for certain; otherwise it has to be looked for.
    pub(super) fn is_fine(self) -> bool {
        self.beyond >> 31 == 0
    }
}

/// Lower end of a gauge pressure's range: what is added so that the highest bit of the sum is set below it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    offset_pa: f32,
}

impl Range {
    /// For gauge pressures over `reference_pa` [Pa, ≥ 0]. Never overlooks what [`Fault::outside`] finds.
    pub(super) fn of(reference_pa: f32) -> Self {
        // The sign of a rounded sum is exact.
        let above = reference_pa > Fault::GAUGE_LIMIT_PA;
        Self { offset_pa: if above { Fault::GAUGE_LIMIT_PA } else { reference_pa } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(reference_pa: f32, pressure_pa: f32) -> bool {
        let mut watch = Watch::NOTHING;
        watch.node(Range::of(reference_pa), pressure_pa, 1.0);
        watch.squares(pressure_pa * pressure_pa, Fault::GAUGE_LIMIT_PA);
        !watch.is_fine()
    }

    #[test]
    fn no_pressure_out_of_range_is_overlooked_and_none_far_inside_is_suspected() {
        for reference in [0.0f32, 1.0, 101_325.0, 9.9e6, 1e7, 3e7] {
            for edge in [0.0f32, -reference, Fault::GAUGE_LIMIT_PA, -Fault::GAUGE_LIMIT_PA] {
                for pressure in [edge, edge.next_up(), edge.next_down(), edge + 1.0, edge - 1.0] {
                    if Fault::outside(pressure, reference) {
                        assert!(seen(reference, pressure), "{pressure} over {reference}");
                    }
                }
            }
            for pressure in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30] {
                assert!(seen(reference, pressure), "{pressure} over {reference}");
            }
            let low = if reference < 1e7 { -reference } else { -1e7 };
            for part in [0.0f32, 0.01, 0.5, 0.99] {
                assert!(
                    !seen(reference, low * part) && !seen(reference, 1e7 * part),
                    "{part} of {reference}"
                );
            }
            assert!(!seen(reference, low), "vacuum over {reference}");
        }
    }

    #[test]
    fn flows_beyond_the_limit_are_seen_in_both_directions() {
        for (w, beyond) in
            [(1e3f32, false), (-1e3, false), (0.0, false), (-0.0, false), (1e-40, false)].into_iter().chain([
                (1e3f32.next_up(), true),
                ((-1e3f32).next_down(), true),
                (f32::NAN, true),
                (f32::INFINITY, true),
            ])
        {
            let mut watch = Watch::NOTHING;
            watch.flow(w);
            assert_eq!(!watch.is_fine(), beyond, "{w}");
        }
    }
}
