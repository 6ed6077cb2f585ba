//! When the plant wakes up, and what its steps cost.

use std::time::{Duration, Instant};

use hdrhistogram::Histogram;

/// Shortest time between two wake-ups; a plant that is to run faster takes several steps at each.
const SHORTEST: Duration = Duration::from_millis(1);
/// Time over which a mean and a percentile are taken.
const WINDOW: Duration = Duration::from_secs(2);
/// Longest time that a step is measured to be [ns].
const LONGEST_NS: u64 = 10_000_000_000;

/// Wake-ups at absolute times. One that comes too late is skipped and counted, never caught up with.
#[derive(Debug)]
pub(super) struct Pace {
    step: Duration,
    period: Duration,
    /// Steps per wake-up, not a whole number where the speed is not.
    steps: f64,
    owed: f64,
    next: Instant,
    /// Wake-ups skipped.
    pub(super) overruns: u64,
    /// Plant time skipped with them [s].
    pub(super) lag_s: f64,
}

impl Pace {
    pub(super) fn new(step_us: u32) -> Self {
        let step = Duration::from_micros(u64::from(step_us));
        let mut pace =
            Self { step, period: step, steps: 1.0, owed: 0.0, next: Instant::now(), overruns: 0, lag_s: 0.0 };
        pace.set_speed(1.0);
        pace
    }

    /// Runs `factor` times as fast as the clock from now on.
    pub(super) fn set_speed(&mut self, factor: f32) {
        let factor = f64::from(factor.clamp(0.01, 1_000.0));
        self.period = self.step.div_f64(factor).max(SHORTEST);
        self.steps = self.period.as_secs_f64() * factor / self.step.as_secs_f64();
        self.resume();
    }

    /// Forgets what was missed, as after a pause.
    pub(super) fn resume(&mut self) {
        self.next = Instant::now();
        self.owed = 0.0;
    }

    /// Gives up steps that took too long to be taken in time.
    pub(super) fn skip(&mut self, steps: u32) {
        self.lag_s += f64::from(steps) * self.step.as_secs_f64();
    }

    /// Time from wake-up to wake-up.
    pub(super) fn period(&self) -> Duration {
        self.period
    }

    /// Sleeps until the next wake-up and returns how many steps are due.
    pub(super) fn wait(&mut self) -> u32 {
        self.next += self.period;
        let now = Instant::now();
        if let Some(left) = self.next.checked_duration_since(now) {
            std::thread::sleep(left);
        } else {
            let late = now - self.next;
            let missed = (late.as_secs_f64() / self.period.as_secs_f64()).floor();
            if missed >= 1.0 {
                self.overruns += missed as u64;
                self.lag_s += missed * self.steps * self.step.as_secs_f64();
                self.next += self.period.mul_f64(missed);
            }
        }
        self.owed += self.steps;
        let due = self.owed.floor();
        self.owed -= due;
        due as u32
    }
}

/// What steps cost.
#[derive(Debug)]
pub(crate) struct Costs {
    window: Histogram<u64>,
    began: Instant,
    /// Mean of the last full window [µs].
    pub(crate) mean_us: f64,
    /// 99th percentile of the last full window [µs].
    pub(crate) p99_us: f64,
    /// Longest step of all [µs].
    pub(crate) worst_us: f64,
}

impl Costs {
    /// `None` where the histogram refuses its bounds, which are constants.
    pub(crate) fn new() -> Option<Self> {
        let window = Histogram::new_with_bounds(1, LONGEST_NS, 3).ok()?;
        Some(Self { window, began: Instant::now(), mean_us: 0.0, p99_us: 0.0, worst_us: 0.0 })
    }

    /// Notes one step.
    pub(crate) fn note(&mut self, cost: Duration) {
        let ns = u64::try_from(cost.as_nanos()).unwrap_or(LONGEST_NS).clamp(1, LONGEST_NS);
        self.window.saturating_record(ns);
        self.worst_us = self.worst_us.max(ns as f64 * 1e-3);
    }

    /// Closes the window if it is old enough.
    pub(crate) fn close(&mut self, now: Instant) {
        if now - self.began >= WINDOW && !self.window.is_empty() {
            self.mean_us = self.window.mean() * 1e-3;
            self.p99_us = self.window.value_at_quantile(0.99) as f64 * 1e-3;
            self.window.reset();
            self.began = now;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_faster_plant_takes_more_steps_and_never_wakes_more_often() {
        let mut pace = Pace::new(1_000);
        for (factor, period_us, steps) in [(1.0, 1_000, 1.0), (0.1, 10_000, 1.0), (250.0, 1_000, 250.0)] {
            pace.set_speed(factor);
            assert!((pace.period().as_micros() as i64 - period_us).abs() <= 1, "{factor}: {pace:?}");
            assert!((pace.steps - steps).abs() < 1e-3, "{factor}: {pace:?}");
        }
        pace.set_speed(2.5);
        let due: u32 = (0..4).map(|_| pace.wait()).sum();
        assert_eq!((due, pace.overruns), (10, pace.overruns));
    }

    #[test]
    fn late_wake_ups_are_skipped_and_counted() {
        let mut pace = Pace::new(1_000);
        std::thread::sleep(Duration::from_millis(30));
        assert_eq!(pace.wait(), 1);
        assert!(pace.overruns >= 20, "{pace:?}");
        assert!((pace.lag_s - pace.overruns as f64 * 1e-3).abs() < 1e-9);
    }

    #[test]
    fn percentiles_are_of_the_window() {
        let mut costs = Costs::new().unwrap();
        for us in 1..=1_000 {
            costs.note(Duration::from_micros(us));
        }
        costs.close(Instant::now() + WINDOW);
        assert!((costs.p99_us - 990.0).abs() < 2.0 && (costs.mean_us - 500.5).abs() < 1.0, "{costs:?}");
        assert!((costs.worst_us - 1_000.0).abs() < 1e-9);
    }
}
