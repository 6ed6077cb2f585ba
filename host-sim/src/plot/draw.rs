//! Lays a figure out and draws it.

use super::canvas::{self, Anchor, Canvas, Pen};
use super::clip::{Point, Window};
use super::figure::{Axis, Curve, Dash, Figure, Mark, Panel};
use super::legend;
use super::style::{self, Colour, FAINT_INK, GRID, INK, LABEL_PX, PANEL_PX, TICK_PX, TITLE_PX};
use super::ticks;

/// Room around everything [px].
pub(super) const MARGIN: i32 = 14;
/// Height of a line of remarks or legend [px].
pub(super) const LINE: i32 = 19;
/// Room for tick labels of a vertical axis, so that panels below each other begin at one place [px].
const LEAST_LABEL: i32 = 42;
/// Steps of colour in a bar.
const BANDS: i32 = 40;

/// A number of things as pixels are counted.
fn count(things: usize) -> i32 {
    i32::try_from(things).unwrap_or(i32::MAX)
}

impl Figure {
    /// Draws the figure.
    pub fn svg(&self) -> String {
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let rows = count(self.panels.len().div_ceil(columns));
        let (panel_width, panel_height) = self.panel_size;
        let head = TITLE_PX + 14;
        let width = 2 * MARGIN + count(columns) * panel_width;
        let foot = count(self.remarks.len()) * LINE;
        let height = 2 * MARGIN + head + rows * panel_height + foot;
        canvas::svg((width, height), |canvas| {
            // Bold letters are wider; a long title gets smaller ones.
            let wide = style::text_width(&self.title, TITLE_PX) * 115 / 100;
            let px = (TITLE_PX * (width - 2 * MARGIN) / wide.max(1)).min(TITLE_PX);
            let title = Pen { bold: true, ..Pen::new(px, INK, Anchor::Middle) };
            canvas.text(&self.title, (f64::from(width) / 2.0, f64::from(MARGIN + TITLE_PX / 2)), title)?;
            for (index, panel) in self.panels.iter().enumerate() {
                let left = MARGIN + count(index % columns) * panel_width;
                let top = MARGIN + head + count(index / columns) * panel_height;
                Frame::new(panel, left, top, self.panel_size).draw(canvas)?;
            }
            for (index, remark) in (0..).zip(&self.remarks) {
                let y = height - MARGIN - foot + index * LINE + LINE / 2;
                let pen = Pen::new(TICK_PX, FAINT_INK, Anchor::Start);
                canvas.text(remark, (f64::from(MARGIN + 6), f64::from(y)), pen)?;
            }
            Some(())
        })
    }
}

/// A panel with the place of its plot area on the canvas.
struct Frame<'p> {
    panel: &'p Panel,
    outer: (i32, i32, i32),
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    window: Window,
    y_ticks: Vec<(f64, String)>,
}

impl<'p> Frame<'p> {
    fn new(panel: &'p Panel, left: i32, top: i32, (width, height): (i32, i32)) -> Self {
        let title = title_height(panel);
        let legend = count(legend::row_count(panel, width - 2 * MARGIN)) * LINE;
        let y_ticks = axis_ticks(&panel.y, f64::from(height) / 40.0);
        let widest = y_ticks.iter().map(|(_, label)| style::text_width(label, TICK_PX)).max().unwrap_or(0);
        let widest = widest.max(LEAST_LABEL);
        let bar = if panel.colours.is_some() { 74 } else { 18 };
        let inner_left = f64::from(left + LABEL_PX + 20 + widest);
        let inner_right = f64::from(left + width - bar);
        let inner_top = f64::from(top + title + legend + 8);
        let inner_bottom = f64::from(top + height - 2 * LABEL_PX - 26);
        let mut window = Window {
            left: panel.x.place(panel.x.from),
            right: panel.x.place(panel.x.to),
            bottom: panel.y.place(panel.y.from),
            top: panel.y.place(panel.y.to),
        };
        let mut y_ticks = y_ticks;
        if panel.equal_units {
            let middle = f64::midpoint(window.bottom, window.top);
            let shape = (inner_bottom - inner_top) / (inner_right - inner_left);
            let (wide, high) = ((window.right - window.left) / 2.0, (window.top - window.bottom) / 2.0);
            // The given range is the least that is shown.
            let high = high.max(wide * shape);
            let (wide, across) = (high / shape, f64::midpoint(window.left, window.right));
            (window.left, window.right) = (across - wide, across + wide);
            (window.bottom, window.top) = (middle - high, middle + high);
            let axis = Axis { from: window.bottom, to: window.top, ..panel.y.clone() };
            y_ticks = axis_ticks(&axis, f64::from(height) / 40.0);
        }
        Self {
            panel,
            outer: (left, top, width),
            left: inner_left,
            right: inner_right,
            top: inner_top,
            bottom: inner_bottom,
            window,
            y_ticks,
        }
    }

