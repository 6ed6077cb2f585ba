//! The stored reference: the valve's flow in the tight solution of the paper's relaxation system while the
//! valve closes and after, so that the product can state its transient error without a solver of its own.

use crate::paper::{Relaxation, relaxation_start};
use crate::tight::{Family, solve};
use diffsol::error::DiffsolError;
use std::fmt::Write as _;
use std::path::PathBuf;

/// First time of the reference [ms].
pub const FIRST_MS: u32 = 10_000;
/// Last time of the reference [ms].
pub const LAST_MS: u32 = 12_000;
/// Header of the file.
pub const HEADER: &str = "t_s,w_kg_s";

/// Returns where the reference is stored.
pub fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../host-sim/data/paper_reference.csv")
}

/// Integrates anew and returns (time [s], flow at the valve [kg/s]) every millisecond.
pub fn compute() -> Result<Vec<(f64, f64)>, DiffsolError> {
    let times: Vec<f64> = (FIRST_MS..=LAST_MS).map(|ms| f64::from(ms) / 1e3).collect();
    let states = solve(&Relaxation, Family::Bdf, 1e-11, 0.0, &relaxation_start(), &times)?;
    Ok(times.iter().zip(&states).map(|(&t, x)| (t, x[5])).collect())
}

/// Returns the file's text.
pub fn to_csv(rows: &[(f64, f64)]) -> String {
    let mut text = format!("{HEADER}\n");
    for (t, w) in rows {
        // Ten digits of grams per second: the solution is no better than that.
        let _ = writeln!(text, "{t:.3},{w:.12}");
    }
    text
}

/// Reads the file's text; `None` where it is not what [`to_csv`] writes.
pub fn from_csv(text: &str) -> Option<Vec<(f64, f64)>> {
    let mut lines = text.lines();
    (lines.next()? == HEADER).then_some(())?;
    lines
        .map(|line| {
            let (t, w) = line.split_once(',')?;
            Some((t.parse().ok()?, w.parse().ok()?))
        })
        .collect()
}
