//! What every method keeps in the same place of the state: node masses and the mass ledger.
//!
//! Every transfer of mass is rounded once, to a number of kilograms that is taken from one node, given to
//! another or drained, and booked as that number. The masses and the ledger are independent compensated sums
//! over the same transfers, so that their difference shows what arithmetic lost.

use crate::element::Element;
use crate::{Network, math};

/// Cuts a buffer into named parts; parts that no longer fit come out empty.
pub(crate) struct Cut<'b>(pub(crate) &'b mut [f32]);

impl<'b> Cut<'b> {
    pub(crate) fn take(&mut self, length: usize) -> &'b mut [f32] {
        match core::mem::take(&mut self.0).split_at_mut_checked(length) {
            Some((part, rest)) => {
                self.0 = rest;
                part
            }
            None => &mut [],
        }
    }

    pub(crate) fn take_rows<const N: usize>(&mut self, rows: usize) -> &'b mut [[f32; N]] {
        self.take(rows * N).as_chunks_mut().0
    }
}

/// Sums that a line keeps: given to its outlet node, drained; each with its carry. What it took from its inlet
/// node is their sum, and what its own volumes hold.
pub(crate) type LineSums = [f32; 4];

/// The part of the state that all methods share; it stands at the buffer's beginning.
pub(crate) struct Common<'s> {
    /// Mass of every node as deviation from the start, and its carry [kg].
    pub(crate) mass: &'s mut [[f32; 2]],
    /// Mass that a slowed node owes to its flows, and its carry [kg].
    pub(crate) fictitious: &'s mut [[f32; 2]],
    /// Ledger of every line [kg].
    pub(crate) sums: &'s mut [LineSums],
}

impl<'s> Common<'s> {
    pub(crate) fn length<E>(network: &Network<'_, E>) -> usize {
        4 * network.nodes.len() + 4 * network.lines.len()
    }

    pub(crate) fn cut<E>(network: &Network<'_, E>, cut: &mut Cut<'s>) -> Self {
        let nodes = network.nodes.len();
        let (mass, fictitious) = (cut.take_rows(nodes), cut.take_rows(nodes));
        Self { mass, fictitious, sums: cut.take_rows(network.lines.len()) }
    }
}

/// Books one step of one line [kg] and moves the masses of its nodes.
///
/// `taken − given − drained` is what the line's own volumes keep; it is not booked but read from them.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
pub(crate) fn transfer(
    common: &mut Common<'_>,
    index: usize,
    line: &crate::Line,
    taken: f32,
    given: f32,
    drained: f32,
) {
    if line.from == line.to {
        // Exact: the two differ by less than a factor of two.
        add_mass(common.mass, line.from as usize, given - taken);
    } else {
        add_mass(common.mass, line.from as usize, -taken);
        add_mass(common.mass, line.to as usize, given);
    }
    if let Some(sums) = common.sums.get_mut(index) {
        book(sums, given, drained);
    }
}

/// Books what a line gave and drained [kg].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
pub(crate) fn book(sums: &mut LineSums, given: f32, drained: f32) {
    let [given_sum, given_carry, drained_sum, drained_carry] = sums;
    math::compensated_add(given_sum, given_carry, given);
    math::compensated_add(drained_sum, drained_carry, drained);
}

/// Adds one transfer to a node's mass.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
pub(crate) fn add_mass(masses: &mut [[f32; 2]], node: usize, transfer: f32) {
    if let Some([mass, carry]) = masses.get_mut(node) {
        math::compensated_add(mass, carry, transfer);
    }
}

/// Ratios of the flow at every segment's inlet, and behind the last, to the flow at the line's flow segment,
/// for forward flow: calls `each` for every segment in order and returns the ratio behind the last.
pub(crate) fn flow_ratios<E: Element>(
    network: &Network<'_, E>,
    line: &crate::Line,
    mut each: impl FnMut(usize, &crate::Segment<E>, f32),
) -> f32 {
    let segments = network.segments_of(line);
    let upstream = segments.get(..line.flow_segment as usize).unwrap_or(&[]);
    let mut ratio: f32 = upstream.iter().map(|segment| 1.0 + segment.element.removal()).product();
    for (index, segment) in segments.iter().enumerate() {
        each(index, segment, ratio);
        ratio /= 1.0 + segment.element.removal();
    }
    ratio
}
