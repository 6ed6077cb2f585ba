//! What the paper's figures show, drawn from our own results.

use super::printed::AMESIM_G_S;
use super::{Reference, Results, Run, Spectrum};
use crate::Duration;
use crate::linear::SweepPoint;
use crate::plot::style::{self, BLACK, BLUE, VERMILION};
use crate::plot::{Axis, ColourScale, Curve, Dash, Dots, Figure, Level, Mark, Note, Panel, Point, thin};

/// A drawn figure and the name of its file.
#[derive(Debug, Clone)]
pub struct Picture {
    /// File name.
    pub file: String,
    /// SVG.
    pub svg: String,
}

const PSEUDO_TIME: &str =
    "Transients of this method are pseudo-time, not physics; only its steady states are.";
const NOT_THE_PAPERS: &str = "Computed by this program; not copied from the paper's figures.";

fn step_name(step_us: u32) -> String {
    Duration::from_us(u64::from(step_us)).to_string()
}

/// Draws everything that the paper's figures 4 to 8 show.
pub fn pictures(results: &Results) -> Vec<Picture> {
    let mut list = Vec::new();
    for spectrum in &results.spectra {
        let step = spectrum.step_us / 1_000;
        list.push(Picture { file: format!("eigenvalues_{step}ms.svg"), svg: eigenvalues(spectrum).svg() });
    }
    list.push(Picture { file: "spectral_radius.svg".into(), svg: radius(&results.spectra).svg() });
    list.push(Picture { file: "flow_operator.svg".into(), svg: with_and_without(results).svg() });
    for (run, errors) in results.relaxation.iter().zip(&results.transient_errors) {
        let step = run.settings.step_us / 1_000;
        let file = format!("flow_reference_{step}ms.svg");
        list.push(Picture { file, svg: against_reference(run, errors).svg() });
    }
    list
}

/// One view of the complex plane.
fn plane(title: &str, points: &[SweepPoint], (from, to): (f64, f64)) -> Panel {
    let real = Axis::linear("real part [1]", from, to);
    let mut panel = Panel::new(title, real, Axis::linear("imaginary part [1]", -1.0, 1.0));
    panel.equal_units = true;
    let circle = (0..=720).map(|k| (f64::from(k) * 0.5).to_radians()).map(|a| (a.cos(), a.sin())).collect();
    panel.curves.push(Curve::new("unit circle", BLACK, Dash::Solid, circle));
    let dots = points.iter().rev().flat_map(|point| {
        let colour = style::scale((point.value * 100.0 - 2.0) / 98.0);
        point.eigenvalues.iter().map(move |value| ((value.re, value.im), colour))
    });
    panel.dots.push(Dots { label: String::new(), mark: Mark::Disc, radius: 3.0, points: dots.collect() });
    panel.colours = Some(ColourScale { label: "opening [%]".into(), from: 2.0, to: 100.0 });
    panel
}

/// Eigenvalues in the complex plane, without and with the operator.
fn eigenvalues(spectrum: &Spectrum) -> Figure {
    let (plain, ours) = (&spectrum.plain, &spectrum.stabilised);
    let far = plain.iter().flat_map(|point| &point.eigenvalues).map(|value| value.re).fold(0.0, f64::min);
    let h = f64::from(spectrum.step_us) * 1e-6;
    let near = (1.0 - 11.0 * h, 1.0 + 3.0 * h);
    let mut left = plane("without φ", plain, (-3.2, 1.4));
    left.notes.push(Note {
        at: (-3.2, 0.75),
        text: format!("← runs on to {far:.0} at 2 %").replace('-', "−"),
        colour: style::INK,
    });
    Figure {
        title: format!(
            "Eigenvalues of one explicit step of {}, valve from 2 to 100 %",
            step_name(spectrum.step_us)
        ),
        panels: vec![
            left,
            plane("with φ", ours, (-1.25, 1.25)),
            plane("without φ, near 1", plain, near),
            plane("with φ, near 1", ours, near),
        ],
        columns: 2,
        panel_size: (520, 420),
        remarks: vec![
            "An explicit step is stable where all eigenvalues of I + h·J lie inside the unit circle.".into(),
            NOT_THE_PAPERS.into(),
        ],
    }
}

fn radius_panel(title: &str, spectra: &[&Spectrum]) -> Panel {
    let mut panel = Panel::new(
        title,
        Axis::linear("valve opening [%]", 0.0, 100.0),
        Axis::logarithmic("spectral radius [1]", 0.5, 2_000.0),
    );
    panel.levels.push(Level { value: 1.0, label: "limit of stability".into() });
    for (spectrum, dash) in spectra.iter().zip([Dash::Solid, Dash::Dashed]) {
        let curve = |points: &[SweepPoint]| -> Vec<Point> {
            points.iter().map(|point| (point.value * 100.0, point.radius)).collect()
        };
        let step = step_name(spectrum.step_us);
        let plain = Curve::new(&format!("without φ, {step}"), VERMILION, dash, curve(&spectrum.plain));
        panel.curves.push(plain);
        let ours = Curve::new(&format!("with φ, {step}"), BLUE, dash, curve(&spectrum.stabilised));
        panel.curves.push(ours);
    }
    panel
}

/// Distance of the spectral radius from 1 with the operator.
fn margin_panel(spectra: &[Spectrum]) -> Panel {
    let mut panel = Panel::new(
        "",
        Axis::linear("valve opening [%]", 0.0, 100.0),
        Axis::logarithmic("margin 1 − ρ with φ [1]", 1e-4, 1e-1),
    );
    for (spectrum, dash) in spectra.iter().zip([Dash::Solid, Dash::Dashed]) {
        let points = spectrum.stabilised.iter().map(|point| (point.value * 100.0, 1.0 - point.radius));
        let label = format!("with φ, {}", step_name(spectrum.step_us));
        panel.curves.push(Curve::new(&label, BLUE, dash, points.collect()));
    }
    panel
}

