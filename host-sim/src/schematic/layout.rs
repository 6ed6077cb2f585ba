//! Puts a drawing together: columns of nodes with columns of strips between them, then wires.
//!
//! The sheet is a grid of cells that hold one node each; between two columns of nodes, and at both margins, strips are
//! piled up beside each row. What is placed cannot overlap; whether every wire finds a way is tried, with more room
//! between things from try to try.

use std::cell::Cell;

use super::geometry::{At, GRID, Hang, Label, Rect, fit, text_width, up};
use super::graph::{Graph, MOST_NODES};
use super::place::{Cell as Place, places};
use super::strip::{Facing, Shape, Strip, Style};

/// Tries with more and more room.
const TRIES: i32 = 6;
/// Layouts that are drawn to choose one: as many as come to this number of lines, and at most so many.
const DRAWN: usize = 400;
const MOST_LAYOUTS: usize = 24;
/// Layouts that are tried again with more room, where none found all its ways.
const AGAIN: usize = 3;
/// Points that all searches for ways look at, at most: some seconds.
const EFFORT: u64 = 20_000_000;
/// Room around everything [px].
const MARGIN: i32 = 2 * GRID;

/// A node at its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeBox {
    /// Room that it takes.
    pub rect: Rect,
    /// Id.
    pub title: Label,
    /// Room for a remark, or a live pressure.
    pub first: Label,
    /// Room for live temperature and humidity.
    pub second: Label,
}

/// A network, drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    /// Width [px].
    pub width: i32,
    /// Height [px].
    pub height: i32,
    /// Sizes.
    pub style: Style,
    /// Nodes in file order.
    pub nodes: Vec<NodeBox>,
    /// Strips in the order of lines.
    pub strips: Vec<Strip>,
    /// Way of every line from node to node, through its strip.
    pub wires: Vec<Vec<At>>,
}

/// Why a network is not drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawingError {
    /// More nodes than are laid out.
    TooLarge {
        /// Nodes of the network.
        nodes: usize,
    },
    /// Finding ways takes too long.
    TooCrowded {
        /// Lines of the network.
        lines: usize,
    },
    /// No way was found for the wire of this line.
    NoWay {
        /// The line.
        line: usize,
    },
}

impl DrawingError {
    /// What is wrong, with ids.
    pub fn text(&self, graph: &Graph) -> String {
        match self {
            Self::TooLarge { nodes } => {
                format!("{nodes} nodes are too many for a drawing; up to {MOST_NODES} are laid out")
            }
            Self::TooCrowded { lines } => {
                format!("{lines} lines between so few nodes are too crowded for a drawing")
            }
            Self::NoWay { line } => {
                let id = graph.lines.get(*line).map_or("?", |line| line.id.as_str());
                format!("no way was found for line `{id}`; give its nodes other positions")
            }
        }
    }
}

/// Where a strip is piled up: the gap left of this column (as many as there are columns: right of the last), row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pile {
    gap: i32,
    row: i32,
}

impl Drawing {
    /// Draws a network.
    pub fn new(graph: &Graph) -> Result<Self, DrawingError> {
        let nodes = graph.nodes.len();
        if nodes > MOST_NODES {
            return Err(DrawingError::TooLarge { nodes });
        }
        let style = Style::of(graph);
        let most = (DRAWN / graph.lines.len().max(1)).clamp(1, MOST_LAYOUTS);
        let layouts: Vec<_> = places(graph)
            .into_iter()
            .take(most)
            .map(|cells| {
                let (piles, shapes) = pile_up(graph, &cells, style);
                (cells, piles, shapes)
            })
            .collect();
        let mut failed = DrawingError::NoWay { line: 0 };
        let effort = &Cell::new(EFFORT);
        for room in 0..TRIES {
            let mut best: Option<(i64, Self)> = None;
            let tried = if room == 0 { layouts.len() } else { AGAIN };
            for (cells, piles, shapes) in layouts.iter().take(tried) {
                match (Sheet { graph, style, cells, piles, shapes, room, effort }).draw() {
                    Ok(drawing) => {
                        let strain = drawing.strain(shapes.iter().map(|shape| shape.facing));
                        if best.as_ref().is_none_or(|(least, _)| strain < *least) {
                            best = Some((strain, drawing));
                        }
                    }
                    Err(error @ DrawingError::TooCrowded { .. }) => {
                        return best.map(|(_, drawing)| drawing).ok_or(error);
                    }
                    Err(error) => failed = error,
                }
            }
            if let Some((_, drawing)) = best {
                return Ok(drawing);
            }
        }
        Err(failed)
    }
}

