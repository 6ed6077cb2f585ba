//! Eigenvalues as pictures.

use super::{Spectrum, SweepPoint};
use crate::Duration;
use crate::plot::style::{self, BLACK, BLUE, Colour, ORANGE, SKY, VERMILION};
use crate::plot::{Axis, ColourScale, Curve, Dash, Dots, Figure, Level, Mark, Note, Panel, Point};

/// How the input that moves is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Moving {
    /// Name, as in `valve opening`.
    pub name: String,
    /// Unit, as in `%`.
    pub unit: String,
    /// What values are multiplied by for that unit.
    pub factor: f64,
}

impl Moving {
    fn label(&self) -> String {
        format!("{} [{}]", self.name, self.unit)
    }

    /// Writes a value with its unit and about three digits.
    fn show(&self, value: f64) -> String {
        let unit = if self.unit == "1" { String::new() } else { format!(" {}", self.unit) };
        let value = value * self.factor;
        let digits = if value.abs() < 10.0 { 3 } else { 1 };
        format!("{value:.digits$}").trim_end_matches('0').trim_end_matches('.').to_owned() + &unit
    }
}

fn step_name(step_us: u32) -> String {
    Duration::from_us(u64::from(step_us)).to_string()
}

/// A circle on the real axis.
fn circle(centre: f64, radius: f64) -> Vec<Point> {
    let angle = |k: i32| (f64::from(k) * 0.5).to_radians();
    (0..=720).map(angle).map(|a| (centre + radius * a.cos(), radius * a.sin())).collect()
}

/// The complex plane with the unit circle.
fn plane(title: &str, (from, to): (f64, f64)) -> Panel {
    let real = Axis::linear("real part [1]", from, to);
    // Wide enough for the whole unit circle where the range is.
    let half = ((to - from) * 0.44).min(1.1);
    let mut panel = Panel::new(title, real, Axis::linear("imaginary part [1]", -half, half));
    panel.equal_units = true;
    panel.curves.push(Curve::new("unit circle", BLACK, Dash::Solid, circle(0.0, 1.0)));
    panel
}

/// Eigenvalues coloured by the input's value.
fn cloud(title: &str, points: &[SweepPoint], moving: &Moving, range: (f64, f64)) -> Panel {
    let mut panel = plane(title, range);
    let (first, last) = (points.first().map_or(0.0, |p| p.value), points.last().map_or(1.0, |p| p.value));
    let dots = points.iter().rev().flat_map(|point| {
        let colour = style::scale((point.value - first) / (last - first));
        point.eigenvalues.iter().map(move |value| ((value.re, value.im), colour))
    });
    panel.dots.push(Dots { label: String::new(), mark: Mark::Disc, radius: 3.0, points: dots.collect() });
    let (from, to) = (first * moving.factor, last * moving.factor);
    panel.colours = Some(ColourScale { label: moving.label(), from, to });
    panel
}

/// Eigenvalues in the complex plane without and with the operator, whole and near 1.
pub fn eigenvalue_figure(spectrum: &Spectrum, moving: &Moving, remarks: Vec<String>) -> Figure {
    let (plain, ours) = (&spectrum.plain, &spectrum.stabilised);
    let far = plain
        .iter()
        .flat_map(|point| point.eigenvalues.iter().map(|value| (value.re, point.value)))
        .fold((0.0f64, 0.0), |least, one| if one.0 < least.0 { one } else { least });
    let h = f64::from(spectrum.step_us) / 1e6;
    let near = (1.0 - 11.0 * h, 1.0 + 3.0 * h);
    let mut left = cloud("without φ", plain, moving, (-3.2, 1.4));
    if far.0 < -3.2 {
        let text = format!("← runs on to {:.0} at {}", far.0, moving.show(far.1)).replace('-', "−");
        left.notes.push(Note { at: (-3.2, 0.75), text, colour: style::INK });
    }
    let (first, last) = spectrum.range();
    Figure {
        title: format!(
            "Eigenvalues of one explicit step of {}, {} from {} to {}",
            step_name(spectrum.step_us),
            moving.name,
            moving.show(first),
            moving.show(last)
        ),
        panels: vec![
            left,
            cloud("with φ", ours, moving, (-1.25, 1.25)),
            cloud("without φ, near 1", plain, moving, near),
            cloud("with φ, near 1", ours, moving, near),
        ],
        columns: 2,
        panel_size: (520, 420),
        remarks,
    }
}

/// How a step's curves look: colours without and with φ, stroke, and width with φ. With φ all steps and the
/// limit lie close together, so what is drawn later is thinner and broken.
const LOOKS: [(Colour, Colour, Dash, f64); 2] =
    [(VERMILION, BLUE, Dash::Solid, 4.4), (ORANGE, SKY, Dash::Dashed, 2.0)];