    /// Pixel of a point given as it is laid out.
    fn pixel(&self, (x, y): Point) -> (f64, f64) {
        let part_x = (x - self.window.left) / (self.window.right - self.window.left);
        let part_y = (y - self.window.bottom) / (self.window.top - self.window.bottom);
        (self.left + part_x * (self.right - self.left), self.bottom - part_y * (self.bottom - self.top))
    }

    fn laid_out(&self, (x, y): Point) -> Point {
        (self.panel.x.place(x), self.panel.y.place(y))
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Option<()> {
        self.grid(canvas)?;
        for level in &self.panel.levels {
            let y = self.panel.y.place(level.value);
            if !(self.window.bottom..=self.window.top).contains(&y) {
                continue;
            }
            let ends = [self.pixel((self.window.left, y)), self.pixel((self.window.right, y))];
            level_line(canvas, &ends)?;
        }
        for curve in &self.panel.curves {
            self.curve(canvas, curve)?;
        }
        for dots in &self.panel.dots {
            for &(point, colour) in &dots.points {
                let point = self.laid_out(point);
                if self.window.holds(point) {
                    mark(canvas, dots.mark, self.pixel(point), dots.radius, colour)?;
                }
            }
        }
        for note in &self.panel.notes {
            let (x, y) = self.pixel(self.laid_out(note.at));
            canvas.text(&note.text, (x + 7.0, y), Pen::new(TICK_PX, note.colour, Anchor::Start))?;
        }
        canvas.frame((self.left, self.top), (self.right, self.bottom), INK, 1.0)?;
        self.titles(canvas)?;
        legend::draw(canvas, self.panel, (self.left, self.right), self.outer)?;
        self.colour_bar(canvas)
    }

    fn grid(&self, canvas: &Canvas<'_>) -> Option<()> {
        let mut x_axis = self.panel.x.clone();
        if self.panel.equal_units {
            (x_axis.from, x_axis.to) = (self.window.left, self.window.right);
        }
        for (value, label) in axis_ticks(&x_axis, (self.right - self.left) / 64.0) {
            let (x, y) = self.pixel((value, self.window.bottom));
            canvas.path(&[(x, y), (x, self.top)], GRID, 1.0)?;
            canvas.path(&[(x, y), (x, y + 4.0)], INK, 1.0)?;
            canvas.text(&label, (x, y + 14.0), Pen::new(TICK_PX, FAINT_INK, Anchor::Middle))?;
        }
        for (value, label) in &self.y_ticks {
            let (x, y) = self.pixel((self.window.left, *value));
            canvas.path(&[(x, y), (self.right, y)], GRID, 1.0)?;
            canvas.path(&[(x - 4.0, y), (x, y)], INK, 1.0)?;
            canvas.text(label, (x - 8.0, y), Pen::new(TICK_PX, FAINT_INK, Anchor::End))?;
        }
        Some(())
    }

    fn curve(&self, canvas: &Canvas<'_>, curve: &Curve) -> Option<()> {
        let points: Vec<_> = curve.points.iter().map(|point| self.laid_out(*point)).collect();
        for piece in self.window.clip(&points) {
            let piece: Vec<_> = piece.into_iter().map(|point| self.pixel(point)).collect();
            stroke(canvas, &piece, curve)?;
        }
        Some(())
    }

    fn titles(&self, canvas: &Canvas<'_>) -> Option<()> {
        let middle = f64::midpoint(self.left, self.right);
        let label = Pen::new(LABEL_PX, INK, Anchor::Middle);
        let title = Pen { bold: true, ..Pen::new(PANEL_PX, INK, Anchor::Middle) };
        canvas.text(&self.panel.title, (middle, f64::from(self.outer.1 + PANEL_PX / 2 + 1)), title)?;
        canvas.text(&self.panel.x.label, (middle, self.bottom + 34.0), label)?;
        let upwards = Pen { upwards: true, ..label };
        let x = f64::from(self.outer.0 + LABEL_PX / 2 + 2);
        canvas.text(&self.panel.y.label, (x, f64::midpoint(self.top, self.bottom)), upwards)
    }

    fn colour_bar(&self, canvas: &Canvas<'_>) -> Option<()> {
        let Some(colours) = &self.panel.colours else { return Some(()) };
        let (left, right) = (self.right + 14.0, self.right + 26.0);
        let (top, bottom) = (self.top + 24.0, self.bottom);
        for band in 0..BANDS {
            let y = |k: i32| bottom - (bottom - top) * f64::from(k) / f64::from(BANDS);
            let colour = style::scale((f64::from(band) + 0.5) / f64::from(BANDS));
            // A little longer than its share, so that no seam shows.
            canvas.block((left, y(band + 1)), (right, (y(band) + 1.0).min(bottom)), colour)?;
        }
        let pen = Pen::new(TICK_PX, FAINT_INK, Anchor::Start);
        for (value, label) in ticks::linear(colours.from, colours.to, 5) {
            let y = bottom - (bottom - top) * (value - colours.from) / (colours.to - colours.from);
            canvas.text(&label, (right + 5.0, y), pen)?;
        }
        canvas.text(&colours.label, (f64::from(self.outer.0 + self.outer.2) - 4.0, self.top + 4.0), {
            Pen { anchor: Anchor::End, colour: INK, ..pen }
        })
    }
}

/// Height of a panel's title [px].
pub(super) fn title_height(panel: &Panel) -> i32 {
    if panel.title.is_empty() { 0 } else { PANEL_PX + 9 }
}

fn axis_ticks(axis: &Axis, wanted: f64) -> Vec<(f64, String)> {
    let wanted = wanted.max(2.0) as usize;
    if axis.logarithmic {
        ticks::decades(axis.place(axis.from), axis.place(axis.to), wanted)
    } else {
        ticks::linear(axis.from, axis.to, wanted)
    }
}

pub(super) fn level_line(canvas: &Canvas<'_>, ends: &[(f64, f64)]) -> Option<()> {
    canvas.dashes(ends, style::BLACK, 1.2, (7.0, 4.0))
}

pub(super) fn stroke(canvas: &Canvas<'_>, points: &[(f64, f64)], curve: &Curve) -> Option<()> {
    match curve.dash {
        Dash::Solid => canvas.path(points, curve.colour, curve.width),
        Dash::Dashed => canvas.dashes(points, curve.colour, curve.width, (8.0, 4.0)),
        Dash::Dotted => canvas.dashes(points, curve.colour, curve.width, (2.5, 3.0)),
    }
}

pub(super) fn mark(
    canvas: &Canvas<'_>,
    mark: Mark,
    (x, y): (f64, f64),
    r: f64,
    colour: Colour,
) -> Option<()> {
    match mark {
        Mark::Disc => canvas.circle((x, y), r, colour, true),
        Mark::Ring => canvas.circle((x, y), r, colour, false),
        Mark::Cross => {
            canvas.path(&[(x - r, y - r), (x + r, y + r)], colour, 1.8)?;
            canvas.path(&[(x - r, y + r), (x + r, y - r)], colour, 1.8)
        }
    }
}
