//! What every method keeps in the same place of the state: node masses and the mass ledger.
//!
//! Every transfer of mass is rounded once, to a number of kilograms that is taken from one node, given to
//! another or drained, and booked as that number. The masses and the ledger are independent compensated sums
//! over the same transfers, so that their difference shows what arithmetic lost.

use crate::component::Element;
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

    /// All whole rows that are left.
    pub(crate) fn rest<const N: usize>(&mut self) -> &'b mut [[f32; N]] {
        core::mem::take(&mut self.0).as_chunks_mut().0
    }
}

/// State of a node: mass as deviation from the start and its carry [kg]; mass that a slowed node owes to its
/// flows and its carry [kg].
pub(crate) type NodeState = [f32; 4];

/// State of a line: flow and its carry [kg/s], where the method keeps one flow a line; sums of what it gave to
/// its outlet node and of what it drained, each with its carry [kg]. What it took from its inlet node is their
/// sum and what its own volumes hold.
pub(crate) type LineState = [f32; 6];

/// The part of the state that all methods share; it stands at the buffer's beginning.
pub(crate) struct Common<'s> {
    pub(crate) nodes: &'s mut [NodeState],
    pub(crate) lines: &'s mut [LineState],
}

impl<'s> Common<'s> {
    pub(crate) fn length<E>(network: &Network<'_, E>) -> usize {
        4 * network.nodes.len() + 6 * network.lines.len()
    }

    pub(crate) fn cut<E>(network: &Network<'_, E>, cut: &mut Cut<'s>) -> Self {
        let nodes = cut.take_rows(network.nodes.len());
        Self { nodes, lines: cut.take_rows(network.lines.len()) }
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
        add_mass(common.nodes, line.from as usize, given - taken);
    } else {
        add_mass(common.nodes, line.from as usize, -taken);
        add_mass(common.nodes, line.to as usize, given);
    }
    if let Some(state) = common.lines.get_mut(index) {
        book(state, given, drained);
    }
}

/// Books what a line gave and drained [kg].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
pub(crate) fn book(state: &mut LineState, given: f32, drained: f32) {
    let [_, _, given_sum, given_carry, drained_sum, drained_carry] = state;
    math::compensated_add(given_sum, given_carry, given);
    math::compensated_add(drained_sum, drained_carry, drained);
}

/// Adds one transfer to a node's mass.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn add_mass(nodes: &mut [NodeState], node: usize, transfer: f32) {
    if let Some([mass, carry, ..]) = nodes.get_mut(node) {
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
