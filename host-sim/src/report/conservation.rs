//! Mass ledgers: what they lack, over time.

use eclss_core::{Health, Method, Settings};

use super::html::{Html, scientific};
use crate::plot::style::CYCLE;
use crate::plot::{Axis, Curve, Dash, Figure, Panel, Point};
use crate::refusal::refused;
use crate::{Closure, Failure, HostBuffers, Source};

/// Points of a curve.
const POINTS: u64 = 120;
/// Smallest value drawn: a ledger that lacks nothing has no place on a logarithmic axis.
const LEAST: f64 = 1e-16;

/// Networks with the methods that take them.
const NETWORKS: [(&str, &str, &[Method]); 2] = [
    (
        "networks/paper.toml",
        include_str!("../../../networks/paper.toml"),
        &[Method::Relaxation, Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2],
    ),
    (
        "networks/station.toml",
        include_str!("../../../networks/station.toml"),
        &[Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2],
    ),
];

/// Runs and writes the section.
pub(super) fn write(page: &mut Html, until_s: u32) -> Result<(), Failure> {
    page.section("Conservation");
    page.paragraph(
        "Every transfer of mass is rounded once and booked. What a ledger lacks is the larger of what the worst node and \
         what the whole network lacks, over the mass of all cabins.",
    );
    let mut rows = Vec::new();
    for (path, text, methods) in NETWORKS {
        let source = Source::built_in(text, path)?;
        let time = Axis::linear("plant time [s]", 0.0, f64::from(until_s));
        let mut panel = Panel::new("", time, Axis::logarithmic("lacking part of all mass [1]", LEAST, 1e-6));
        for (method, colour) in methods.iter().zip(CYCLE) {
            let lacking = run(&source, *method, u64::from(until_s) * 1_000_000)?;
            let worst = lacking.iter().map(|point| point.1).fold(0.0, f64::max);
            rows.push([
                path.to_owned(),
                method.name().to_owned(),
                format!("{until_s} s at 1 ms"),
                scientific(worst, 1),
            ]);
            let drawn = lacking.iter().map(|(time, part)| (*time, part.max(LEAST))).collect();
            panel.curves.push(Curve::new(method.name(), colour, Dash::Solid, drawn));
        }
        let figure = Figure {
            title: format!("What the ledger of {path} lacks"),
            panels: vec![panel],
            columns: 1,
            panel_size: (900, 330),
            remarks: vec![format!(
                "Single precision rounds by 6e-8. What lacks nothing is drawn at {LEAST:e}."
            )],
        };
        page.figure(&figure.svg(), "Closure of the mass ledger over time.", "eclss-rt report");
    }
    page.table(
        ["network", "method", "run", "lacks at most"],
        &rows,
        "A day of it is run by the example ledger_day.",
        "eclss-rt report; cargo run --release -p eclss-tests --example ledger_day",
    );
    Ok(())
}

fn run(source: &Source, method: Method, until_us: u64) -> Result<Vec<Point>, Failure> {
    let settings = Settings { method, step_us: 1_000 };
    let network = source.loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator =
        buffers.simulator(&network, settings).map_err(|error| refused(source, settings, &error))?;
    let mut closure = Closure::new(&source.loaded);
    let every = (until_us / u64::from(settings.step_us) / POINTS).max(1);
    let mut points = Vec::new();
    while simulator.time_us() < until_us {
        if simulator.step() != Health::Trusted {
            return Err(Failure::Failed(format!(
                "{} with {}: the run left its range",
                source.name,
                method.name()
            )));
        }
        if simulator.tick() % every == 0 {
            points.push((simulator.time_us() as f64 * 1e-6, closure.read(&simulator)));
        }
    }
    Ok(points)
}
