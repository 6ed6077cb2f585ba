//! Bookkeeping of one step: transfers into every volume, and transfers from outside the network.
//!
//! A transfer is one rounded number for each part and for the energy. Sums over a step are exact (two-sum), sums over
//! a run compensated. Only what a transfer can move is added: heat moves energy, coolant one part and energy.

use super::medium::{CARBON_DIOXIDE, LIQUID, NITROGEN, OXYGEN, TRACE, VAPOUR};
use super::stream::{ENERGY, STORED, Stored};
use crate::math;

/// Rows of the ledger: supplied from outside and its carry; turned over and its carry.
pub(crate) const LEDGER: usize = 4;

/// What flows with air.
const FLOWING: [usize; 6] = [NITROGEN, OXYGEN, CARBON_DIOXIDE, VAPOUR, TRACE, ENERGY];

/// All that is stored.
pub(crate) const ALL: [usize; 7] = [NITROGEN, OXYGEN, CARBON_DIOXIDE, VAPOUR, TRACE, LIQUID, ENERGY];

/// Transfers into the volumes within one step; a sum and its rounding.
#[derive(Debug)]
pub(crate) struct Books<'w> {
    pub(crate) net: &'w mut [Stored],
    pub(crate) lost: &'w mut [Stored],
}

impl Books<'_> {
    /// Adds what flows with air.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    pub(crate) fn add_flow(&mut self, node: usize, row: &Stored) {
        self.add_places(node, FLOWING, row);
    }

    /// Adds all that is stored.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn add_row(&mut self, node: usize, row: &Stored) {
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
    pub(crate) fn add<const N: usize>(&mut self, node: usize, places: [usize; N], values: [f32; N]) {
        if let (Some(net), Some(lost)) = (self.net.get_mut(node), self.lost.get_mut(node)) {
            for (place, value) in places.into_iter().zip(values) {
                math::exact_add(&mut net[place], &mut lost[place], value);
            }
        }
    }
}

/// Transfers from outside the network since the start.
#[derive(Debug)]
pub(crate) struct Outside<'s>(pub(crate) &'s mut [Stored]);

impl Outside<'_> {
    /// Books some parts, or the energy, or both.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loops over lines and sources")]
    pub(crate) fn supply<const N: usize>(&mut self, places: [usize; N], values: [f32; N]) {
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
    pub(crate) fn supply_row(&mut self, row: &Stored, sizes: &Stored) {
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
    pub(crate) fn supply_heat(&mut self, energy_j: f32) {
        self.supply([ENERGY], [energy_j]);
    }
}

/// Transfers from outside into one volume: their sum and their sizes.
#[derive(Debug, Clone, Copy, Default)]
struct Given {
    sum: Stored,
    turned: Stored,
}

/// The books while components settle. Transfers from outside into one volume, of several components in a row, are
/// summed and booked as one rounded number.
#[derive(Debug)]
pub struct Accounts<'a> {
    books: Books<'a>,
    outside: Outside<'a>,
    node: usize,
    given: Given,
}

impl<'a> Accounts<'a> {
    pub(crate) fn new(books: Books<'a>, outside: Outside<'a>) -> Self {
        Self { books, outside, node: 0, given: Given::default() }
    }

    /// Returns the account of a component in volume `node`. Transfers from outside into another volume are booked first.
    #[inline]
    pub(crate) fn account(&mut self, node: u32) -> Account<'_, 'a> {
        if node as usize != self.node {
            self.close();
            self.node = node as usize;
        }
        Account(self)
    }

    /// Books the transfers from outside that are still open.
    pub(crate) fn close(&mut self) {
        let Given { sum, turned } = core::mem::take(&mut self.given);
        self.books.add_row(self.node, &sum);
        self.outside.supply_row(&sum, &turned);
    }
}

/// Transfers of one component in a step.
#[derive(Debug)]
pub struct Account<'s, 'a>(&'s mut Accounts<'a>);

impl Account<'_, '_> {
    /// Brings masses [kg] and energy [J] from outside the network into the component's volume.
    #[inline]
    pub fn bring<const N: usize>(&mut self, places: [usize; N], values: [f32; N]) {
        let Given { sum, turned } = &mut self.0.given;
        for (place, value) in places.into_iter().zip(values) {
            if place < STORED {
                sum[place] += value;
                turned[place] += value.abs();
            }
        }
    }

    /// Gives masses [kg] and energy [J] of the component's own storage to its volume.
    #[inline]
    pub fn give<const N: usize>(&mut self, places: [usize; N], values: [f32; N]) {
        self.0.books.add(self.0.node, places, values);
    }

    /// Takes up heat from outside the network [J] into the component's own storage.
    #[inline]
    pub fn take_up_heat(&mut self, energy_j: f32) {
        self.0.outside.supply_heat(energy_j);
    }
}
