//! Where the implicit methods keep their numbers.
//!
//! Figures of segments stand side by side by kind, so that a host works on several segments at once. A *point* is a
//! pressure: point n is node n, and point nodes + s is the joint behind segment s where a volume stands there. A
//! joint without volume is no point; the segments around it are one *reach*, whose figures stand at its last segment.

use super::super::common::{Common, Cut};
use crate::component::Element;
use crate::{Network, Plan};

/// Figures of the volume behind a segment: C/τ [kg/(s·Pa)]; dp/dm [Pa/kg]; known part of its balance less what its increment holds [kg/s]; α [Pa],
/// γ and κ [1] of the last sweep. Between two sweeps κ's place holds the iterate's flow where a drain acts by it [kg/s].
pub(crate) type Joint = [f32; 6];

/// What a port carries: conductance [kg/(s·Pa)] and flow [kg/s] at increments of 0. Port s is both ends of a line of
/// one flow whose last segment is s; lines of [`Plan::composite`] have two ports each behind those of all segments.
pub(crate) type Port = [f32; 2];

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn sizes<E: Element>(network: &Network<'_, E>) -> (usize, usize) {
    let (nodes, segments) = (network.nodes.len(), network.segments.len());
    let ports = segments + 2 * network.plan.composite.len();
    let (rows, entries) = (network.plan.order.len(), network.plan.columns.len());
    let of_segments = (11 + 3 + 6) * segments;
    (
        Common::length(network) + 2 * nodes + 4 * segments + network.memory_slots(),
        3 * (nodes + segments)
            + 4 * nodes
            + 2 * (nodes + 1)
            + of_segments
            + 3 * ports
            + 2 * rows
            + 3 * network.plan.series.len()
            + (entries + 1)
            + 5,
    )
}

/// Where the flows of segments begin in the state; their joints' masses follow two lengths later.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn first_flow<E>(network: &Network<'_, E>) -> usize {
    Common::length(network) + 2 * network.nodes.len()
}

/// Where the masses that passed the ports begin in the work buffer.
pub(crate) fn first_passed<E>(network: &Network<'_, E>) -> usize {
    network.nodes.len() + network.segments.len()
}

pub(crate) struct State<'s> {
    pub(crate) common: Common<'s>,
    /// Pressures of nodes without volume, and carries [Pa gauge].
    pub(crate) junctions: &'s mut [[f32; 2]],
    /// Flow of every reach at its last segment's inlet, and its carry [kg/s].
    pub(crate) flow: &'s mut [f32],
    pub(crate) flow_carry: &'s mut [f32],
    /// Mass in the volume behind every segment as deviation from the start, and its carry [kg].
    pub(crate) mass: &'s mut [f32],
    pub(crate) mass_carry: &'s mut [f32],
    /// What elements remember.
    pub(crate) memory: &'s mut [f32],
}

impl<'s> State<'s> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn of<E: Element>(network: &Network<'_, E>, buffer: &'s mut [f32]) -> Self {
        let (nodes, segments) = (network.nodes.len(), network.segments.len());
        let cut = &mut Cut(buffer);
        let common = Common::cut(network, cut);
        let junctions = cut.take_rows(nodes);
        let (flow, flow_carry) = (cut.take(segments), cut.take(segments));
        let (mass, mass_carry) = (cut.take(segments), cut.take(segments));
        Self {
            common,
            junctions,
            flow,
            flow_carry,
            mass,
            mass_carry,
            memory: cut.take(network.memory_slots()),
        }
    }
}

