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
    /// Words of state and of scratch of each.
    pub blocks: [u32; 2],
}

impl Range {
    /// Words of component `place` of the table, in the state or the scratch that begins at `first`.
    #[inline]
    pub(crate) fn words(first: u32, length: u32, place: u32) -> core::ops::Range<usize> {
        let from = (first + place * length) as usize;
        from..from + length as usize
    }

    /// Words of the state of all components.
    #[inline]
    pub(crate) fn state(&self) -> core::ops::Range<usize> {
        self.first_state as usize..(self.first_state + self.count * self.blocks[0]) as usize
    }

    /// Words of the scratch of all components.
    #[inline]
    pub(crate) fn scratch(&self) -> core::ops::Range<usize> {
        self.first_scratch as usize..(self.first_scratch + self.count * self.blocks[1]) as usize
    }
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

    /// Returns the table of `count` components of the kind of `component` behind `before`.
    pub fn behind(before: Option<&Self>, component: &AnyComponent, count: u32) -> Self {
        Self { kind: component.erased(), range: Self::places(before, component, count) }
    }

    /// Returns the kind.
    pub fn kind(&self) -> &'static dyn Kind {
        self.kind
    }

    /// Returns the places of `count` components of the kind of `component` behind those of `before`.
    pub fn places(before: Option<&Self>, component: &AnyComponent, count: u32) -> Range {
        let blocks = component.erased().blocks().map(|length| length as u32);
        let Range { first, count: own, first_state, first_scratch, blocks: [state, scratch] } =
            before.map_or(Range::default(), |table| table.range);
        Range {
            first: first + own,
            count,
            first_state: first_state + own * state,
            first_scratch: first_scratch + own * scratch,
            blocks,
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
