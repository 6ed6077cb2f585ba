//! Tables that follow from how nodes and lines are connected.
//!
//! They are made once, when a network is built (`eclss-network-file` does it), and are constant data like the
//! description itself: the order in which a node's flows are summed, and the order and fill pattern of the
//! elimination that the implicit methods run. With them a step is a fixed sequence of operations.

use crate::component::Element;
use crate::{Line, Network, Node, NodeKind};

/// An end of a line: twice the line's index, plus one for its outlet.
pub type End = u32;

/// A row with two later neighbours, see [`Plan::series`].
pub type Series = [u32; 9];

/// Connection tables of one network, borrowed like the rest of the description.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan<'a> {
    /// For every node the first of its entries in `ends`, and one past the last; nodes + 1 numbers.
    pub end_start: &'a [u32],
    /// The ends of lines at every node, in ascending order within a node.
    pub ends: &'a [End],
    /// Nodes whose pressure is unknown, in the order of elimination.
    pub order: &'a [u32],
    /// For every row the first of its entries in `columns`, and one past the last; rows + 1 numbers.
    pub row_start: &'a [u32],
    /// Columns of the entries of L + U with fill, ascending within a row; a column is a position in `order`.
    pub columns: &'a [u32],
    /// Entry of the diagonal in every row.
    pub diagonal: &'a [u32],
    /// Entries that a line adds to: (from, from), (from, to), (to, from), (to, to); [`Plan::NOWHERE`] where an
    /// end is at a boundary, and in the second and third where both ends are at one node.
    pub stamps: &'a [[u32; 4]],
    /// Position in `order` of every node; [`Plan::NOWHERE`] for a boundary.
    pub row_of: &'a [u32],
    /// Port and node of the one later neighbour of the first rows, the branches of trees, which have one at most;
    /// [`Plan::NOWHERE`] where there is none.
    pub leaves: &'a [[u32; 2]],
    /// For every entry of `ends`: twice its port, plus one at an outlet; the neighbour if it is held or eliminated
    /// before as a branch, else the number of nodes; and if not, the entry of the neighbour in the node's row, else
    /// [`Plan::NOWHERE`].
    pub terms: &'a [[u32; 3]],
    /// Rows behind the branches that have two later neighbours a and b at most: node; entries of a and b in its row; its own
    /// entries in the rows of a and of b; entry of b in the row of a and of a in the row of b; a and b. What does not exist
    /// stands one past the entries or nodes.
    pub series: &'a [Series],
    /// Lines with a volume inside or a drain, which have more than one flow. Their ports are two each, inlet and outlet,
    /// behind those of all segments; the port of any other line is its last segment.
    pub composite: &'a [u32],
    /// Points before and behind every segment: node n is point n, the volume behind segment s point nodes + s;
    /// [`Plan::NOWHERE`] twice where no volume stands between the segment and the next of its line.
    pub between: &'a [[u32; 2]],
}

/// Why connection tables were refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PlanError {
    /// The tables are not there, but the method needs them.
    Missing,
    /// The list of line ends of a node is not the one that follows from the lines.
    Ends(u32),
    /// The elimination order is not a permutation of the nodes with unknown pressure.
    Order,
    /// A row's pattern is not sorted, lacks an entry, or lacks fill.
    Pattern(u32),
    /// A line's stamps do not point at its entries.
    Stamp(u32),
    /// The list of lines with two ports is not the one that follows from the segments.
    Composite,
    /// The points of a segment are not those that follow from its line.
    Between(u32),
    /// A node's terms, or its only later neighbour, are not those that follow from lines and order.
    Term(u32),
    /// The rows with two later neighbours are not those that follow from order and pattern.
    Series,
}

