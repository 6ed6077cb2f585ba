//! The legend of a panel: rows of samples and names above it.

use super::canvas::{Anchor, Canvas, Pen};
use super::draw::{LINE, MARGIN, level_line, mark, stroke, title_height};
use super::figure::{Curve, Dots, Level, Panel};
use super::style::{self, INK, LABEL_PX};

/// Length of the sample of a curve [px].
const SAMPLE: f64 = 30.0;

/// One entry of a legend.
enum Entry<'p> {
    Level(&'p Level),
    Curve(&'p Curve),
    Dots(&'p Dots),
}

impl Entry<'_> {
    fn label(&self) -> &str {
        match self {
            Self::Level(level) => &level.label,
            Self::Curve(curve) => &curve.label,
            Self::Dots(dots) => &dots.label,
        }
    }

    fn width(&self) -> f64 {
        SAMPLE + 6.0 + f64::from(style::text_width(self.label(), LABEL_PX)) + 18.0
    }
}

/// The legend's entries in rows no wider than `width` [px].
fn rows(panel: &Panel, width: i32) -> Vec<Vec<Entry<'_>>> {
    let curves = panel.curves.iter().map(Entry::Curve);
    let entries = curves.chain(panel.dots.iter().map(Entry::Dots));
    let entries =
        entries.chain(panel.levels.iter().map(Entry::Level)).filter(|entry| !entry.label().is_empty());
    let mut rows: Vec<Vec<Entry<'_>>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in entries {
        let more = entry.width();
        if used + more > f64::from(width) {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += more;
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

/// Rows that the legend of `panel` takes within `width` [px].
pub(super) fn row_count(panel: &Panel, width: i32) -> usize {
    rows(panel, width).len()
}

/// Draws the legend of `panel`, whose plot area reaches from `left` to `right` and which begins at `outer`
/// (left, top, width).
pub(super) fn draw(
    canvas: &Canvas<'_>,
    panel: &Panel,
    (left, right): (f64, f64),
    outer: (i32, i32, i32),
) -> Option<()> {
    let top = outer.1 + title_height(panel);
    for (row, entries) in (0..).zip(rows(panel, outer.2 - 2 * MARGIN)) {
        let width: f64 = entries.iter().map(Entry::width).sum();
        let mut x = (f64::midpoint(left, right) - width / 2.0).max(f64::from(outer.0) + 8.0);
        let y = f64::from(top + row * LINE + LINE / 2);
        for entry in entries {
            match entry {
                Entry::Level(_) => level_line(canvas, &[(x, y), (x + SAMPLE, y)])?,
                Entry::Curve(curve) => stroke(canvas, &[(x, y), (x + SAMPLE, y)], curve)?,
                Entry::Dots(dots) => {
                    let colour = dots.points.first().map_or(INK, |point| point.1);
                    mark(canvas, dots.mark, (x + SAMPLE / 2.0, y), dots.radius.max(3.5), colour)?;
                }
            }
            let pen = Pen::new(LABEL_PX, INK, Anchor::Start);
            canvas.text(entry.label(), (x + SAMPLE + 6.0, y), pen)?;
            x += entry.width();
        }
    }
    Some(())
}
