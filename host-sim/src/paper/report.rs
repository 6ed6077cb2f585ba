//! The table of the paper's figures beside ours.

use std::io::{self, Write};

use super::printed::{AMESIM_G_S, EDGE_PERCENT, IMPROVED_ERROR_PERCENT, IMPROVED_G_S, SOURCE};
use super::{Results, Run, Settled};
use crate::linear::{Spectrum, SweepPoint, worst};
use crate::run::{GUARD, proof};
use crate::{Duration, Source};

/// Columns of most tables.
const STEPS: [&str; 2] = ["1 ms", "10 ms"];

/// Writes the whole report.
pub fn write_report(out: &mut dyn Write, source: &Source, results: &Results) -> io::Result<()> {
    writeln!(out, "The cabin ventilation experiment of {SOURCE}")?;
    writeln!(out, "  network     {}", source.name)?;
    writeln!(out, "  network id  {:016x}", results.network_id)?;
    writeln!(out, "  valve       open until 10 s, closing to 2 % until 11 s\n")?;
    steady(out, results)?;
    settled(out, &results.settled)?;
    divergence(out, results)?;
    spectra(out, &results.spectra)?;
    transients(out, results)?;
    safety(out, &results.relaxation)?;
    for line in [
        "(p) printed in the paper. (d) derived here: the network is the reading of the paper that gives its",
        "printed numbers, with parameters chosen or fitted to the two AMESim flows; its file says which.",
        "Transients of `relaxation` and `euler` are pseudo-time, not physics: only the state at which they",
        "come to rest is that of the real loop.",
    ] {
        writeln!(out, "{line}")?;
    }
    Ok(())
}

/// Head line of a table with one column for each of `columns`.
fn head(out: &mut dyn Write, title: &str, columns: &[&str]) -> io::Result<()> {
    write!(out, "{title:<49}")?;
    for column in columns {
        write!(out, " {column:>12}")?;
    }
    writeln!(out)
}

fn percent(error: f64) -> String {
    format!("{error:+.4} %").replace('-', "−")
}

/// Errors of `flows` against the flows by `AMESim` [%].
fn errors(flows: [f64; 2]) -> [f64; 2] {
    let [open, closed] = flows;
    [(open / AMESIM_G_S[0] - 1.0) * 100.0, (closed / AMESIM_G_S[1] - 1.0) * 100.0]
}

fn row(out: &mut dyn Write, name: &str, flows: [Option<f64>; 2]) -> io::Result<()> {
    write!(out, "  {name:<46}")?;
    let found = errors(flows.map(|flow| flow.unwrap_or(f64::NAN)));
    for (flow, error) in flows.into_iter().zip(found) {
        match flow {
            Some(flow) => write!(out, " {flow:>9.4} {:>11}", percent(error))?,
            None => write!(out, " {:>21}", "")?,
        }
    }
    writeln!(out)
}

fn steady(out: &mut dyn Write, results: &Results) -> io::Result<()> {
    writeln!(
        out,
        "Steady mass flow at the valve [g/s]                 100 %  and error        2 %  and error"
    )?;
    writeln!(out, "  {:<46} {:>9.4} {:>21.4}", "AMESim (p)", AMESIM_G_S[0], AMESIM_G_S[1])?;
    write!(out, "  {:<46}", "improved model of the paper (p)")?;
    for (flow, error) in IMPROVED_G_S.into_iter().zip(IMPROVED_ERROR_PERCENT) {
        write!(out, " {flow:>9.4} {:>11}", percent(error))?;
    }
    writeln!(out)?;
    for run in &results.relaxation {
        let step = Duration::from_us(u64::from(run.settings.step_us));
        let at = |time| run.flow_at(time);
        row(out, &format!("ours at {step}, at 10 s and 20 s (d)"), [at(10.0), at(20.0)])?;
        row(out, &format!("ours at {step}, at 26 s (d)"), [None, at(26.0)])?;
    }
    let [open, closed] = errors(IMPROVED_G_S).map(percent);
    writeln!(
        out,
        "  The paper's errors stand as printed; its rounded flows would give {open} and {closed}."
    )?;
    writeln!(
        out,
        "  The offset at 20 s is relaxation that has not ended; it is in the exact solution as well.\n"
    )
}

