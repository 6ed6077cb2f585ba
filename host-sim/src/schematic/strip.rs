//! A line's elements side by side: the strip that stands between the nodes.
//!
//! A line that comes back to the side it left (a loop through a cabin) is folded once, so that both its ends are on
//! one side; a long one is folded twice.

use super::geometry::{At, GRID, Hang, Label, Rect, fit, text_width, up};
use super::graph::{Graph, Line};

/// Sizes that go with how much is to be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// Side of a glyph [px].
    pub glyph: i32,
    /// From glyph to glyph [px].
    pub pitch: i32,
    /// Height of ids of nodes [px].
    pub node_px: i32,
    /// Height of all other type [px].
    pub text_px: i32,
    /// Lines of type below a glyph for live values.
    pub values: i32,
    /// Most elements side by side.
    pub most: usize,
}

impl Style {
    /// For few elements: room for live values at each.
    pub const WIDE: Self = Self { glyph: 40, pitch: 100, node_px: 14, text_px: 12, values: 2, most: 6 };
    /// For many.
    pub const NARROW: Self = Self { glyph: 26, pitch: 60, node_px: 14, text_px: 12, values: 0, most: 5 };

    /// What suits a network.
    pub fn of(graph: &Graph) -> Self {
        if graph.elements() <= 16 && graph.nodes.len() <= 8 { Self::WIDE } else { Self::NARROW }
    }

    /// Height of a line of type [px].
    pub fn leading(&self) -> i32 {
        self.text_px + 3
    }

    /// From the top of a strip to the middle of its first row.
    fn first_row(&self) -> i32 {
        up(self.leading() + self.glyph / 2)
    }

    /// From row to row.
    pub fn row(&self) -> i32 {
        up(self.glyph + (1 + self.values) * self.leading() + 4)
    }
}

/// Which side of a strip faces which end of its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// In on the left, out on the right.
    Right,
    /// In on the right, out on the left.
    Left,
    /// Both ends on the left.
    BothLeft,
    /// Both ends on the right.
    BothRight,
}

/// Size of a strip and how its elements are spread over rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Ends.
    pub facing: Facing,
    /// Rows.
    pub rows: i32,
    /// Elements in a row.
    pub columns: i32,
    /// Width [px].
    pub width: i32,
    /// Height [px].
    pub height: i32,
}

/// Longest value that is written behind a line's id.
const FLOW_LETTERS: &str = "−1234.5 cfm";

impl Shape {
    /// Size of `line` with its ends on these sides.
    pub fn new(line: &Line, facing: Facing, style: Style) -> Self {
        let count = line.elements.len().max(1);
        let folded = matches!(facing, Facing::BothLeft | Facing::BothRight);
        let rows = if folded {
            // An even number, so that the last row comes back.
            count.div_ceil(style.most).div_ceil(2) * 2
        } else {
            let rows = count.div_ceil(style.most);
            rows | 1
        };
        let columns = count.div_ceil(rows) as i32;
        let rows = rows as i32;
        // Room to turn at the ends of rows.
        let turn = if rows > 1 { 2 * GRID } else { 0 };
        let title = text_width(&line.id, style.text_px).min(24 * style.text_px * 62 / 100);
        let title = title + text_width(FLOW_LETTERS, style.text_px) + style.text_px;
        let width = up((columns * style.pitch + 2 * turn).max(title));
        let height = style.first_row() + (rows - 1) * style.row() + style.row() - style.glyph / 2;
        Self { facing, rows, columns, width, height: up(height) }
    }

    /// Where the line enters and leaves a strip whose upper left corner is `at`.
    pub fn ports(&self, at: At, style: Style) -> (At, At) {
        let (left, right) = (at.x, at.x + self.width);
        let first = at.y + style.first_row();
        let last = first + (self.rows - 1) * style.row();
        match self.facing {
            Facing::Right => (At { x: left, y: first }, At { x: right, y: last }),
            Facing::Left => (At { x: right, y: first }, At { x: left, y: last }),
            Facing::BothLeft => (At { x: left, y: first }, At { x: left, y: last }),
            Facing::BothRight => (At { x: right, y: first }, At { x: right, y: last }),
        }
    }
}

