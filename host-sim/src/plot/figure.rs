//! What a picture says, apart from how it is drawn.

use super::clip::Point;
use super::style::Colour;

/// A picture: a title, panels side by side or below each other, and remarks.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Title over everything.
    pub title: String,
    /// Panels in reading order.
    pub panels: Vec<Panel>,
    /// Panels beside each other before the next row starts.
    pub columns: usize,
    /// Size of one panel with its labels [px].
    pub panel_size: (i32, i32),
    /// Remarks below the panels, one a line.
    pub remarks: Vec<String>,
}

/// One coordinate system with what is drawn in it, in drawing order: levels, curves, dots, notes.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Title over the panel; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Whether one unit is as long upwards as sideways; one of the ranges is then widened around its middle.
    pub equal_units: bool,
    /// Horizontal lines at fixed values.
    pub levels: Vec<Level>,
    /// Curves.
    pub curves: Vec<Curve>,
    /// Groups of dots.
    pub dots: Vec<Dots>,
    /// Short texts at a place.
    pub notes: Vec<Note>,
    /// Bar at the right that explains colours of dots.
    pub colours: Option<ColourScale>,
}

impl Panel {
    /// An empty panel.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            equal_units: false,
            levels: Vec::new(),
            curves: Vec::new(),
            dots: Vec::new(),
            notes: Vec::new(),
            colours: None,
        }
    }
}

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity with unit, as in `mass flow [g/s]`.
    pub label: String,
    /// Value at the left or lower end.
    pub from: f64,
    /// Value at the right or upper end.
    pub to: f64,
    /// Whether equal lengths are equal factors.
    pub logarithmic: bool,
}

impl Axis {
    /// An axis of equal steps.
    pub fn linear(label: &str, from: f64, to: f64) -> Self {
        Self { label: label.to_owned(), from, to, logarithmic: false }
    }

    /// An axis of equal factors; both ends must be > 0.
    pub fn logarithmic(label: &str, from: f64, to: f64) -> Self {
        Self { label: label.to_owned(), from, to, logarithmic: true }
    }

    /// An axis around `values` with some room, and at least `least` long.
    pub fn around(label: &str, values: impl Iterator<Item = f64>, least: f64) -> Self {
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let room = ((high - low) * 0.06).max((least - (high - low)) / 2.0).max(low.abs() * 1e-6);
        Self::linear(label, low - room, high + room)
    }

    /// The value as it is laid out.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }
}

/// How a curve is stroked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// Without gaps.
    Solid,
    /// Long strokes.
    Dashed,
    /// Short strokes.
    Dotted,
}

/// A curve through points.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Text in the legend; empty for none.
    pub label: String,
    /// Colour.
    pub colour: Colour,
    /// Stroke.
    pub dash: Dash,
    /// Width [px].
    pub width: f64,
    /// Points in order.
    pub points: Vec<Point>,
}

impl Curve {
    /// A curve of the usual width.
    pub fn new(label: &str, colour: Colour, dash: Dash, points: Vec<Point>) -> Self {
        Self { label: label.to_owned(), colour, dash, width: 2.0, points }
    }
}

/// Shape of a dot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Filled circle.
    Disc,
    /// Circle line.
    Ring,
    /// Diagonal cross.
    Cross,
}

/// A group of dots.
#[derive(Debug, Clone)]
pub struct Dots {
    /// Text in the legend; empty for none.
    pub label: String,
    /// Shape.
    pub mark: Mark,
    /// Radius [px].
    pub radius: f64,
    /// Places and colours.
    pub points: Vec<(Point, Colour)>,
}

/// A horizontal line across a panel.
#[derive(Debug, Clone)]
pub struct Level {
    /// Value on the y axis.
    pub value: f64,
    /// Text in the legend; empty for none.
    pub label: String,
}

/// A short text at a place, to its right.
#[derive(Debug, Clone)]
pub struct Note {
    /// Place in data units.
    pub at: Point,
    /// Text.
    pub text: String,
    /// Colour.
    pub colour: Colour,
}

/// A bar from [`super::style::scale`]'s first colour to its last.
#[derive(Debug, Clone)]
pub struct ColourScale {
    /// Quantity with unit.
    pub label: String,
    /// Value of the first colour.
    pub from: f64,
    /// Value of the last colour.
    pub to: f64,
}
