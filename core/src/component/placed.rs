//! Components at their places: those that act on volumes, or meet streams.

use core::fmt;

use super::any::{Kind, Of, Row};
use super::{AnyComponent, Component};

/// A component that acts on a volume or meets streams, at its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Its parameters.
    pub row: Row,
    /// Its volume: that of a `[[crew]]`, or the one at the outlet of its line.
    pub node: u32,
    /// Slot of its first input.
    pub first_input: u32,
    /// Whether a stream passes its second side.
    pub linked: bool,
}

/// Places of a table's components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Range {
    /// First component, counted over all placed ones.
    pub first: u32,
    /// Number of components.
    pub count: u32,
    /// First word of their state, in the state of all placed components.
    pub first_state: u32,
    /// First word of their scratch.
    pub first_scratch: u32,
}

/// All placed components of one kind, side by side.
#[derive(Clone, Copy)]
pub struct Table {
    kind: &'static dyn Kind,
    /// Their places.
    pub range: Range,
}

/// A stream's passage through a placed component; in the order of the segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Passage {
    /// The segment, counted over all lines.
    pub segment: u32,
    /// Its line.
    pub line: u32,
    /// Table of the component.
    pub table: u32,
    /// The component, counted over all placed ones.
    pub component: u32,
    /// Side of the component.
    pub side: u8,
}

impl Table {
    /// Returns the table of the components of kind `C` at these places.
    pub const fn new<C: Component>(range: Range) -> Self {
        Self { kind: Of::<C>::KIND, range }
    }

    /// Returns the table of the components of the kind of `component` at these places.
    pub fn of(component: &AnyComponent, range: Range) -> Self {
        Self { kind: component.erased(), range }
    }

    /// Returns the kind.
    pub fn kind(&self) -> &'static dyn Kind {
        self.kind
    }

    /// Returns the places of a table of `count` components behind this one.
    pub fn behind(&self, count: u32) -> Range {
        let [state, scratch] = self.kind.blocks().map(|length| length as u32);
        let Range { first, count: own, first_state, first_scratch } = self.range;
        Range {
            first: first + own,
            count,
            first_state: first_state + own * state,
            first_scratch: first_scratch + own * scratch,
        }
    }

    /// Whether the table holds components of kind `C`.
    pub fn is<C: Component>(&self) -> bool {
        self.kind.name() == C::KIND
    }

    /// Returns a placed component of this table without its place.
    pub fn component(&self, placed: &Placed) -> AnyComponent {
        AnyComponent::erase(self.kind, placed.row)
    }
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct(self.kind.name()).field("range", &self.range).finish()
    }
}
