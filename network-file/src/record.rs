//! Recorded points: names for everything that a run can write down.

use crate::loaded::{Loaded, Names};
use eclss_core::Line;

/// One column of a run's output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Record {
    /// Name in files and column heads, as in `valve.mass_flow`.
    pub name: String,
    /// What it is.
    pub quantity: Quantity,
}

/// What a recorded point is, by the core's indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Gauge pressure of a node [Pa].
    NodePressure {
        /// The node.
        node: usize,
    },
    /// Mass flow of a line at its flow segment [kg/s].
    LineFlow {
        /// The line.
        line: usize,
    },
    /// Mass flow at the inlet of a segment [kg/s].
    SegmentFlow {
        /// The line.
        line: usize,
        /// The segment, counted from the line's first.
        segment: usize,
    },
    /// Gauge pressure at the outlet of a segment [Pa].
    OutletPressure {
        /// The line.
        line: usize,
        /// The segment, counted from the line's first.
        segment: usize,
    },
    /// Value of an input, in the input's unit.
    Input {
        /// The slot.
        slot: usize,
    },
}

impl Quantity {
    /// Unit of the values; `1` for a ratio, as all inputs are.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::NodePressure { .. } | Self::OutletPressure { .. } => "Pa",
            Self::LineFlow { .. } | Self::SegmentFlow { .. } => "kg/s",
            Self::Input { .. } => "1",
        }
    }
}

impl Loaded {
    /// Everything that a run can write down: nodes, then lines with their elements, then inputs.
    pub fn all_records(&self) -> Vec<Record> {
        all(&self.names, &self.lines)
    }
}

/// All recordable points of a network.
pub(crate) fn all(names: &Names, lines: &[Line]) -> Vec<Record> {
    let record = |id: &str, what: &str, quantity| Record { name: format!("{id}.{what}"), quantity };
    let mut list = Vec::new();
    for (node, id) in names.nodes.iter().enumerate() {
        list.push(record(id, "pressure", Quantity::NodePressure { node }));
    }
    let mut elements = names.segments.iter();
    for (line, (id, data)) in names.lines.iter().zip(lines).enumerate() {
        list.push(record(id, "mass_flow", Quantity::LineFlow { line }));
        for (segment, id) in elements.by_ref().take(data.segments as usize).enumerate() {
            list.push(record(id, "mass_flow", Quantity::SegmentFlow { line, segment }));
            list.push(record(id, "outlet_pressure", Quantity::OutletPressure { line, segment }));
        }
    }
    for (slot, name) in names.inputs.iter().enumerate() {
        list.push(Record { name: name.clone(), quantity: Quantity::Input { slot } });
    }
    list
}