fn settled(out: &mut dyn Write, settled: &[Settled]) -> io::Result<()> {
    head(out, "Settled flow in f32 against its fixed point (d)", &["10 ms", "1 ms", "0.1 ms"])?;
    for group in settled.chunks(3) {
        let Some(first) = group.first() else { continue };
        let (opening, exact) = (first.opening * 100.0, first.exact_kg_s * 1e3);
        write!(out, "{:<49}", format!("  {opening:>3.0} %, {exact:.6} g/s, relative error"))?;
        for one in group {
            write!(out, " {:>12}", format!("{:+.1e}", one.error()).replace('-', "−"))?;
        }
        writeln!(out)?;
    }
    writeln!(out)
}

fn divergence(out: &mut dyn Write, results: &Results) -> io::Result<()> {
    head(out, "Plain Euler diverges as the valve closes (p), at", &STEPS)?;
    let mut line = |name: &str, times: &mut dyn Iterator<Item = Option<f64>>| -> io::Result<()> {
        write!(out, "  {name:<47}")?;
        for time in times {
            let time = time.map_or("never".to_owned(), |time| format!("{time:.3} s"));
            write!(out, " {time:>12}")?;
        }
        writeln!(out)
    };
    line("in f64 (d)", &mut results.double_diverged_s.iter().copied())?;
    line("in f32, as method `euler` (d)", &mut results.euler.iter().map(Run::diverged_s))?;
    writeln!(out, "  Unstable is the step well before; what grows is rounding, of which f32 has more.\n")
}

fn spectra(out: &mut dyn Write, spectra: &[Spectrum]) -> io::Result<()> {
    head(out, "Spectral radius of one step, opening 2…100 %", &STEPS)?;
    let largest = |points: &[SweepPoint]| worst(points).map_or(f64::NAN, |point| point.radius);
    write!(out, "  largest without φ (d)                          ")?;
    for spectrum in spectra {
        write!(out, " {:>12.2}", largest(&spectrum.plain))?;
    }
    write!(out, "\n  largest with φ (d); inside the disc (p)        ")?;
    for spectrum in spectra {
        write!(out, " {:>12.5}", largest(&spectrum.stabilised))?;
    }
    write!(out, "\n  without φ outside the disc below (d); {EDGE_PERCENT:.0} % (p)  ")?;
    for spectrum in spectra {
        let edge = spectrum.edges.last();
        let edge = edge.map_or("no opening".to_owned(), |edge| format!("{:.1} %", edge * 100.0));
        write!(out, " {edge:>12}")?;
    }
    writeln!(out, "\n")
}

fn transients(out: &mut dyn Write, results: &Results) -> io::Result<()> {
    head(out, "Largest error over 10…12 s [g/s]", &STEPS)?;
    write!(out, "  against the tight solution of the same ODE (d) ")?;
    for errors in &results.transient_errors {
        let largest = errors.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
        write!(out, " {largest:>12.3}")?;
    }
    writeln!(
        out,
        "\n  \"almost none\" and \"slight\" in the paper (p); the reference is stored, a test makes it anew\n"
    )
}

fn safety(out: &mut dyn Write, runs: &[Run]) -> io::Result<()> {
    head(out, "Stability while running (d)", &STEPS)?;
    let mut line = |name: &str, figure: &dyn Fn(&Run) -> String| -> io::Result<()> {
        write!(out, "  {name:<47}")?;
        for run in runs {
            write!(out, " {:>12}", figure(run))?;
        }
        writeln!(out)
    };
    line("smallest φ of any step", &|run| format!("{:.6}", run.worst.phi))?;
    line("weakest proof of any step", &|run| proof(run.worst.proof).to_owned())?;
    line("steps without a proof", &|run| (run.guarded_ticks + run.unproven_ticks).to_string())?;
    line("  of them without the guard `short step`", &|run| run.unproven_ticks.to_string())?;
    line("of all steps", &|run| run.ticks.to_string())?;
    for run in runs {
        let step = Duration::from_us(u64::from(run.settings.step_us));
        let name = format!("state hash at 26 s, {step}");
        writeln!(out, "  {name:<47} {:016x}", run.state_hash)?;
    }
    writeln!(out, "  {GUARD}\n")
}
