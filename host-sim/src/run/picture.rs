//! A run as a picture: flows, pressures, inputs and φ over time.

use eclss_network_file::Quantity;

use super::RunReport;
use crate::plot::style::CYCLE;
use crate::plot::{Axis, Curve, Dash, Figure as Plot, Panel, thin};
use crate::trace::{Figure, Trace};

/// Curves that a panel shows at most.
const CURVES: usize = CYCLE.len();

/// A kind of panel: which figures it shows, and how.
struct Kind {
    title: &'static str,
    label: &'static str,
    factor: f64,
    shows: fn(Figure) -> bool,
}

const KINDS: [Kind; 4] = [
    Kind {
        title: "mass flow",
        label: "mass flow [g/s]",
        factor: 1e3,
        shows: |figure| {
            matches!(figure, Figure::Point(Quantity::LineFlow { .. } | Quantity::SegmentFlow { .. }))
        },
    },
    Kind {
        title: "pressure",
        label: "gauge pressure [Pa]",
        factor: 1.0,
        shows: |figure| {
            matches!(figure, Figure::Point(Quantity::NodePressure { .. } | Quantity::OutletPressure { .. }))
        },
    },
    Kind {
        title: "inputs",
        label: "input [1]",
        factor: 1.0,
        shows: |figure| matches!(figure, Figure::Point(Quantity::Input { .. })),
    },
    Kind {
        title: "smallest φ of a step",
        label: "φ [1]",
        factor: 1.0,
        shows: |figure| figure == Figure::Phi,
    },
];

/// Draws what the run wrote down.
pub fn picture(report: &RunReport, trace: &Trace) -> String {
    let mut remarks = Vec::new();
    let mut panels = Vec::new();
    for kind in &KINDS {
        let columns = 0..trace.columns().len();
        let found: Vec<_> = columns.filter(|k| (kind.shows)(trace.columns()[*k].figure)).collect();
        if found.is_empty() {
            continue;
        }
        if found.len() > CURVES {
            remarks.push(format!(
                "{}: the first {CURVES} of {} recorded; the CSV has all.",
                kind.title,
                found.len()
            ));
        }
        panels.push(panel(trace, kind, &found, report.diverged.is_some()));
    }
    if report.pseudo_time {
        remarks
            .push("Transients of this method are pseudo-time, not physics; its states of rest are.".into());
    }
    if let Some(diverged) = &report.diverged {
        remarks.push(format!("Diverged at {} s in {} `{}`.", diverged.t_s, diverged.kind, diverged.id));
    }
    let title = format!("{}: {} at {} ms", report.network, report.method, report.step_s * 1e3);
    Plot { title, panels, columns: 2, panel_size: (520, 340), remarks }.svg()
}

fn panel(trace: &Trace, kind: &Kind, columns: &[usize], diverged: bool) -> Panel {
    let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    let mut curves = Vec::new();
    for (order, column) in columns.iter().take(CURVES).enumerate() {
        let points = thin(&trace.curve(*column, kind.factor), 500);
        let dash = dashes[order % dashes.len()];
        curves.push(Curve::new(short(&trace.columns()[*column].name), CYCLE[order], dash, points));
    }
    let values = || curves.iter().flat_map(|curve| &curve.points);
    let end = values().map(|point| point.0).fold(0.0, f64::max).max(1e-6);
    let mut heights: Vec<_> = values().map(|point| point.1).filter(|height| height.is_finite()).collect();
    heights.sort_unstable_by(f64::total_cmp);
    // The last steps of a run that diverges would press everything else flat.
    let wild = diverged
        && !columns
            .iter()
            .any(|k| matches!(trace.columns()[*k].figure, Figure::Point(Quantity::Input { .. })));
    let cut = if wild { heights.len() / 50 } else { 0 };
    let shown = heights.get(cut..heights.len() - cut).unwrap_or(&[]);
    let y = if columns.iter().all(|column| trace.columns()[*column].figure == Figure::Phi) {
        Axis::linear(kind.label, 0.0, 1.06)
    } else {
        Axis::around(kind.label, shown.iter().copied(), 1e-3)
    };
    let mut panel = Panel::new(kind.title, Axis::linear("time [s]", 0.0, end), y);
    panel.curves = curves;
    panel
}

/// A column's name for a legend.
fn short(name: &str) -> &str {
    if name == "phi" {
        return "φ";
    }
    let endings = [".mass_flow_kg_s", ".outlet_pressure_gauge_pa", ".pressure_gauge_pa"];
    endings.iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or(name)
}