pub(crate) struct Work<'w> {
    /// Pressure of every point [Pa gauge]; the nodes' come first.
    pub(crate) pressure: &'w mut [f32],
    /// Mass that passed every port in this step [kg].
    pub(crate) passed: &'w mut [f32],
    /// Increment of every point's pressure since the step's start [Pa].
    pub(crate) delta: &'w mut [f32],
    /// What the last solve added to it [Pa].
    pub(crate) change: &'w mut [f32],
    /// C/τ of every node [kg/(s·Pa)].
    pub(crate) capacity: &'w mut [f32],
    /// The same with what lines with volumes of their own hold at the node.
    pub(crate) excess: &'w mut [f32],
    /// Known part of every node's balance less what its increment holds [kg/s].
    pub(crate) known: &'w mut [f32],
    /// dp/dm of every node [Pa/kg].
    pub(crate) per_mass: &'w mut [f32],
    /// Share of itself that an eliminated node holds [1] and its correction where later nodes do not move [Pa]; before it is
    /// eliminated what it holds [kg/(s·Pa)] and knows [kg/s]. One more of zeros for a node that does not exist.
    pub(crate) swept: &'w mut [[f32; 2]],
    /// I/τ [Pa·s/kg], R, L and head of every reach in this stage, its laminar flow [kg/s], and 1 where its slope
    /// needs a guard.
    pub(crate) inertia: &'w mut [f32],
    pub(crate) quadratic: &'w mut [f32],
    pub(crate) linear: &'w mut [f32],
    pub(crate) head: &'w mut [f32],
    pub(crate) laminar: &'w mut [f32],
    pub(crate) guarded: &'w mut [f32],
    /// Pressure difference at the iterate before, what else pushes the flow, difference of the last changes [Pa].
    pub(crate) drop: &'w mut [f32],
    pub(crate) pushed: &'w mut [f32],
    pub(crate) differ: &'w mut [f32],
    /// q of δw = q + b·(c − c), and the increment of the step's first stage [kg/s].
    pub(crate) q: &'w mut [f32],
    pub(crate) first: &'w mut [f32],
    /// R, L and head of every segment by itself.
    pub(crate) law: &'w mut [[f32; 3]],
    pub(crate) joints: &'w mut [Joint],
    pub(crate) ports: &'w mut [Port],
    /// What every row passes on to the one neighbour that is left, as a share [1].
    pub(crate) onward: &'w mut [f32],
    /// Correction of every row with two later neighbours where they do not move, and its shares of theirs.
    pub(crate) shares: &'w mut [[f32; 3]],
    /// One row, dense; what rows exchange, then their shares, and one more of zero for an entry that does not exist.
    pub(crate) dense: &'w mut [f32],
    pub(crate) entries: &'w mut [f32],
    /// 1 where some joint in a line has no volume.
    pub(crate) merged: &'w mut [f32],
    /// 1 where one solve would leave a volume what it rounds.
    pub(crate) again: &'w mut [f32],
    /// 1 where some line's laminar flow follows its direction.
    pub(crate) turning: &'w mut [f32],
    /// 1 until the first step.
    pub(crate) fresh: &'w mut [f32],
    /// 1 where some line reacts to more than density: to pressures, direction or a memory.
    pub(crate) reacts: &'w mut [f32],
}

impl<'w> Work<'w> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let (nodes, segments) = (network.nodes.len(), network.segments.len());
        let ports = segments + 2 * network.plan.composite.len();
        let rows = network.plan.order.len();
        let cut = &mut Cut(buffer);
        Self {
            pressure: cut.take(nodes + segments),
            passed: cut.take(ports),
            delta: cut.take(nodes + segments),
            change: cut.take(nodes + segments),
            capacity: cut.take(nodes),
            excess: cut.take(nodes),
            known: cut.take(nodes),
            per_mass: cut.take(nodes),
            swept: cut.take_rows(nodes + 1),
            inertia: cut.take(segments),
            quadratic: cut.take(segments),
            linear: cut.take(segments),
            head: cut.take(segments),
            laminar: cut.take(segments),
            guarded: cut.take(segments),
            drop: cut.take(segments),
            pushed: cut.take(segments),
            differ: cut.take(segments),
            q: cut.take(segments),
            first: cut.take(segments),
            law: cut.take_rows(segments),
            joints: cut.take_rows(segments),
            ports: cut.take_rows(ports),
            onward: cut.take(rows),
            dense: cut.take(rows),
            shares: cut.take_rows(network.plan.series.len()),
            entries: cut.take(network.plan.columns.len() + 1),
            merged: cut.take(1),
            again: cut.take(1),
            turning: cut.take(1),
            fresh: cut.take(1),
            reacts: cut.take(1),
        }
    }
}

/// Value at an index from a checked table; 0 where there is none.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one load")]
pub(crate) fn at(values: &[f32], index: u32) -> f32 {
    values.get(index as usize).copied().unwrap_or(0.0)
}

/// Whether the joint behind a segment has no volume, so that it belongs to the reach of the next one.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one comparison")]
pub(crate) fn continues(plan: &Plan<'_>, segment: usize) -> bool {
    plan.between.get(segment).is_some_and(|[from, _]| *from == Plan::NOWHERE)
}

/// Whether a segment is the last of a reach of several.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one comparison")]
pub(crate) fn is_joined(plan: &Plan<'_>, segment: usize) -> bool {
    segment > 0 && !continues(plan, segment) && continues(plan, segment - 1)
}