impl Plan<'_> {
    /// Marks an entry that does not exist.
    pub const NOWHERE: u32 = u32::MAX;

    /// No tables: enough for the methods that sum by lines.
    pub const EMPTY: Plan<'static> = Plan {
        end_start: &[],
        ends: &[],
        order: &[],
        row_start: &[],
        columns: &[],
        diagonal: &[],
        stamps: &[],
        row_of: &[],
        leaves: &[],
        terms: &[],
        series: &[],
        composite: &[],
        between: &[],
    };

    /// Returns whether a line has a port at either end: where more than one flow belongs to it.
    pub fn is_composite<E: Element>(network: &Network<'_, E>, line: &Line) -> bool {
        let segments = network.segments_of(line);
        // The volume behind the last segment is the outlet node's.
        let inside = segments.split_last().map_or(segments, |(_, inside)| inside);
        segments.iter().any(|segment| segment.element.removal() > 0.0)
            || inside.iter().any(|segment| segment.outlet_volume_m3 > 0.0)
    }

    /// Calls `each` with every segment of `line` (counted over all lines) and the points around it, see
    /// [`Plan::between`].
    pub fn points_of<E: Element>(network: &Network<'_, E>, line: &Line, mut each: impl FnMut(u32, [u32; 2])) {
        let (first, nodes) = (line.first_segment, network.nodes.len() as u32);
        let mut before = line.from;
        for (index, segment) in (first..).zip(network.segments_of(line)) {
            let behind = nodes + index;
            if index + 1 == first + line.segments {
                each(index, [before, line.to]);
            } else if segment.outlet_volume_m3 > 0.0 {
                each(index, [before, behind]);
                before = behind;
            } else {
                each(index, [Self::NOWHERE; 2]);
            }
        }
    }

    /// Returns the port of a line's end, see [`Plan::composite`].
    pub fn port(&self, segments: usize, lines: &[Line], end: End) -> u32 {
        let line = end / 2;
        match self.composite.binary_search(&line) {
            Ok(place) => segments as u32 + 2 * place as u32 + end % 2,
            Err(_) => lines.get(line as usize).map_or(Self::NOWHERE, Line::last_segment),
        }
    }

    /// Returns what `terms` has for a node's end of a line.
    pub fn term(&self, nodes: &[Node], segments: usize, lines: &[Line], node: u32, end: End) -> [u32; 3] {
        let other = lines
            .get((end / 2) as usize)
            .map_or(Self::NOWHERE, |line| if end.is_multiple_of(2) { line.to } else { line.from });
        let row_of = |node: u32| self.row_of.get(node as usize).copied().unwrap_or(Self::NOWHERE);
        let (row, others) = (row_of(node), row_of(other));
        let held = others == Self::NOWHERE;
        let branch = others < row && (others as usize) < self.leaves.len();
        let port = 2 * self.port(segments, lines, end) + end % 2;
        if other == node {
            [port, nodes.len() as u32, Self::NOWHERE]
        } else if held || branch {
            [port, other, Self::NOWHERE]
        } else {
            [port, nodes.len() as u32, self.entry(row, others).unwrap_or(Self::NOWHERE)]
        }
    }

    /// Entry of a column in a row.
    fn entry(&self, row: u32, column: u32) -> Option<u32> {
        let (columns, first) = self.row(row as usize)?;
        columns.binary_search(&column).ok().map(|place| (first + place) as u32)
    }

    /// Returns what `series` has for a row; `None` for one with more later neighbours, or for one that does not exist.
    pub fn series_of(&self, row: usize) -> Option<Series> {
        let node = *self.order.get(row)?;
        let (_, upper) = self.sides(row);
        let later = self.columns.get(upper.clone())?;
        let (no_entry, no_node) = (self.columns.len() as u32, self.row_of.len() as u32);
        let node_of = |row| at(self.order, row);
        let between = |row, column| self.entry(row, column);
        let (own, first) = (row as u32, upper.start as u32);
        match *later {
            [] => Some([node, no_entry, no_entry, no_entry, no_entry, no_entry, no_entry, no_node, no_node]),
            [a] => {
                let back = between(a, own)?;
                Some([node, first, no_entry, back, no_entry, no_entry, no_entry, node_of(a), no_node])
            }
            [a, b] => {
                let (from_a, from_b) = (between(a, own)?, between(b, own)?);
                let (a_b, b_a) = (between(a, b)?, between(b, a)?);
                Some([node, first, first + 1, from_a, from_b, a_b, b_a, node_of(a), node_of(b)])
            }
            _ => None,
        }
    }

    /// The terms of a node.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn terms_of(&self, node: u32) -> &[[u32; 3]] {
        let bounds = self.end_start.get(node as usize..node as usize + 2);
        let Some(&[first, past]) = bounds else { return &[] };
        self.terms.get(first as usize..past as usize).unwrap_or(&[])
    }

    /// Entries before and behind the diagonal of a row.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub(crate) fn sides(&self, row: usize) -> (core::ops::Range<usize>, core::ops::Range<usize>) {
        let number = |list: &[u32], index: usize| list.get(index).copied().unwrap_or(0) as usize;
        let diagonal = number(self.diagonal, row);
        (number(self.row_start, row)..diagonal, diagonal + 1..number(self.row_start, row + 1))
    }

    /// Checks the lists of line ends against the lines.
    pub(crate) fn check_ends(&self, nodes: &[Node], lines: &[Line]) -> Result<(), PlanError> {
        if self.end_start.len() != nodes.len() + 1 || self.ends.len() != 2 * lines.len() {
            return Err(PlanError::Missing);
        }
        let mut next = 0;
        for ((node, pair), _) in (0u32..).zip(self.end_start.windows(2)).zip(nodes) {
            let [first, past] = *pair else { return Err(PlanError::Ends(node)) };
            let ends = self.ends.get(first as usize..past as usize).ok_or(PlanError::Ends(node))?;
            let belongs = |&end: &End| {
                let line = lines.get((end / 2) as usize);
                line.is_some_and(|line| node == if end % 2 == 0 { line.from } else { line.to })
            };
            let sorted = ends.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
            if first != next || !sorted || !ends.iter().all(belongs) {
                return Err(PlanError::Ends(node));
            }
            next = past;
        }
        // Every listed end belongs to its node and none is listed twice there, so the count settles the rest.
        if next as usize == self.ends.len() { Ok(()) } else { Err(PlanError::Ends(nodes.len() as u32)) }
    }

    /// Checks order, pattern and stamps of the elimination.
    pub(crate) fn check_elimination(&self, nodes: &[Node], lines: &[Line]) -> Result<(), PlanError> {
        let rows = self.order.len();
        if self.row_start.len() != rows + 1
            || self.diagonal.len() != rows
            || self.stamps.len() != lines.len()
            || self.row_of.len() != nodes.len()
        {
            return Err(PlanError::Missing);
        }
        let mut unknown = 0;
        for ((index, node), &row) in (0u32..).zip(nodes).zip(self.row_of) {
            let held = node.kind == NodeKind::Boundary;
            let placed = self.order.get(row as usize) == Some(&index);
            if held != (row == Self::NOWHERE) || (!held && !placed) {
                return Err(PlanError::Order);
            }
            unknown += usize::from(!held);
        }
        if unknown != rows || self.row_start.first() != Some(&0) {
            return Err(PlanError::Order);
        }
        for index in 0..rows {
            self.check_row(index).ok_or(PlanError::Pattern(index as u32))?;
        }
        let end = self.row_start.last().copied().unwrap_or(0);
        if end as usize != self.columns.len() {
            return Err(PlanError::Pattern(rows as u32));
        }
        for ((index, line), stamps) in (0u32..).zip(lines).zip(self.stamps) {
            self.check_stamps(line, *stamps).ok_or(PlanError::Stamp(index))?;
        }
        Ok(())
    }

    /// Checks ports, points and terms, once order and pattern are right.
    pub(crate) fn check_terms<E: Element>(&self, network: &Network<'_, E>) -> Result<(), PlanError> {
        let (nodes, lines, segments) = (network.nodes, network.lines, network.segments.len());
        if self.between.len() != segments || self.terms.len() != self.ends.len() {
            return Err(PlanError::Missing);
        }
        let composite =
            (0u32..).zip(lines).filter(|(_, line)| Self::is_composite(network, line)).map(|(index, _)| index);
        if !composite.eq(self.composite.iter().copied()) {
            return Err(PlanError::Composite);
        }
        for line in lines {
            let mut wrong = None;
            Self::points_of(network, line, |segment, points| {
                if self.between.get(segment as usize) != Some(&points) {
                    wrong = wrong.or(Some(segment));
                }
            });
            if let Some(segment) = wrong {
                return Err(PlanError::Between(segment));
            }
        }
        for node in 0..nodes.len() as u32 {
            let bounds = self.end_start.get(node as usize..node as usize + 2).unwrap_or(&[0, 0]);
            let ends = self.ends.get(bounds[0] as usize..bounds[1] as usize).unwrap_or(&[]);
            let terms = self.terms_of(node);
            let own = ends.iter().map(|&end| self.term(nodes, segments, lines, node, end));
            if !own.eq(terms.iter().copied()) {
                return Err(PlanError::Term(node));
            }
            let row = self.row_of.get(node as usize).copied().unwrap_or(Self::NOWHERE);
            if let Some(&leaf) = self.leaves.get(row as usize) {
                let mut later = terms.iter().filter(|[_, _, entry]| *entry != Self::NOWHERE);
                let one =
                    later.next().map(|&[port, _, entry]| [port / 2, at(self.order, at(self.columns, entry))]);
                if later.next().is_some() || one.unwrap_or([Self::NOWHERE; 2]) != leaf {
                    return Err(PlanError::Term(node));
                }
            }
        }
        let series = (self.leaves.len()..self.order.len()).map_while(|row| self.series_of(row));
        if series.eq(self.series.iter().copied()) { Ok(()) } else { Err(PlanError::Series) }
    }

    /// Columns of a row and the entry of the first.
    fn row(&self, row: usize) -> Option<(&[u32], usize)> {
        let (first, past) = (*self.row_start.get(row)? as usize, *self.row_start.get(row + 1)? as usize);
        Some((self.columns.get(first..past)?, first))
    }

    /// Sorted, with its diagonal, and closed under the fill of the rows that it is reduced by.
    fn check_row(&self, index: usize) -> Option<()> {
        let (row, first) = self.row(index)?;
        let sorted = row.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
        let in_range = row.last().is_some_and(|&last| (last as usize) < self.order.len());
        let diagonal = *self.diagonal.get(index)? as usize;
        let on_diagonal =
            row.get(diagonal.checked_sub(first)?).is_some_and(|&column| column as usize == index);
        if !(sorted && in_range && on_diagonal) {
            return None;
        }
        for &by in row.iter().take_while(|&&column| (column as usize) < index) {
            let (other, _) = self.row(by as usize)?;
            for column in other.iter().filter(|&&column| column > by) {
                row.binary_search(column).ok()?;
            }
        }
        Some(())
    }

    fn check_stamps(&self, line: &Line, stamps: [u32; 4]) -> Option<()> {
        let from = *self.row_of.get(line.from as usize)?;
        let to = *self.row_of.get(line.to as usize)?;
        for (entry, (row, column), crossing) in [
            (stamps[0], (from, from), false),
            (stamps[1], (from, to), true),
            (stamps[2], (to, from), true),
            (stamps[3], (to, to), false),
        ] {
            let absent = row == Self::NOWHERE || column == Self::NOWHERE || (crossing && from == to);
            if absent {
                (entry == Self::NOWHERE).then_some(())?;
                continue;
            }
            let (columns, first) = self.row(row as usize)?;
            let place = (entry as usize).checked_sub(first)?;
            (columns.get(place) == Some(&column)).then_some(())?;
        }
        Some(())
    }
}

fn at(list: &[u32], index: u32) -> u32 {
    list.get(index as usize).copied().unwrap_or(Plan::NOWHERE)
}
