//! A run as a picture: flows, pressures, inputs and φ over time.

use eclss_network_file::Quantity;

use super::RunReport;
use crate::plot::style::CYCLE;
use crate::plot::{Axis, Curve, Dash, Figure as Plot, Panel, thin};
use crate::trace::{Figure, Trace};

/// Curves that a panel shows at most.
const CURVES: usize = 6;

/// Draws what the run wrote down.
pub fn picture(report: &RunReport, trace: &Trace) -> String {
    let flow = |figure: Figure| {
        matches!(figure, Figure::Point(Quantity::LineFlow { .. } | Quantity::SegmentFlow { .. }))
    };
    let pressure = |figure: Figure| {
        matches!(figure, Figure::Point(Quantity::NodePressure { .. } | Quantity::OutletPressure { .. }))
    };
    let input = |figure: Figure| matches!(figure, Figure::Point(Quantity::Input { .. }));
    let mut remarks = Vec::new();
    let mut panels = Vec::new();
    let kinds: [(&str, &str, f64, &dyn Fn(Figure) -> bool); 4] = [
        ("mass flow", "mass flow [g/s]", 1e3, &flow),
        ("pressure", "gauge pressure [Pa]", 1.0, &pressure),
        ("inputs", "input [1]", 1.0, &input),
        ("smallest φ of a step", "φ [1]", 1.0, &|figure| figure == Figure::Phi),
    ];
    for (title, label, factor, wanted) in kinds {
        let found: Vec<_> =
            (0..trace.columns().len()).filter(|k| wanted(trace.columns()[*k].figure)).collect();
        if found.is_empty() {
            continue;
        }
        if found.len() > CURVES {
            remarks
                .push(format!("{title}: the first {CURVES} of {} recorded; the CSV has all.", found.len()));
        }
        panels.push(panel(trace, title, label, factor, &found));
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

fn panel(trace: &Trace, title: &str, label: &str, factor: f64, columns: &[usize]) -> Panel {
    let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    let mut curves = Vec::new();
    for (order, column) in columns.iter().take(CURVES).enumerate() {
        let name = trace.columns()[*column].name.as_str();
        let name = name.trim_end_matches("_kg_s").trim_end_matches("_gauge_pa");
        let name =
            name.trim_end_matches(".mass_flow").trim_end_matches("pressure").trim_end_matches(".outlet_");
        let points = thin(&trace.curve(*column, factor), 500);
        let colour = CYCLE[order % CYCLE.len()];
        curves.push(Curve::new(name.trim_end_matches('.'), colour, dashes[order % dashes.len()], points));
    }
    let values = || curves.iter().flat_map(|curve| &curve.points);
    let end = values().map(|point| point.0).fold(0.0, f64::max).max(1e-6);
    // A run that diverges would press everything else flat.
    let mut heights: Vec<_> = values().map(|point| point.1).filter(|height| height.is_finite()).collect();
    heights.sort_unstable_by(f64::total_cmp);
    let place = |part: f64| ((heights.len().max(1) - 1) as f64 * part) as usize;
    let (low, high) = (place(0.002), place(0.998));
    let y = Axis::around(label, heights.get(low..=high).unwrap_or(&[]).iter().copied(), 1e-3);
    let mut panel = Panel::new(title, Axis::linear("time [s]", 0.0, end), y);
    panel.curves = curves;
    panel
}