/// Chooses a pile and a shape for every line, short ways and low piles first.
fn pile_up(graph: &Graph, cells: &[Place], style: Style) -> (Vec<Pile>, Vec<Shape>) {
    let columns = cells.iter().map(|cell| cell.0).max().unwrap_or(0) + 1;
    let rows = cells.iter().map(|cell| cell.1).max().unwrap_or(0) + 1;
    let mut heights = vec![0; ((columns + 1) * rows) as usize];
    let mut order: Vec<usize> = (0..graph.lines.len()).collect();
    let far = |line: usize| {
        let (from, to) = (cells[graph.lines[line].from], cells[graph.lines[line].to]);
        (from.0 - to.0).abs() + (from.1 - to.1).abs()
    };
    // Lines with the least choice choose first: neighbours, then loops, then the rest.
    order.sort_by_key(|line| (far(*line) != 1, far(*line), *line));
    let unset = Pile { gap: 0, row: 0 };
    let mut piles = vec![unset; graph.lines.len()];
    let mut shapes = Vec::new();
    for line in order {
        let entry = &graph.lines[line];
        let (from, to) = (cells[entry.from], cells[entry.to]);
        let candidates = (0..=columns).flat_map(|gap| (0..rows).map(move |row| Pile { gap, row }));
        let best = candidates.min_by_key(|pile| {
            let shape = Shape::new(entry, facing(from.0, to.0, pile.gap), style);
            let height = heights[(pile.gap * rows + pile.row) as usize];
            // A gap lies half a column left of its column.
            let aside = |cell: Place| (2 * (pile.gap - cell.0) - 1).abs() - 1;
            let off = |cell: Place| 3 * (pile.row - cell.1).abs();
            let margin = i32::from(columns > 1 && (pile.gap == 0 || pile.gap == columns));
            let way = aside(from) + aside(to) + off(from) + off(to);
            // Of two equal gaps the right one, so that a single loop lies right of its cabin.
            (120 * way + 2 * (height + shape.height) + 150 * margin, -pile.gap, pile.row)
        });
        let pile = best.unwrap_or(unset);
        let shape = Shape::new(entry, facing(from.0, to.0, pile.gap), style);
        heights[(pile.gap * rows + pile.row) as usize] += shape.height;
        piles[line] = pile;
        shapes.push((line, shape));
    }
    shapes.sort_by_key(|(line, _)| *line);
    (piles, shapes.into_iter().map(|(_, shape)| shape).collect())
}

/// Which way a strip in `gap` faces for a line between these columns.
fn facing(from: i32, to: i32, gap: i32) -> Facing {
    match (from < gap, to < gap) {
        (true, true) => Facing::BothLeft,
        (true, false) => Facing::Right,
        (false, true) => Facing::Left,
        (false, false) => Facing::BothRight,
    }
}

/// Everything that a try needs.
pub(super) struct Sheet<'g> {
    pub(super) graph: &'g Graph,
    style: Style,
    cells: &'g [Place],
    piles: &'g [Pile],
    shapes: &'g [Shape],
    /// How much wider than usual the spaces between things are.
    room: i32,
    /// Points that the searches of all tries may still look at.
    pub(super) effort: &'g Cell<u64>,
}