/// Spectral radius over opening, the whole range and the part near 1.
fn radius(spectra: &[Spectrum]) -> Figure {
    let list: Vec<_> = spectra.iter().collect();
    let mut panel = radius_panel("", &list);
    for spectrum in spectra {
        if let Some(edge) = spectrum.edges.last() {
            panel.dots.push(Dots {
                label: String::new(),
                mark: Mark::Ring,
                radius: 5.0,
                points: vec![((edge * 100.0, 1.0), BLACK)],
            });
            let text = format!("{:.1} %", edge * 100.0);
            panel.notes.push(Note { at: (edge * 100.0, 1.7), text, colour: style::INK });
        }
    }
    Figure {
        title: "Spectral radius ρ of one explicit step against valve opening".into(),
        panels: vec![panel, margin_panel(spectra)],
        columns: 1,
        panel_size: (860, 380),
        remarks: vec![
            "The paper states 20 % as the opening below which eigenvalues leave the disc without φ.".into(),
            NOT_THE_PAPERS.into(),
        ],
    }
}

fn flow_panel(title: &str, from_s: f64, to_s: f64) -> Panel {
    Panel::new(
        title,
        Axis::linear("time [s]", from_s, to_s),
        Axis::linear("mass flow at the valve [g/s]", -25.0, 125.0),
    )
}

/// The part of a curve between two times, thinned.
fn window(curve: &[Point], from_s: f64, to_s: f64) -> Vec<Point> {
    let inside: Vec<_> = curve.iter().copied().filter(|point| (from_s..=to_s).contains(&point.0)).collect();
    thin(&inside, 600)
}

fn operator_panel(title: &str, plain: &Run, ours: &Run, (from_s, to_s): (f64, f64)) -> Panel {
    let mut panel = flow_panel(title, from_s, to_s);
    let label = plain
        .diverged_s()
        .map_or("without φ".to_owned(), |time| format!("without φ: diverges, {time:.3} s"));
    panel.curves.push(Curve::new(&label, VERMILION, Dash::Solid, window(&plain.flow, from_s, to_s)));
    panel.curves.push(Curve::new("with φ", BLUE, Dash::Solid, window(&ours.flow, from_s, to_s)));
    panel
}

/// Flow without and with the operator at both steps: the whole run and the closing.
fn with_and_without(results: &Results) -> Figure {
    let mut panels = Vec::new();
    for (plain, ours) in results.euler.iter().zip(&results.relaxation) {
        let step = step_name(ours.settings.step_us);
        let mut whole = operator_panel(&format!("step {step}, whole run"), plain, ours, (0.0, 26.0));
        let [open, closed] = AMESIM_G_S;
        whole.levels.push(Level { value: open, label: "AMESim (printed)".into() });
        whole.levels.push(Level { value: closed, label: String::new() });
        panels.push(whole);
        panels.push(operator_panel(
            &format!("step {step}, while the valve closes"),
            plain,
            ours,
            (10.6, 11.2),
        ));
    }
    Figure {
        title: "Plain explicit Euler and the adaptive operator, valve closing to 2 % from 10 s to 11 s"
            .into(),
        panels,
        columns: 2,
        panel_size: (520, 330),
        remarks: vec![PSEUDO_TIME.into(), NOT_THE_PAPERS.into()],
    }
}

/// Flow against the reference while the valve closes, and the error below it.
fn against_reference(run: &Run, errors: &[Point]) -> Figure {
    let step = step_name(run.settings.step_us);
    let reference = Reference::stored().curve_g_s();
    let mut flow = Panel::new(
        "",
        Axis::linear("time [s]", 10.0, 12.0),
        Axis::linear("mass flow at the valve [g/s]", 0.0, 95.0),
    );
    let ours = window(&run.flow, 10.0, 12.0);
    flow.curves
        .push(Curve { width: 3.4, ..Curve::new(&format!("ours, h = {step}"), BLUE, Dash::Solid, ours) });
    let label = "tight solution of the same equations";
    flow.curves.push(Curve { width: 1.6, ..Curve::new(label, BLACK, Dash::Dashed, thin(&reference, 600)) });
    let axis = Axis::around("ours − reference [g/s]", errors.iter().map(|point| point.1), 1e-3);
    let mut error = Panel::new("", Axis::linear("time [s]", 10.0, 12.0), axis);
    error.curves.push(Curve::new("", VERMILION, Dash::Solid, thin(errors, 600)));
    let largest = errors.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
    Figure {
        title: format!("Flow against the reference at a step of {step}, largest error {largest:.3} g/s"),
        panels: vec![flow, error],
        columns: 1,
        panel_size: (860, 300),
        remarks: vec![PSEUDO_TIME.into()],
    }
}

/// The README's picture: what goes wrong without the operator, and why.
pub fn readme_picture(results: &Results) -> Option<String> {
    let (plain, ours) = (results.euler.first()?, results.relaxation.first()?);
    let spectrum = results.spectra.first()?;
    let flow = operator_panel("flow while the valve closes", plain, ours, (10.6, 11.2));
    let radius = radius_panel("spectral radius of a step", &[spectrum]);
    let figure = Figure {
        title: "A valve closes: explicit Euler at 1 ms without and with the adaptive operator φ".into(),
        panels: vec![flow, radius],
        columns: 2,
        panel_size: (470, 330),
        remarks: Vec::new(),
    };
    Some(figure.svg())
}
