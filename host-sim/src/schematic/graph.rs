//! What is drawn of a network: ids, kinds and connections, without any physics.

use eclss_network_file::document::{NetworkFile, NodeEntryKind};

/// Most nodes that are laid out; the search for a way grows with the area of the drawing.
pub const MOST_NODES: usize = 256;

/// A node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Node {
    /// Id.
    pub id: String,
    /// Kind as in the file.
    pub kind: &'static str,
    /// What is written below its id where nothing lives: volume, or the pressure at which it is held.
    pub remark: String,
    /// Column and row that the file asks for.
    pub position: Option<(u32, u32)>,
}

/// An element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Id.
    pub id: String,
    /// Id without what it shares with its line's.
    pub label: String,
    /// Kind as in the file; one that has no glyph is drawn as a box with its name.
    pub kind: String,
    /// Whether it has an input that can be moved.
    pub active: bool,
}

/// A line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Id.
    pub id: String,
    /// Node at the inlet.
    pub from: usize,
    /// Node at the outlet.
    pub to: usize,
    /// Elements in the direction of flow.
    pub elements: Vec<Element>,
}

/// Everything that is drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Graph {
    /// Name of the network, or its title.
    pub title: String,
    /// Nodes in file order.
    pub nodes: Vec<Node>,
    /// Lines in file order.
    pub lines: Vec<Line>,
}

impl Graph {
    /// Takes out of an accepted file what is drawn.
    pub fn of(file: &NetworkFile) -> Self {
        let place = |id: &str| file.nodes.iter().position(|node| node.id == id).unwrap_or(0);
        let nodes = file.nodes.iter().map(|node| {
            let (kind, remark) = match node.kind {
                NodeEntryKind::Cabin { volume_m3 } => ("cabin", format!("{volume_m3} m³")),
                NodeEntryKind::Liquid { volume_m3, .. } => ("liquid", format!("{} l", volume_m3 * 1e3)),
                NodeEntryKind::Accumulator { volume_m3, .. } => {
                    ("accumulator", format!("{} l", volume_m3 * 1e3))
                }
                NodeEntryKind::Junction => ("junction", String::new()),
                NodeEntryKind::Boundary => ("boundary", format!("{:.3} kPa", node.pressure_pa * 1e-3)),
            };
            Node { id: node.id.clone(), kind, remark, position: node.position }
        });
        let lines = file.lines.iter().map(|line| Line {
            id: line.id.clone(),
            from: place(&line.from),
            to: place(&line.to),
            elements: line.elements.iter().map(|entry| Element::of(&line.id, entry)).collect(),
        });
        Self {
            title: file.title.clone().unwrap_or_else(|| file.name.clone()),
            nodes: nodes.collect(),
            lines: lines.collect(),
        }
    }

    /// Number of elements in all lines.
    pub fn elements(&self) -> usize {
        self.lines.iter().map(|line| line.elements.len()).sum()
    }
}

impl Element {
    fn of(line: &str, entry: &eclss_network_file::document::ElementEntry) -> Self {
        let kind = entry.entry.kind.name().to_owned();
        let short = entry.id.strip_prefix(line).map(|rest| rest.trim_start_matches('_'));
        let label = short.filter(|rest| !rest.is_empty()).unwrap_or(&entry.id).to_owned();
        let active = !matches!(
            kind.as_str(),
            "pipe"
                | "reference_pipe"
                | "heat_exchanger"
                | "bed"
                | "condenser"
                | "coolant_side"
                | "interface_exchanger"
                | "heater"
        );
        Self { id: entry.id.clone(), label, kind, active }
    }
}