/// Spectral radius over the input's value.
pub fn radius_panel(title: &str, spectra: &[&Spectrum], moving: &Moving) -> Panel {
    let all = spectra.iter().flat_map(|spectrum| spectrum.plain.iter().chain(&spectrum.stabilised));
    let top = all.map(|point| point.radius).fold(2.0, f64::max) * 1.4;
    let mut panel =
        Panel::new(title, across(spectra, moving), Axis::logarithmic("spectral radius [1]", 0.5, top));
    panel.levels.push(Level { value: 1.0, label: "limit of stability".into() });
    for (spectrum, (without, with, dash, width)) in spectra.iter().zip(LOOKS) {
        let curve = |points: &[SweepPoint]| -> Vec<Point> {
            points.iter().map(|point| (point.value * moving.factor, point.radius)).collect()
        };
        let step = step_name(spectrum.step_us);
        let plain = Curve::new(&format!("without φ, {step}"), without, dash, curve(&spectrum.plain));
        panel.curves.push(plain);
        let ours = Curve::new(&format!("with φ, {step}"), with, dash, curve(&spectrum.stabilised));
        panel.curves.push(Curve { width, ..ours });
    }
    panel
}

fn across(spectra: &[&Spectrum], moving: &Moving) -> Axis {
    let (first, last) = spectra.first().map_or((0.0, 1.0), |spectrum| spectrum.range());
    let from = if first > 0.0 && first < 0.1 * last { 0.0 } else { first };
    Axis::linear(&moving.label(), from * moving.factor, last * moving.factor)
}

/// Distance of the spectral radius from 1 with the operator.
fn margin_panel(spectra: &[&Spectrum], moving: &Moving) -> Panel {
    let margins = |spectrum: &Spectrum| -> Vec<Point> {
        let inside = spectrum.stabilised.iter().filter(|point| point.radius < 1.0);
        inside.map(|point| (point.value * moving.factor, 1.0 - point.radius)).collect()
    };
    let (low, high) = spectra
        .iter()
        .flat_map(|spectrum| margins(spectrum))
        .fold((1.0f64, 0.0f64), |(low, high), point| (low.min(point.1), high.max(point.1)));
    let decade = |value: f64, round: fn(f64) -> f64| 10f64.powf(round(value.max(1e-12).log10()));
    let (low, high) = (decade(low, f64::floor), decade(high.max(low * 10.0), f64::ceil));
    let mut panel =
        Panel::new("", across(spectra, moving), Axis::logarithmic("margin 1 − ρ with φ [1]", low, high));
    for (spectrum, (_, with, dash, _)) in spectra.iter().zip(LOOKS) {
        let label = format!("with φ, {}", step_name(spectrum.step_us));
        panel.curves.push(Curve::new(&label, with, dash, margins(spectrum)));
    }
    panel
}

/// Spectral radius over the input's value, with the margin that is left with the operator below.
pub fn radius_figure(spectra: &[&Spectrum], moving: &Moving, remarks: Vec<String>) -> Figure {
    let mut panel = radius_panel("", spectra, moving);
    for edge in spectra.iter().flat_map(|spectrum| &spectrum.edges) {
        let at = edge * moving.factor;
        let points = vec![((at, 1.0), BLACK)];
        panel.dots.push(Dots { label: String::new(), mark: Mark::Ring, radius: 5.0, points });
        panel.notes.push(Note { at: (at, 1.7), text: moving.show(*edge), colour: style::INK });
    }
    panel.y.from = 0.3;
    let close = "with φ: just below the limit at every step; the panel below shows by how much";
    let at = (panel.x.from + 0.02 * (panel.x.to - panel.x.from), 0.55);
    panel.notes.push(Note { at, text: close.into(), colour: style::INK });
    Figure {
        title: format!("Spectral radius ρ of one explicit step against {}", moving.name),
        panels: vec![panel, margin_panel(spectra, moving)],
        columns: 1,
        panel_size: (860, 380),
        remarks,
    }
}

/// Gershgorin's discs with the operator over the input's range.
pub fn disc_figure(spectrum: &Spectrum, moving: &Moving, remarks: Vec<String>) -> Figure {
    let points = &spectrum.stabilised;
    let last = points.len().saturating_sub(1);
    let chosen = [0, last / 6, last / 3, last].into_iter().filter_map(|index| points.get(index));
    let panel = |point: &SweepPoint| {
        let left = point.discs.iter().map(|disc| disc.centre - disc.radius).fold(-1.0, f64::min);
        let right = point.discs.iter().map(|disc| disc.centre + disc.radius).fold(1.0, f64::max);
        let room = (right - left) * 0.1;
        let title = format!("{} at {}", moving.name, moving.show(point.value));
        let mut panel = plane(&title, (left - room, right + room));
        for (index, disc) in point.discs.iter().enumerate() {
            let label = if index == 0 { "Gershgorin disc" } else { "" };
            panel.curves.push(Curve::new(label, BLUE, Dash::Dashed, circle(disc.centre, disc.radius)));
        }
        let points = point.eigenvalues.iter().map(|value| ((value.re, value.im), VERMILION)).collect();
        panel.dots.push(Dots { label: "eigenvalue".into(), mark: Mark::Cross, radius: 4.5, points });
        panel
    };
    let step = step_name(spectrum.step_us);
    Figure {
        title: format!("Gershgorin discs of one explicit step of {step} with φ, against {}", moving.name),
        panels: chosen.map(panel).collect(),
        columns: 2,
        panel_size: (520, 420),
        remarks,
    }
}
