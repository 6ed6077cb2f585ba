//! Bookkeeping of one step: what arrives at every volume, and what came from outside.
//!
//! A transfer is one rounded number for each part and for the energy. Sums over a step are exact (two-sum), sums over
//! a run compensated. Only what a transfer can move is added: heat moves energy, coolant one part and energy.

use super::medium::{CARBON_DIOXIDE, LIQUID, NITROGEN, OXYGEN, TRACE, VAPOUR};
use super::volume::{ENERGY, Stored};
use crate::math;

/// Rows of the ledger: supplied from outside and its carry; turned over and its carry.
pub(super) const LEDGER: usize = 4;

/// What flows with air.
const FLOWING: [usize; 6] = [NITROGEN, OXYGEN, CARBON_DIOXIDE, VAPOUR, TRACE, ENERGY];

/// All that is stored.
pub(super) const ALL: [usize; 7] = [NITROGEN, OXYGEN, CARBON_DIOXIDE, VAPOUR, TRACE, LIQUID, ENERGY];

/// What arrives at the volumes within one step; a sum and what it lost.
pub(super) struct Books<'w> {
    pub(super) net: &'w mut [Stored],
    pub(super) lost: &'w mut [Stored],
}

impl Books<'_> {
    /// Adds what flows with air.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub(super) fn add_flow(&mut self, node: usize, row: &Stored) {
        self.add_places(node, FLOWING, row);
    }

    /// Adds all that is stored.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(super) fn add_row(&mut self, node: usize, row: &Stored) {
        self.add_places(node, ALL, row);
    }

    /// Adds the `places` of a row whose other places are 0, which an exact sum does not see.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    fn add_places<const N: usize>(&mut self, node: usize, places: [usize; N], row: &Stored) {
        if !math::VECTORS {
            return self.add(node, places, places.map(|place| row[place]));
        }
        if let (Some(net), Some(lost)) = (self.net.get_mut(node), self.lost.get_mut(node)) {
            math::exact_add_row(net, lost, row);
        }
    }

    /// Adds some parts, or the energy, or both.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loops over lines and sources")]
    pub(super) fn add<const N: usize>(&mut self, node: usize, places: [usize; N], values: [f32; N]) {
        if let (Some(net), Some(lost)) = (self.net.get_mut(node), self.lost.get_mut(node)) {
            for (place, value) in places.into_iter().zip(values) {
                math::exact_add(&mut net[place], &mut lost[place], value);
            }
        }
    }
}

/// What came from outside since the start.
pub(super) struct Outside<'s>(pub(super) &'s mut [Stored]);

impl Outside<'_> {
    /// Books some parts, or the energy, or both.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loops over lines and sources")]
    pub(super) fn supply<const N: usize>(&mut self, places: [usize; N], values: [f32; N]) {
        if let [supplied, s, turned, t] = &mut *self.0 {
            for (place, value) in places.into_iter().zip(values) {
                math::compensated_add(&mut supplied[place], &mut s[place], value);
                math::compensated_add(&mut turned[place], &mut t[place], value.abs());
            }
        }
    }

    /// Books a row and its sizes.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(super) fn supply_row(&mut self, row: &Stored, sizes: &Stored) {
        if let [supplied, s, turned, t] = &mut *self.0 {
            if math::VECTORS {
                math::compensated_add_row(supplied, s, row);
                math::compensated_add_row(turned, t, sizes);
                return;
            }
            for place in ALL {
                math::compensated_add(&mut supplied[place], &mut s[place], row[place]);
                math::compensated_add(&mut turned[place], &mut t[place], sizes[place]);
            }
        }
    }

    /// Books heat.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loops over lines and sources")]
    pub(super) fn supply_heat(&mut self, energy_j: f32) {
        self.supply([ENERGY], [energy_j]);
    }
}
