//! Experiments P and P0: the loop with inertance and storage, against tight solutions.

use eclss_core::{Health, Method, Settings};

use super::html::{Html, fixed};
use crate::plot::style::{BLACK, BLUE, GREEN, ORANGE};
use crate::plot::{Axis, Curve, Dash, Dots, Figure, Mark, Panel, Point};
use crate::refusal::refused;
use crate::{Failure, HostBuffers, Source};

/// Times of the table [s].
const TIMES_S: [f64; 10] = [10.0, 10.5, 10.9, 11.0, 11.02, 11.05, 11.1, 11.5, 12.0, 13.9];
/// Flow at the valve [g/s] by Radau at 1e-10, confirmed by BDF; `tests/tests/physical.rs` computes it anew.
const REFERENCE: [(&str, &str, &str, [f64; 10]); 2] = [
    (
        "P",
        "networks/paper-p.toml",
        include_str!("../../../networks/paper-p.toml"),
        [86.4776, 86.1976, 72.8301, 10.4185, 8.7660, 3.8908, -3.3856, 4.0556, 4.0336, 4.0633],
    ),
    (
        "P0",
        "networks/paper-p0.toml",
        include_str!("../../../networks/paper-p0.toml"),
        [86.4776, 86.2075, 74.5678, 9.3893, 4.5555, 4.0854, 4.0596, 4.0594, 4.0594, 4.0594],
    ),
];
const RUNS: [(Method, u32); 4] = [
    (Method::ImplicitEuler, 10_000),
    (Method::ImplicitEuler, 1_000),
    (Method::TrBdf2, 10_000),
    (Method::TrBdf2, 1_000),
];

/// Runs both experiments and writes the section.
pub(super) fn write(page: &mut Html) -> Result<(), Failure> {
    page.section("Physical transients");
    page.paragraph(
        "With inertance (P0) and with inertance and duct volumes (P) the loop has real transients; P rings like a water \
         hammer when the valve stops. The references drain signed, the product clips the drain at zero flow, which \
         moves the flow by up to 0.011 g/s.",
    );
    for (name, path, text, reference) in REFERENCE {
        let source = Source::built_in(text, path)?;
        let mut rows: Vec<[String; 6]> = Vec::new();
        let flows = RUNS
            .iter()
            .map(|(method, step_us)| run(&source, Settings { method: *method, step_us: *step_us }))
            .collect::<Result<Vec<_>, _>>()?;
        for (time, exact) in TIMES_S.iter().zip(reference) {
            let error = |flow: &Vec<Point>| {
                let at = flow.iter().find(|point| (point.0 - time).abs() < 1e-7);
                at.map_or("–".to_owned(), |point| fixed(point.1 - exact, 4))
            };
            let [a, b, c, d] = [0, 1, 2, 3].map(|index| error(&flows[index]));
            rows.push([format!("{time} s"), fixed(exact, 4), a, b, c, d]);
        }
        page.table(
            ["time", "tight solution [g/s]", "implicit-euler, 10 ms", "1 ms", "tr-bdf2, 10 ms", "1 ms"],
            &rows,
            &format!("Error of the flow at the valve in experiment {name} [g/s]."),
            &format!("eclss-rt run {path} --method tr-bdf2 --at 10s,11s,12s --json"),
        );
        page.figure(
            &figure(name, &flows, &reference).svg(),
            &format!("Experiment {name} while the valve comes to its stop."),
            &format!(
                "eclss-rt run {path}; the references: cargo test -p eclss-tests --profile checked --test all physical::"
            ),
        );
    }
    Ok(())
}

/// Flow at the valve after every step, [s] and [g/s].
fn run(source: &Source, settings: Settings) -> Result<Vec<Point>, Failure> {
    let network = source.loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator =
        buffers.simulator(&network, settings).map_err(|error| refused(source, settings, &error))?;
    let last =
        source.loaded.lines.first().map_or(0, |line| (line.first_segment + line.segments) as usize - 1);
    let mut flow = Vec::new();
    while simulator.time_us() < 14_000_000 {
        if simulator.step() != Health::Trusted {
            return Err(Failure::Failed(format!("{}: the run left its range", source.name)));
        }
        let w = f64::from(simulator.segment_flow_at_end_kg_s(0, last)) * 1e3;
        flow.push((simulator.time_us() as f64 * 1e-6, w));
    }
    Ok(flow)
}

fn figure(name: &str, flows: &[Vec<Point>], reference: &[f64; 10]) -> Figure {
    let window = |flow: &Vec<Point>| -> Vec<Point> {
        flow.iter().copied().filter(|point| (10.8..=11.4).contains(&point.0)).collect()
    };
    let time = Axis::linear("time [s]", 10.8, 11.4);
    let all = flows.iter().flat_map(window).map(|point| point.1);
    let mut panel = Panel::new("", time, Axis::around("mass flow at the valve [g/s]", all, 1.0));
    let looks = [(GREEN, Dash::Dotted), (GREEN, Dash::Solid), (ORANGE, Dash::Dashed), (BLUE, Dash::Solid)];
    for (((method, step_us), flow), (colour, dash)) in RUNS.iter().zip(flows).zip(looks) {
        let label = format!("{}, {} ms", method.name(), step_us / 1_000);
        panel.curves.push(Curve::new(&label, colour, dash, window(flow)));
    }
    let points: Vec<(Point, _)> = TIMES_S
        .into_iter()
        .zip(*reference)
        .filter(|(time, _)| (10.8..=11.4).contains(time))
        .map(|point| (point, BLACK))
        .collect();
    panel.dots.push(Dots { label: "tight solution".into(), mark: Mark::Ring, radius: 4.5, points });
    Figure {
        title: format!("Experiment {name}: the valve stops at 11 s"),
        panels: vec![panel],
        columns: 1,
        panel_size: (900, 380),
        remarks: Vec::new(),
    }
}
