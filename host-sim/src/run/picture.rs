//! A run as a picture: flows, pressures, inputs and φ over time.

use eclss_core::climate::medium;
use eclss_network_file::{AirFigure, ExchangerFigure, Quantity};

use super::{Diverged, RunReport};
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
    offset: f64,
    shows: fn(Figure) -> bool,
}

/// Whether a figure is a part's partial pressure that is shown with another.
fn partial(figure: Figure, of: impl Fn(usize) -> bool) -> bool {
    matches!(figure, Figure::Point(Quantity::Air { figure: AirFigure::Partial(part), .. }) if of(part))
}

/// Whether a figure of a condenser is one of `wanted`.
fn of_exchanger(figure: Figure, wanted: &[ExchangerFigure]) -> bool {
    matches!(figure, Figure::Point(Quantity::Exchanger { figure, .. }) if wanted.contains(&figure))
}

/// Whether a figure of a volume is `wanted`.
fn of_air(figure: Figure, wanted: AirFigure) -> bool {
    matches!(figure, Figure::Point(Quantity::Air { figure, .. }) if figure == wanted)
}

const KINDS: [Kind; 12] = [
    Kind {
        title: "temperature and dew point",
        label: "temperature [°C]",
        factor: 1.0,
        offset: -273.15,
        shows: |figure| {
            of_air(figure, AirFigure::Temperature)
                || of_air(figure, AirFigure::DewPoint)
                || of_exchanger(figure, &[ExchangerFigure::AirOutlet])
        },
    },
    Kind {
        title: "relative humidity",
        label: "relative humidity [%]",
        factor: 100.0,
        offset: 0.0,
        shows: |figure| of_air(figure, AirFigure::RelativeHumidity),
    },
    Kind {
        title: "oxygen",
        label: "partial pressure [kPa]",
        factor: 1e-3,
        offset: 0.0,
        shows: |figure| partial(figure, |part| part == medium::OXYGEN),
    },
    Kind {
        title: "carbon dioxide, vapour, trace gases",
        label: "partial pressure [Pa]",
        factor: 1.0,
        offset: 0.0,
        shows: |figure| partial(figure, |part| part != medium::OXYGEN),
    },
    Kind {
        title: "heat of condensers",
        label: "heat [W]",
        factor: 1.0,
        offset: 0.0,
        shows: |figure| of_exchanger(figure, &[ExchangerFigure::Heat, ExchangerFigure::CoolantHeat]),
    },
    Kind {
        title: "condensate",
        label: "water out of the air [g/h]",
        factor: 3.6e6,
        offset: 0.0,
        shows: |figure| of_exchanger(figure, &[ExchangerFigure::Condensate]),
    },
    Kind {
        title: "water",
        label: "water [kg]",
        factor: 1.0,
        offset: 0.0,
        shows: |figure| {
            of_air(figure, AirFigure::Liquid)
                || of_exchanger(
                    figure,
                    &[ExchangerFigure::Film, ExchangerFigure::Separator, ExchangerFigure::Tank],
                )
        },
    },
    Kind {
        title: "does one well-mixed volume hold (1), or not (0)",
        label: "mixed [1]",
        factor: 1.0,
        offset: 0.0,
        shows: |figure| of_air(figure, AirFigure::Mixed),
    },
    Kind {
        title: "mass flow",
        label: "mass flow [g/s]",
        factor: 1e3,
        offset: 0.0,
        shows: |figure| {
            matches!(figure, Figure::Point(Quantity::LineFlow { .. } | Quantity::SegmentFlow { .. }))
        },
    },
    Kind {
        title: "pressure",
        label: "gauge pressure [Pa]",
        factor: 1.0,
        offset: 0.0,
        shows: |figure| {
            matches!(figure, Figure::Point(Quantity::NodePressure { .. } | Quantity::OutletPressure { .. }))
        },
    },
    Kind {
        title: "inputs",
        label: "input [1]",
        factor: 1.0,
        offset: 0.0,
        shows: |figure| matches!(figure, Figure::Point(Quantity::Input { .. })),
    },
    Kind {
        title: "smallest φ of a step",
        label: "φ [1]",
        factor: 1.0,
        offset: 0.0,
        shows: |figure| figure == Figure::Phi,
    },
];

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
        panels.push(panel(trace, kind, &found, report.diverged.is_some(), clock));
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
    Plot { title, panels, columns: 2, panel_size: (520, 340), remarks }.svg()
}

fn panel(trace: &Trace, kind: &Kind, columns: &[usize], diverged: bool, clock: Clock) -> Panel {
    let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    let mut curves = Vec::new();
    for (order, column) in columns.iter().take(CURVES).enumerate() {
        let mut points = trace.curve(*column, kind.factor);
        for (time, height) in &mut points {
            (*time, *height) = (*time / clock.seconds, *height + kind.offset);
        }
        let points = thin(&points, 500);
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
    let mut panel = Panel::new(kind.title, Axis::linear(clock.label, 0.0, end), y);
    panel.curves = curves;
    panel
}

/// A column's name for a legend.
fn short(name: &str) -> &str {
    if name == "phi" {
        return "φ";
    }
    let endings = [
        ".mass_flow_kg_s",
        ".outlet_pressure_gauge_pa",
        ".pressure_gauge_pa",
        "_kg_s",
        "_pa",
        "_kg",
        "_w",
        "_k",
    ];
    endings.iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or(name)
}
