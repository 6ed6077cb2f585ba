//! One random network with one method: everything that is promised of it, and what it missed.

use eclss_core::Method;

use super::draw::{Drawn, Kinds};
use super::run;
use crate::dice::Dice;

/// Phases of constant inputs in a run, and steps in each.
pub const PHASES: (u32, u32) = (5, 200);
/// Largest error of a settled network.
pub const ERROR: f64 = 1e-4;
/// Growth of max|p − p*| in a step that rounding explains, as part of the largest pressure.
pub const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// What came of one network, or of many.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// Runs with jumping inputs.
    pub runs: u64,
    /// Steps in all.
    pub steps: u64,
    /// Runs that left their range, were refused or had no steady state to compare with.
    pub troubles: u64,
    /// Runs of `adaptive` whose bound could be watched.
    pub watched: u64,
    /// Largest growth of max|p − p*| in a step as part of the largest pressure [1].
    pub growth: f64,
    /// Runs in which it was more than rounding.
    pub outside: u64,
    /// Runs in which a node was slowed.
    pub slowed: u64,
    /// Smallest φ.
    pub smallest_phi: Option<f32>,
    /// Networks that had the time to settle.
    pub settled: u64,
    /// Of these, those that settled elsewhere.
    pub wrong: u64,
    /// Largest error of a settled network.
    pub error: f64,
    /// A line for everything missed.
    pub notes: Vec<String>,
}

impl Outcome {
    /// Takes another outcome in.
    pub fn add(&mut self, one: Self) {
        self.runs += one.runs;
        self.steps += one.steps;
        self.troubles += one.troubles;
        self.watched += one.watched;
        self.growth = self.growth.max(one.growth);
        self.outside += one.outside;
        self.slowed += one.slowed;
        self.smallest_phi = match (self.smallest_phi, one.smallest_phi) {
            (Some(a), Some(b)) => Some(if a < b { a } else { b }),
            (a, b) => a.or(b),
        };
        self.settled += one.settled;
        self.wrong += one.wrong;
        self.error = self.error.max(one.error);
        self.notes.extend(one.notes);
    }
}

/// Every second network has only the elements of the theorem. `adaptive` has volumes where the other methods have
/// nodes without any.
fn kinds(seed: u64, method: Method, check_valves: bool) -> Kinds {
    if seed.is_multiple_of(2) {
        Kinds { drains: true, check_valves, ..Kinds::default() }
    } else {
        Kinds { check_valves, junctions: method != Method::Adaptive, ..Kinds::ALL }
    }
}

/// Draws the network of a seed, with check valves or without, and runs it: once with jumping inputs, once to settle.
pub fn examine(seed: u64, method: Method, check_valves: bool) -> Outcome {
    let mut dice = Dice::new(seed);
    let drawn = Drawn::new(&mut dice, kinds(seed, method, check_valves));
    let mut outcome = Outcome::default();
    let (nodes, lines) = (drawn.nodes.len(), drawn.lines.len());
    let at = format!("seed {seed}, {nodes} nodes, {lines} lines, {} us", drawn.step_us);
    match run::jumps(&drawn, method, &mut dice, PHASES.0, PHASES.1) {
        Err(trouble) => {
            outcome.troubles += 1;
            outcome.notes.push(format!("{at}: {trouble:?}"));
        }
        Ok(jumps) if jumps.refused => {}
        Ok(jumps) => {
            outcome.runs += 1;
            outcome.steps += jumps.steps;
            outcome.smallest_phi = Some(jumps.smallest_phi);
            outcome.slowed += u64::from(jumps.smallest_phi < 1.0);
            if jumps.watched && method == Method::Adaptive {
                outcome.watched += 1;
                outcome.growth = jumps.growth;
                if jumps.growth > ROUNDING {
                    outcome.outside += 1;
                    outcome.notes.push(format!("{at}: grows by {:.2e}", jumps.growth));
                }
            }
        }
    }
    match run::settle(&drawn, method) {
        Err(trouble) => {
            outcome.troubles += 1;
            outcome.notes.push(format!("{at}, settling: {trouble:?}"));
        }
        Ok(None) => {}
        Ok(Some(settled)) => {
            outcome.settled += 1;
            outcome.steps += settled.steps;
            outcome.error = settled.error;
            if settled.error > ERROR || settled.error.is_nan() {
                outcome.wrong += 1;
                let run::Settled { error, line, steps } = settled;
                outcome.notes.push(format!("{at}: off by {error:.2e} at line {line} after {steps} steps"));
            }
        }
    }
    outcome
}