/// An element at its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Glyph {
    /// Line.
    pub line: usize,
    /// Element within the line.
    pub element: usize,
    /// Middle.
    pub centre: At,
    /// Square of the symbol.
    pub rect: Rect,
    /// Whether the line runs to the left here.
    pub mirrored: bool,
    /// Name.
    pub label: Label,
    /// Room for live values.
    pub values: Vec<Label>,
}

/// A line's elements at their places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Strip {
    /// Room that it takes.
    pub rect: Rect,
    /// Elements.
    pub glyphs: Vec<Glyph>,
    /// Way from the inlet to the outlet, both included.
    pub path: Vec<At>,
    /// Id of the line.
    pub title: Label,
    /// Room for the line's flow.
    pub flow: Label,
}

impl Strip {
    /// Draws `line` (number `index`) in `shape` at `at`.
    pub fn new(line: &Line, index: usize, shape: Shape, at: At, style: Style) -> Self {
        let rect = Rect { x: at.x, y: at.y, width: shape.width, height: shape.height };
        let leftward = matches!(shape.facing, Facing::Left | Facing::BothRight);
        let (inlet, outlet) = shape.ports(at, style);
        let mut path = vec![inlet];
        let mut glyphs = Vec::new();
        let row_width = shape.columns * style.pitch;
        let first_x = up(at.x + (shape.width - row_width) / 2);
        for (element, entry) in line.elements.iter().enumerate() {
            let (row, place) = (element as i32 / shape.columns, element as i32 % shape.columns);
            let mirrored = leftward != (row % 2 == 1);
            let column = if mirrored { shape.columns - 1 - place } else { place };
            let centre = At {
                x: first_x + column * style.pitch + style.pitch / 2,
                y: at.y + style.first_row() + row * style.row(),
            };
            if place == 0 && row > 0 {
                let x = if mirrored { rect.right() - GRID } else { at.x + GRID };
                path.push(At { x, y: centre.y - style.row() });
                path.push(At { x, y: centre.y });
            }
            glyphs.push(glyph((index, element), entry, centre, mirrored, style));
        }
        let drawn = line.elements.len() as i32;
        let rows_drawn = ((drawn + shape.columns - 1) / shape.columns).max(1);
        if rows_drawn < shape.rows {
            // Rows without an element: the way goes through them all the same.
            for row in rows_drawn..shape.rows {
                let mirrored = leftward != (row % 2 == 1);
                let x = if mirrored { rect.right() - GRID } else { at.x + GRID };
                let y = at.y + style.first_row() + row * style.row();
                path.push(At { x, y: y - style.row() });
                path.push(At { x, y });
            }
        }
        path.push(outlet);
        let base = at.y + style.text_px;
        let flow_room = text_width(FLOW_LETTERS, style.text_px);
        let title_room = shape.width - flow_room - style.text_px / 2;
        let text = fit(&line.id, style.text_px, title_room);
        let room = text_width(&text, style.text_px);
        let title = Label { text, at: At { x: at.x, y: base }, hang: Hang::Start, px: style.text_px, room };
        let flow = Label {
            text: String::new(),
            at: At { x: rect.right(), y: base },
            hang: Hang::End,
            px: style.text_px,
            room: flow_room,
        };
        Self { rect, glyphs, path, title, flow }
    }
}

fn glyph(
    (line, element): (usize, usize),
    entry: &super::graph::Element,
    centre: At,
    mirrored: bool,
    style: Style,
) -> Glyph {
    let half = style.glyph / 2;
    let rect = Rect { x: centre.x - half, y: centre.y - half, width: style.glyph, height: style.glyph };
    let room = style.pitch - 4;
    let line_of_type = |number: i32, text: String| Label {
        text,
        at: At { x: centre.x, y: rect.bottom() + style.text_px + 1 + number * style.leading() },
        hang: Hang::Middle,
        px: style.text_px,
        room,
    };
    let label = line_of_type(0, fit(&entry.label, style.text_px, room));
    let values = (1..=style.values).map(|number| line_of_type(number, String::new())).collect();
    Glyph { line, element, centre, rect, mirrored, label, values }
}
