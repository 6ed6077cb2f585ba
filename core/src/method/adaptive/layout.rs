//! Where `adaptive` keeps its numbers: rows by purpose, so that a pass over many lines or nodes reads only what
//! it needs.
//!
//! State: nodes, lines, what special lines drained, memory. Work: nodes, their constants, what arrives at them, laws of
//! lines, special lines. A line is **special** when its law may change or it drains anything; all others are a
//! constant quadratic resistance with a head. Few lines are special in a large network, and only they pay for it.

use crate::component::Element;
use crate::method::common::{Cut, NodeState};
use crate::method::responsive;
use crate::{Line, Network};

/// State of a line: flow [kg/s]; what it gave to its outlet node since the start and what that sum lost [kg].
pub(crate) type LineState = [f32; 3];

/// A sum and its carry [kg].
pub(crate) type Sum = [f32; 2];

/// Figures of a node: gauge pressure [Pa]; what arrives within a step: net transfer and what its sum lost [kg],
/// ΣG [kg/(s·Pa)]; [`NodeConstants`]; φ of the last step [1]. One row, because a line that reaches a node needs the
/// first half of it and a node all.
pub(crate) type NodeFigures = [f32; 8];

/// Gauge pressure at the start [Pa]; dp/dm [Pa/kg]; h·dp/dm/θ [Pa·s/kg], which times ΣG is the node's stiffness over θ.
pub(crate) type NodeConstants = [f32; 3];

/// Law of a line that is not special: ΣR [Pa·s²/kg²], Σf [Pa], smallest driving pressure at which it is not linear
/// [Pa]. A special line has its place among the special ones here, as bits, and the third.
pub(crate) type LineLaw = [f32; 3];

/// ΣR and ΣL for forward flow, both for reverse flow, and Σf of a line.
pub(crate) type Sums = [f32; 5];

/// A special line: its index, as bits; ratio of its inlet and of its outlet flow to the line's flow, when forward;
/// for a line that responds what κ of its law exceeds that of a root law by, else 0; the part of its sums that never changes; all of its sums.
pub(crate) type Special = [f32; 14];

const SPECIAL: usize = size_of::<Special>() / size_of::<f32>();

/// Lengths of state and work for `nodes`, `lines` and `special` lines.
pub(super) fn lengths(nodes: usize, lines: usize, special: usize) -> (usize, usize) {
    (4 * nodes + 3 * lines + 2 * special, 8 * nodes + 3 * lines + SPECIAL * special)
}

/// Whether a line's law may change or it drains anything.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(super) fn is_special<E: Element>(network: &Network<'_, E>, line: &Line) -> bool {
    network
        .segments_of(line)
        .iter()
        .any(|segment| segment.element.is_active() || segment.element.removal() > 0.0)
        || responsive::of_line(network, line).is_some()
}

/// The state, cut into its parts.
pub(crate) struct State<'s> {
    pub(crate) nodes: &'s mut [NodeState],
    pub(crate) lines: &'s mut [LineState],
    /// What every special line drained since the start.
    pub(crate) drained: &'s mut [Sum],
    /// What elements remember.
    pub(crate) memory: &'s mut [f32],
}

impl<'s> State<'s> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler knows stay known")]
    pub(super) fn of<E: Element>(network: &Network<'_, E>, buffer: &'s mut [f32]) -> Self {
        let (buffer, memory) = buffer.split_at_mut(buffer.len().saturating_sub(network.memory_slots()));
        let cut = &mut Cut(buffer);
        let (nodes, lines) = (cut.take_rows(network.nodes.len()), cut.take_rows(network.lines.len()));
        Self { nodes, lines, drained: cut.rest(), memory }
    }

    /// First value of a line's state.
    pub(crate) const fn line_at(nodes: usize, line: usize) -> usize {
        4 * nodes + 3 * line
    }

    /// First value of what a special line drained.
    pub(crate) fn drained_at(nodes: usize, lines: usize, special: usize) -> usize {
        4 * nodes + 3 * lines + 2 * special
    }
}

/// The work, cut into its parts.
pub(crate) struct Work<'w> {
    pub(crate) nodes: &'w mut [NodeFigures],
    pub(crate) laws: &'w mut [LineLaw],
    pub(crate) specials: &'w mut [Special],
}

impl<'w> Work<'w> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler knows stay known")]
    pub(super) fn of<E>(network: &Network<'_, E>, buffer: &'w mut [f32]) -> Self {
        let cut = &mut Cut(buffer);
        let (nodes, laws) = (cut.take_rows(network.nodes.len()), cut.take_rows(network.lines.len()));
        Self { nodes, laws, specials: cut.rest() }
    }

    /// First value of a line's law.
    pub(super) fn law_at(nodes: usize, line: usize) -> usize {
        8 * nodes + 3 * line
    }
}
