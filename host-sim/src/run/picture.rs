//! A run as a picture: flows, pressures, inputs and φ over time.

use eclss_core::Output;
use eclss_core::signal::{Display, Shown};
use eclss_network_file::NamedSignal;

use super::{Diverged, RunReport};
use crate::plot::style::CYCLE;
use crate::plot::{Axis, Curve, Dash, Figure, Panel, thin};
use crate::trace::Trace;

/// Curves that a panel shows at most.
const CURVES: usize = CYCLE.len();

/// Content of a panel: figures of one form. Inputs share one, and figures of a list, such as partial pressures, differ so
/// much in size that each has its own.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Inputs,
    Phi,
    Form(Display, u16),
}

impl Kind {
    /// The panel of a column; none where a curve would say nothing.
    fn of(column: &NamedSignal) -> Option<Self> {
        match column.signal.output {
            Output::Input => Some(Self::Inputs),
            Output::Phi => Some(Self::Phi),
            Output::SpectralBound => None,
            _ => Some(Self::Form(column.spec.display, column.signal.item)),
        }
    }

    /// Label of the vertical axis, and how a value gets there.
    fn axis(self) -> (String, Shown) {
        let plain = Shown { unit: "1", datum: "", factor: 1.0, offset: 0.0 };
        match self {
            Self::Inputs => ("input [SI]".into(), plain),
            Self::Phi => ("φ [1]".into(), plain),
            Self::Form(display, _) => {
                let shown = display.shown();
                (format!("{} [{}]", display.name().replace('_', " "), shown.unit), shown)
            }
        }
    }
}

/// Title of a panel: the labels of its figures.
fn title(columns: &[&NamedSignal]) -> String {
    let mut labels: Vec<String> = Vec::new();
    for column in columns {
        let label = match column.signal.output {
            Output::Input => "inputs".to_owned(),
            Output::PartialPressure => {
                format!("{} of {}", column.spec.label, column.spec.name.replace('_', " "))
            }
            _ => column.spec.label.to_owned(),
        };
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels.join(", ")
}

/// Unit of the time axis.
#[derive(Clone, Copy)]
struct Clock {
    label: &'static str,
    seconds: f64,
}

impl Clock {
    /// The unit that suits a run of this length.
    fn of(seconds: f64) -> Self {
        if seconds > 7_200.0 {
            Self { label: "time [h]", seconds: 3_600.0 }
        } else {
            Self { label: "time [s]", seconds: 1.0 }
        }
    }
}

/// Draws what the run wrote down.
pub fn picture(report: &RunReport, trace: &Trace) -> String {
    let clock = Clock::of(report.end.t_s);
    let mut remarks = Vec::new();
    let mut panels = Vec::new();
    let mut kinds: Vec<(Kind, Vec<usize>)> = Vec::new();
    for (index, column) in trace.columns().iter().enumerate() {
        let Some(kind) = Kind::of(column) else { continue };
        match kinds.iter_mut().find(|(other, _)| *other == kind) {
            Some((_, columns)) => columns.push(index),
            None => kinds.push((kind, vec![index])),
        }
    }
    for (kind, found) in &kinds {
        let panel = panel(trace, *kind, found, report.diverged.is_some(), clock);
        if found.len() > CURVES {
            let (title, all) = (&panel.title, found.len());
            remarks.push(format!("{title}: the first {CURVES} of {all} recorded; the CSV has all."));
        }
        panels.push(panel);
    }
    if report.pseudo_time {
        remarks
            .push("Transients of this method are pseudo-time, not physics; its states of rest are.".into());
    }
    if let Some(diverged) = &report.diverged {
        let Diverged { t_s, kind, id, what, .. } = diverged;
        remarks.push(format!("Diverged at {t_s} s in {kind} `{id}`: {what}."));
    }
    let title = format!("{}: {} at {} ms", report.network, report.method, report.step_s * 1e3);
    Figure { title, panels, columns: 2, panel_size: (520, 340), remarks }.svg()
}

fn panel(trace: &Trace, kind: Kind, columns: &[usize], diverged: bool, clock: Clock) -> Panel {
    let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    let named: Vec<_> = columns.iter().map(|column| &trace.columns()[*column]).collect();
    let alone =
        named.iter().all(|one| named.iter().filter(|other| other.owner() == one.owner()).count() == 1);
    let (label, shown) = kind.axis();
    let mut curves = Vec::new();
    for (order, (column, named)) in columns.iter().zip(&named).take(CURVES).enumerate() {
        let mut points = trace.curve(*column, shown.factor);
        for (time, height) in &mut points {
            (*time, *height) = (*time / clock.seconds, *height + shown.offset);
        }
        let points = thin(&points, 500);
        let dash = dashes[order % dashes.len()];
        let name = match kind {
            Kind::Phi => "φ",
            Kind::Form(..) if alone => named.owner(),
            Kind::Form(..) | Kind::Inputs => &named.name,
        };
        curves.push(Curve::new(name, CYCLE[order], dash, points));
    }
    let values = || curves.iter().flat_map(|curve| &curve.points);
    let end = values().map(|point| point.0).fold(0.0, f64::max).max(1e-6);
    let mut heights: Vec<_> = values().map(|point| point.1).filter(|height| height.is_finite()).collect();
    heights.sort_unstable_by(f64::total_cmp);
    // The last steps of a run that diverges would press everything else flat.
    let cut = if diverged && kind != Kind::Inputs { heights.len() / 50 } else { 0 };
    let inner = heights.get(cut..heights.len() - cut).unwrap_or(&[]);
    let y = if kind == Kind::Phi {
        Axis::linear(&label, 0.0, 1.06)
    } else {
        Axis::around(&label, inner.iter().copied(), 1e-3)
    };
    let mut panel = Panel::new(&title(&named), Axis::linear(clock.label, 0.0, end), y);
    panel.curves = curves;
    panel
}
