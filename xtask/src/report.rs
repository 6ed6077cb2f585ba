//! Section headers with timing, and the summary at the end of a run.

use crate::Outcome;
use std::time::{Duration, Instant};

/// Stages in the order they ran, with how long each took and how it ended.
#[derive(Default)]
pub(crate) struct Stages {
    done: Vec<(String, Duration, bool)>,
}

impl Stages {
    /// Runs one stage under a header. The first error stops the caller, who then prints the summary.
    pub(crate) fn stage(&mut self, name: &str, work: impl FnOnce() -> Outcome) -> Outcome {
        println!("\n=== {name}");
        let start = Instant::now();
        let outcome = work();
        self.done.push((name.to_owned(), start.elapsed(), outcome.is_ok()));
        println!("=== {name}: {} in {:.1} s", verdict(outcome.is_ok()), start.elapsed().as_secs_f32());
        outcome
    }

    /// Prints one line per stage and the total.
    pub(crate) fn summary(&self) {
        println!("\n=== summary");
        for (name, took, ok) in &self.done {
            println!("{:>8.1} s  {:<6}  {name}", took.as_secs_f32(), verdict(*ok));
        }
        let total: Duration = self.done.iter().map(|(_, took, _)| *took).sum();
        let all = self.done.iter().all(|(_, _, ok)| *ok);
        println!("{:>8.1} s  {:<6}  total", total.as_secs_f32(), verdict(all));
    }
}

fn verdict(ok: bool) -> &'static str {
    if ok { "ok" } else { "FAILED" }
}
