//! The stability of a line as a table.

use std::io::{self, Write};

use eclss_core::Proof;

use super::LineStability;
use crate::Duration;
use crate::linear::{Disc, SweepPoint, worst};
use crate::run::{GUARD, bound, proof};

/// Rows of the table.
const ROWS: usize = 15;

/// Writes one line's table.
pub fn write_stability(out: &mut dyn Write, line: &LineStability) -> io::Result<()> {
    let spectrum = &line.spectrum;
    let step = Duration::from_us(u64::from(spectrum.step_us));
    writeln!(out, "line `{}`, input `{}`, step {step}, ends held", line.line, line.moving.name)?;
    writeln!(
        out,
        "  {:>9} {:>12} {:>10} {:>14} {:>10} {:>12} {:>12}  proof",
        "value", "flow [g/s]", "φ", "ρ without φ", "ρ with φ", "Gershgorin", "live bound"
    )?;
    let every = spectrum.plain.len().div_ceil(ROWS).max(1);
    let last = spectrum.plain.len().saturating_sub(1);
    for (index, (plain, ours)) in spectrum.plain.iter().zip(&spectrum.stabilised).enumerate() {
        if index % every != 0 && index != last {
            continue;
        }
        let reach = ours.discs.iter().map(Disc::reach).fold(0.0, f64::max);
        writeln!(
            out,
            "  {:>9.4} {:>12.4} {:>10.6} {:>14.4} {:>10.6} {:>12.4} {:>12}  {}",
            ours.value,
            ours.flow_kg_s * 1e3,
            ours.phi,
            plain.radius,
            ours.radius,
            reach,
            bound(ours.margin.spectral_bound),
            proof(ours.margin.proof)
        )?;
    }
    let edges = |edges: &[f64], points: &[SweepPoint]| {
        let list: Vec<_> = edges.iter().map(|edge| format!("{edge:.4}")).collect();
        match list.as_slice() {
            [] if points.iter().all(|point| point.radius > 1.0) => "outside everywhere".to_owned(),
            [] => "nowhere".to_owned(),
            list => list.join(", "),
        }
    };
    let (plain, ours) = (&spectrum.plain, &spectrum.stabilised);
    writeln!(out, "  passes the unit circle without φ at: {}", edges(&spectrum.edges, plain))?;
    writeln!(out, "  passes the unit circle with φ at:    {}", edges(&spectrum.stabilised_edges, ours))?;
    if ours.iter().any(|point| point.margin.proof == Proof::ShortStep) {
        writeln!(out, "  {GUARD}")?;
    }
    if let (Some(plain), Some(ours)) = (worst(&spectrum.plain), worst(&spectrum.stabilised)) {
        let verdict = if ours.radius < 1.0 { "stable over the whole range" } else { "NOT STABLE everywhere" };
        writeln!(out, "  largest ρ: without φ {:.4} at {:.4}", plain.radius, plain.value)?;
        writeln!(out, "             with φ    {:.6} at {:.4}: {verdict}", ours.radius, ours.value)?;
    }
    Ok(())
}
