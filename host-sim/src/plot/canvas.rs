//! A drawing surface in pixels with fractions, on the plotters SVG backend.

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontFamily, FontStyle, FontTransform, IntoFont, ShapeStyle, TextStyle};

use super::style::{Colour, FONT};

/// The backend counts whole units; one pixel is this many of them.
const FINE: i32 = 8;

/// The backend writes fonts smaller than asked for by this factor.
const FONT_FACTOR: f64 = 1.24;

/// The backend cannot fail on a string; a failure that comes nevertheless ends the drawing silently.
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Where a text sits relative to its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    /// Begins at the place.
    Start,
    /// Centred on it.
    Middle,
    /// Ends at it.
    End,
}

/// A text's looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub(super) px: i32,
    pub(super) colour: Colour,
    pub(super) anchor: Anchor,
    pub(super) bold: bool,
    pub(super) upwards: bool,
}

impl Pen {
    pub(super) const fn new(px: i32, colour: Colour, anchor: Anchor) -> Self {
        Self { px, colour, anchor, bold: false, upwards: false }
    }
}

/// The surface.
pub(super) struct Canvas<'t> {
    area: DrawingArea<SVGBackend<'t>, Shift>,
}

/// Draws with `draw` on a white surface of `size` [px] and returns the SVG.
pub(super) fn svg(size: (i32, i32), draw: impl FnOnce(&Canvas<'_>) -> Option<()>) -> String {
    let (width, height) = (size.0.max(1), size.1.max(1));
    let mut text = String::new();
    {
        let fine = ((width * FINE) as u32, (height * FINE) as u32);
        let area = SVGBackend::with_string(&mut text, fine).into_drawing_area();
        let canvas = Canvas { area };
        let _ = canvas.area.fill(&super::style::PAPER);
        let _ = draw(&canvas);
        let _ = canvas.area.present();
    }
    let fine_header = format!("<svg width=\"{}\" height=\"{}\"", width * FINE, height * FINE);
    text.replacen(&fine_header, &format!("<svg width=\"{width}\" height=\"{height}\""), 1)
}

fn fine(value: f64) -> i32 {
    (value * f64::from(FINE)).round().clamp(-1e8, 1e8) as i32
}

fn place((x, y): (f64, f64)) -> (i32, i32) {
    (fine(x), fine(y))
}

fn stroke(colour: Colour, width: f64) -> ShapeStyle {
    ShapeStyle { color: colour.into(), filled: false, stroke_width: fine(width).max(1) as u32 }
}

fn filled(colour: Colour) -> ShapeStyle {
    ShapeStyle { color: colour.into(), filled: true, stroke_width: 0 }
}

fn done(drawn: Drawn) -> Option<()> {
    drawn.ok()
}

impl Canvas<'_> {
    /// A line through points.
    pub(super) fn path(&self, points: &[(f64, f64)], colour: Colour, width: f64) -> Option<()> {
        let points: Vec<_> = points.iter().copied().map(place).collect();
        done(self.area.draw(&PathElement::new(points, stroke(colour, width))))
    }

    /// A line through points with strokes of `on` and gaps of `off` [px].
    pub(super) fn dashes(
        &self,
        points: &[(f64, f64)],
        colour: Colour,
        width: f64,
        (on, off): (f64, f64),
    ) -> Option<()> {
        let (mut pen_down, mut left) = (true, on);
        let mut piece: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
        for pair in points.windows(2) {
            let &[mut from, to] = pair else { continue };
            let mut length = (to.0 - from.0).hypot(to.1 - from.1);
            while length > left {
                let part = left / length;
                from = (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part);
                length -= left;
                if pen_down {
                    piece.push(from);
                    self.path(&piece, colour, width)?;
                }
                pen_down = !pen_down;
                left = if pen_down { on } else { off };
                piece = vec![from];
            }
            left -= length;
            piece.push(to);
        }
        if pen_down && piece.len() > 1 { self.path(&piece, colour, width) } else { Some(()) }
    }

    /// A filled rectangle.
    pub(super) fn block(&self, from: (f64, f64), to: (f64, f64), colour: Colour) -> Option<()> {
        done(self.area.draw(&Rectangle::new([place(from), place(to)], filled(colour))))
    }

    /// A rectangle's outline.
    pub(super) fn frame(&self, from: (f64, f64), to: (f64, f64), colour: Colour, width: f64) -> Option<()> {
        done(self.area.draw(&Rectangle::new([place(from), place(to)], stroke(colour, width))))
    }

    /// A circle, filled or as a line of 1.4 px.
    pub(super) fn circle(&self, at: (f64, f64), radius: f64, colour: Colour, full: bool) -> Option<()> {
        let style = if full { filled(colour) } else { stroke(colour, 1.4) };
        done(self.area.draw(&Circle::new(place(at), fine(radius), style)))
    }

    /// A text, vertically centred on its place.
    pub(super) fn text(&self, text: &str, at: (f64, f64), pen: Pen) -> Option<()> {
        if text.is_empty() {
            return Some(());
        }
        let size = f64::from(pen.px * FINE) * FONT_FACTOR;
        let family = FontFamily::Name(FONT);
        let style = if pen.bold { FontStyle::Bold } else { FontStyle::Normal };
        let font = (family, size, style).into_font();
        let font = if pen.upwards { font.transform(FontTransform::Rotate270) } else { font };
        let h_pos = match pen.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let style = TextStyle::from(font).color(&pen.colour).pos(Pos::new(h_pos, VPos::Center));
        done(self.area.draw(&Text::new(text.to_owned(), place(at), style)))
    }
}
