//! What the paper's figures show, drawn from our own results.

use super::printed::AMESIM_G_S;
use super::{Reference, Results, Run};
use crate::Duration;
use crate::linear::{Moving, eigenvalue_figure, radius_figure, radius_panel};
use crate::plot::style::{BLACK, BLUE, VERMILION};
use crate::plot::{Axis, Curve, Dash, Figure, Level, Panel, Point, thin};

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

fn opening() -> Moving {
    Moving { name: "opening".into(), unit: "%".into(), factor: 100.0 }
}

/// Draws everything that the paper's figures 4 to 8 show.
pub fn pictures(results: &Results) -> Vec<Picture> {
    let mut list = Vec::new();
    for spectrum in &results.spectra {
        let step = spectrum.step_us / 1_000;
        let remarks = vec![
            "An explicit step is stable where all eigenvalues of I + h·J lie inside the unit circle.".into(),
            NOT_THE_PAPERS.into(),
        ];
        let svg = eigenvalue_figure(spectrum, &opening(), remarks).svg();
        list.push(Picture { file: format!("eigenvalues_{step}ms.svg"), svg });
    }
    let remarks = vec![
        "The paper states 20 % as the opening below which eigenvalues leave the disc without φ.".into(),
        NOT_THE_PAPERS.into(),
    ];
    let spectra: Vec<_> = results.spectra.iter().collect();
    let svg = radius_figure(&spectra, &opening(), remarks).svg();
    list.push(Picture { file: "spectral_radius.svg".into(), svg });
    list.push(Picture { file: "flow_operator.svg".into(), svg: with_and_without(results).svg() });
    for (run, errors) in results.relaxation.iter().zip(&results.transient_errors) {
        let step = run.settings.step_us / 1_000;
        let file = format!("flow_reference_{step}ms.svg");
        list.push(Picture { file, svg: against_reference(run, errors).svg() });
    }
    list
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
    let radius = radius_panel("spectral radius of a step", &[spectrum], &opening());
    let figure = Figure {
        title: "A valve closes: explicit Euler at 1 ms without and with the adaptive operator φ".into(),
        panels: vec![flow, radius],
        columns: 2,
        panel_size: (470, 330),
        remarks: Vec::new(),
    };
    Some(figure.svg())
}