impl Sheet<'_> {
    fn draw(&self) -> Result<Drawing, DrawingError> {
        let columns = self.cells.iter().map(|cell| cell.0).max().unwrap_or(0) + 1;
        let rows = self.cells.iter().map(|cell| cell.1).max().unwrap_or(0) + 1;
        // A channel for wires on either side of a column of nodes, and between strips.
        let channel = GRID * (3 + 2 * self.room) + GRID * (self.graph.lines.len() as i32 / 16).min(8);
        let between = GRID * (2 + self.room);
        let sizes: Vec<_> = (0..self.graph.nodes.len()).map(|node| self.node_size(node)).collect();

        let mut left = MARGIN;
        let mut gap_x = Vec::new();
        let mut node_x = Vec::new();
        for gap in 0..=columns {
            let widths = self.in_gap(gap).map(|line| self.shapes[line].width);
            let width = widths.max().unwrap_or(0);
            let room = if width > 0 { width + channel } else { 0 };
            gap_x.push((left, width));
            left += if gap == 0 || gap == columns { room } else { room + channel };
            if gap > 0 && gap < columns {
                gap_x[gap as usize].0 += channel;
            }
            if gap == columns && width > 0 {
                gap_x[gap as usize].0 += channel;
            }
            if gap < columns {
                let cells = self.cells.iter().zip(&sizes).filter(|(cell, _)| cell.0 == gap);
                let width = cells.map(|(_, size)| size.0).max().unwrap_or(0);
                node_x.push((left, width));
                left += width;
            }
        }
        let width = left + MARGIN;

        // Wires also run between rows; below the last one there are few.
        let channel = between + GRID * (self.graph.lines.len() as i32 / 14).min(6);
        let mut top = MARGIN;
        let mut bands = Vec::new();
        for row in 0..rows {
            let piles = (0..=columns).map(|gap| self.pile_height(gap, row, between));
            let nodes = self.cells.iter().zip(&sizes).filter(|(cell, _)| cell.1 == row);
            let height = piles.chain(nodes.map(|(_, size)| size.1)).max().unwrap_or(0);
            bands.push((top, height));
            top += height + channel;
        }
        let height = top - channel + MARGIN + between;

        let middle = |start: i32, room: i32, size: i32| start + (room - size) / 2 / GRID * GRID;
        let mut nodes = Vec::new();
        for (node, cell) in self.cells.iter().enumerate() {
            let ((x, room), (y, band)) = (node_x[cell.0 as usize], bands[cell.1 as usize]);
            let size = sizes[node];
            nodes.push(self.node_box(
                node,
                At { x: middle(x, room, size.0), y: middle(y, band, size.1) },
                size,
            ));
        }
        let mut strips: Vec<Option<Strip>> = vec![None; self.graph.lines.len()];
        for gap in 0..=columns {
            for row in 0..rows {
                let ((x, room), (y, band)) = (gap_x[gap as usize], bands[row as usize]);
                let mut y = middle(y, band, self.pile_height(gap, row, between));
                for line in self.in_gap(gap).filter(|line| self.piles[*line].row == row) {
                    let shape = self.shapes[line];
                    let at = At { x: middle(x, room, shape.width), y };
                    strips[line] = Some(Strip::new(&self.graph.lines[line], line, shape, at, self.style));
                    y += shape.height + between;
                }
            }
        }
        let strips: Vec<Strip> = strips.into_iter().flatten().collect();
        let wires = self.wires(width, height, &nodes, &strips)?;
        Ok(Drawing { width, height, style: self.style, nodes, strips, wires })
    }

    fn in_gap(&self, gap: i32) -> impl Iterator<Item = usize> {
        (0..self.piles.len()).filter(move |line| self.piles[*line].gap == gap)
    }

    fn pile_height(&self, gap: i32, row: i32, between: i32) -> i32 {
        let lines = self.in_gap(gap).filter(|line| self.piles[*line].row == row);
        (lines.map(|line| self.shapes[line].height + between).sum::<i32>() - between).max(0)
    }

    /// Width and height of a node [px]: for its texts, and for the wires that end at it.
    fn node_size(&self, node: usize) -> (i32, i32) {
        let entry = &self.graph.nodes[node];
        let ends: i32 = self
            .graph
            .lines
            .iter()
            .map(|line| i32::from(line.from == node) + i32::from(line.to == node))
            .sum();
        let style = self.style;
        let least = if entry.kind == "junction" { 40 } else { 12 * style.text_px * 62 / 100 + 2 * GRID };
        let text = text_width(&entry.id, style.node_px).min(20 * style.node_px * 62 / 100) + GRID;
        let lines = if entry.kind == "junction" { 1 } else { 3 };
        let texts = style.node_px + 4 + (lines - 1) * style.leading() + GRID;
        // Both ends of a folded strip run straight into it.
        let loops = self.graph.lines.iter().any(|line| line.from == node && line.to == node);
        let rows = if loops { style.row() + 4 * GRID } else { 0 };
        (up(least.max(text)), up(texts.max(rows).max(up(GRID * ends) + 2 * GRID)))
    }

    fn node_box(&self, node: usize, at: At, size: (i32, i32)) -> NodeBox {
        let (entry, style) = (&self.graph.nodes[node], self.style);
        let rect = Rect { x: at.x, y: at.y, width: size.0, height: size.1 };
        let lines = if entry.kind == "junction" { 1 } else { 3 };
        let texts = style.node_px + (lines - 1) * style.leading();
        let base = at.y + (size.1 - texts) / 2 + style.node_px - 2;
        let line = |number: i32, px: i32, text: &str| Label {
            text: fit(text, px, size.0 - 8),
            at: At { x: at.x + size.0 / 2, y: base + number * style.leading() },
            hang: Hang::Middle,
            px,
            room: size.0 - 8,
        };
        NodeBox {
            rect,
            title: line(0, style.node_px, &entry.id),
            first: line(1, style.text_px, &entry.remark),
            second: line(2, style.text_px, ""),
        }
    }
}
