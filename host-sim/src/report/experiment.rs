//! The paper's experiment: its printed figures beside ours, and what its figures show.

use super::html::{Html, fixed, scientific};
use crate::linear::Moving;
use crate::linear::{SweepPoint, disc_figure, worst};
use crate::paper::printed::{AMESIM_G_S, EDGE_PERCENT, IMPROVED_ERROR_PERCENT, IMPROVED_G_S};
use crate::paper::{Experiment, Results, Run, pictures};
use crate::run::{GUARD, proof};
use crate::{Duration, Failure, Progress, Source};

const COMMAND: &str = "eclss-rt paper";

/// Runs the experiment and writes its section.
pub(super) fn write(page: &mut Html, source: &Source, progress: &Progress) -> Result<(), Failure> {
    let results = Experiment::new(source)?.run(progress)?;
    page.section("The paper's experiment");
    page.paragraph(
        "A cabin of 60 m³ with its ventilation loop. The valve stands open until 10 s and closes to 2 % until 11 s, \
         which makes the loop a thousand times stiffer. The adaptive operator φ keeps explicit Euler stable.",
    );
    let rows = printed_and_ours(&results);
    page.table(
        ["figure", "printed (p)", "ours, 1 ms (d)", "ours, 10 ms (d)"],
        &rows,
        "Every number that the paper prints of this experiment, beside ours.",
        COMMAND,
    );
    let settled: Vec<_> = results
        .settled
        .chunks(3)
        .filter_map(|group| {
            let first = group.first()?;
            let error =
                |index: usize| group.get(index).map_or(String::new(), |one| scientific(one.error(), 1));
            let opening = format!("{:.0} %", first.opening * 100.0);
            Some([opening, fixed(first.exact_kg_s * 1e3, 6), error(0), error(1), error(2)])
        })
        .collect();
    page.table(
        ["opening", "fixed point [g/s]", "relative error, 10 ms", "1 ms", "0.1 ms"],
        &settled,
        "Settled flow in single precision against the fixed point in closed form: a smaller step is not worse.",
        COMMAND,
    );
    page.paragraph(&format!("A proof named {}", GUARD.replace('`', "\"")));
    for picture in pictures(&results) {
        page.figure(&picture.svg, about(&picture.file), COMMAND);
    }
    if let Some(spectrum) = results.spectra.last() {
        let moving = Moving { name: "opening".into(), unit: "%".into(), factor: 100.0 };
        let remarks =
            vec!["Discs of the balanced matrix; inside the unit circle they prove stability.".into()];
        page.figure(
            &disc_figure(spectrum, &moving, remarks).svg(),
            "Gershgorin's discs with the operator, from which it is derived.",
            "eclss-rt stability networks/paper.toml --step 10ms",
        );
    }
    Ok(())
}

fn about(file: &str) -> &'static str {
    match file {
        "eigenvalues_1ms.svg" => "Eigenvalues of a step of 1 ms without and with φ, over the opening.",
        "eigenvalues_10ms.svg" => "The same for 10 ms.",
        "spectral_radius.svg" => {
            "Spectral radius over the opening; the paper states 20 % as the edge without φ."
        }
        "flow_operator.svg" => "Flow at the valve: plain Euler diverges while it closes, with φ it does not.",
        "flow_reference_1ms.svg" => {
            "Error against a tight solution of the same equations at 1 ms: \"almost none\" (p)."
        }
        "flow_reference_10ms.svg" => "The same at 10 ms: \"slight\" (p).",
        _ => "From the paper's experiment.",
    }
}

/// Rows of name, printed figure, ours at both steps.
fn printed_and_ours(results: &Results) -> Vec<[String; 4]> {
    let mut rows = Vec::new();
    let mut row = |name: &str, printed: &str, ours: &mut dyn Iterator<Item = String>| {
        let mut next = || ours.next().unwrap_or_default();
        rows.push([name.to_owned(), printed.to_owned(), next(), next()]);
    };
    let percent = |error: f64| format!("{} %", fixed(error, 4));
    let runs = &results.relaxation;
    let flow = |time: f64| move |run: &Run| run.flow_at(time).map_or("–".to_owned(), |flow| fixed(flow, 4));
    let error = |time: f64, place: usize| {
        move |run: &Run| {
            run.flow_at(time)
                .map_or("–".to_owned(), |flow| percent((flow / AMESIM_G_S[place] - 1.0) * 100.0))
        }
    };
    let number = |value: f64| fixed(value, 4);
    row("steady flow, open, AMESim [g/s]", &number(AMESIM_G_S[0]), &mut runs.iter().map(flow(10.0)));
    row(
        "steady flow, open, improved model [g/s]",
        &number(IMPROVED_G_S[0]),
        &mut runs.iter().map(flow(10.0)),
    );
    let open = percent(IMPROVED_ERROR_PERCENT[0]);
    row("its error against AMESim", &open, &mut runs.iter().map(error(10.0, 0)));
    row(
        "steady flow at 2 %, AMESim; ours at 26 s [g/s]",
        &number(AMESIM_G_S[1]),
        &mut runs.iter().map(flow(26.0)),
    );
    row("flow at 20 s, improved model [g/s]", &number(IMPROVED_G_S[1]), &mut runs.iter().map(flow(20.0)));
    let closed = percent(IMPROVED_ERROR_PERCENT[1]);
    row("its error against AMESim", &closed, &mut runs.iter().map(error(20.0, 1)));
    let time = |time: Option<f64>| time.map_or("never".to_owned(), |time| format!("{time:.3} s"));
    let diverged = "while the valve closes";
    row("plain Euler diverges, f64", diverged, &mut results.double_diverged_s.iter().map(|at| time(*at)));
    row("plain Euler diverges, f32", diverged, &mut results.euler.iter().map(|run| time(run.diverged_s())));
    let largest = |points: &[SweepPoint], digits| {
        worst(points).map_or("–".to_owned(), |point| fixed(point.radius, digits))
    };
    row(
        "largest spectral radius without φ",
        "above 1",
        &mut results.spectra.iter().map(|s| largest(&s.plain, 2)),
    );
    row(
        "largest spectral radius with φ",
        "inside the disc",
        &mut results.spectra.iter().map(|s| largest(&s.stabilised, 5)),
    );
    let edge = results.spectra.iter().map(|spectrum| {
        spectrum.edges.last().map_or("no opening".to_owned(), |edge| format!("{:.1} %", edge * 100.0))
    });
    row("opening below which it is unstable without φ", &format!("{EDGE_PERCENT:.0} %"), &mut { edge });
    let errors = results
        .transient_errors
        .iter()
        .map(|errors| fixed(errors.iter().map(|point| point.1.abs()).fold(0.0, f64::max), 3));
    row("largest transient error, 10 … 12 s [g/s]", "almost none; slight", &mut { errors });
    row("smallest φ of any step", "–", &mut runs.iter().map(|run| fixed(f64::from(run.worst.phi), 6)));
    row("weakest proof of any step", "–", &mut runs.iter().map(|run| proof(run.worst.proof).to_owned()));
    row("state hash at 26 s", "–", &mut runs.iter().map(|run| format!("hash {:016x}", run.state_hash)));
    row(
        "steps",
        "–",
        &mut runs.iter().map(|run| {
            let step = Duration::from_us(u64::from(run.settings.step_us));
            format!("{} of {step}", run.ticks)
        }),
    );
    rows
}
