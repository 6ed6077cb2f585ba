//! What a run's ticks took: histograms that are filled inside the loop without allocating.

use hdrhistogram::Histogram;
use serde::Serialize;

/// Longest time that a histogram tells from longer ones [ns].
const LONGEST_NS: u64 = 10_000_000_000;
/// Significant decimal digits.
const DIGITS: u8 = 3;

/// Times of one kind [ns].
#[derive(Debug, Clone)]
pub struct Times(Histogram<u64>);

impl Default for Times {
    fn default() -> Self {
        Self::new()
    }
}

impl Times {
    /// No time yet; this allocates once.
    ///
    /// # Panics
    /// Never: the bounds are constants that a histogram takes.
    pub fn new() -> Self {
        Self(Histogram::new_with_bounds(1, LONGEST_NS, DIGITS).expect("constant bounds"))
    }

    /// Takes one time [ns]; what is longer than ten seconds counts as ten seconds.
    pub fn add(&mut self, ns: u64) {
        self.0.saturating_record(ns);
    }

    /// Returns the figures that reports show.
    pub fn summary(&self) -> Summary {
        let us = |ns: u64| ns as f64 / 1e3;
        if self.0.is_empty() {
            return Summary::default();
        }
        Summary {
            count: self.0.len(),
            min_us: us(self.0.min()),
            avg_us: self.0.mean() / 1e3,
            p50_us: us(self.0.value_at_quantile(0.5)),
            p99_us: us(self.0.value_at_quantile(0.99)),
            p999_us: us(self.0.value_at_quantile(0.999)),
            max_us: us(self.0.max()),
        }
    }

    /// Returns how many times lie up to each power of two of microseconds and above the last, empty ends cut off.
    pub fn buckets(&self) -> Vec<Bucket> {
        let mut buckets = Vec::new();
        let mut above = 0;
        for power in 0..=24u32 {
            let up_to = (1u64 << power) * 1_000;
            let count = self.0.count_between(above, up_to);
            buckets.push(Bucket { up_to_us: 1 << power, count });
            // Equivalent values share a bucket; the next begins behind it.
            above = self.0.highest_equivalent(up_to) + 1;
        }
        let used = |bucket: &Bucket| bucket.count > 0;
        let last = buckets.iter().rposition(used).map_or(0, |last| last + 1);
        buckets.truncate(last);
        let first = buckets.iter().position(used).unwrap_or(0);
        buckets.split_off(first)
    }
}

/// Figures of times of one kind [µs].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Summary {
    /// How many.
    pub count: u64,
    /// Smallest.
    pub min_us: f64,
    /// Mean.
    pub avg_us: f64,
    /// Median.
    pub p50_us: f64,
    /// 99 of 100 are not longer.
    pub p99_us: f64,
    /// 999 of 1000 are not longer.
    pub p999_us: f64,
    /// Largest.
    pub max_us: f64,
}

/// A part of a histogram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Bucket {
    /// Up to this time [µs], and longer than the bucket before.
    pub up_to_us: u64,
    /// How many.
    pub count: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_times() {
        let mut times = Times::new();
        (1..=1_000).for_each(|us| times.add(us * 1_000));
        let summary = times.summary();
        assert_eq!(summary.count, 1_000);
        for (figure, exact) in [
            (summary.min_us, 1.0),
            (summary.avg_us, 500.5),
            (summary.p50_us, 500.0),
            (summary.p99_us, 990.0),
            (summary.p999_us, 999.0),
            (summary.max_us, 1_000.0),
        ] {
            assert!((figure / exact - 1.0).abs() < 2e-3, "{summary:?}");
        }
    }

    #[test]
    fn every_time_is_in_one_bucket() {
        let mut times = Times::new();
        let mut dice = 1u64;
        for _ in 0..10_000 {
            dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            times.add(1_000 + (dice >> 44));
        }
        let buckets = times.buckets();
        assert_eq!(buckets.iter().map(|bucket| bucket.count).sum::<u64>(), 10_000, "{buckets:?}");
        assert!(buckets.first().is_some_and(|bucket| bucket.count > 0));
        assert!(buckets.last().is_some_and(|bucket| bucket.count > 0));
    }

    #[test]
    fn what_is_too_long_is_counted() {
        let mut times = Times::new();
        times.add(u64::MAX);
        assert_eq!(times.summary().count, 1);
        assert!(times.summary().max_us > 9.9e6);
        assert!(Times::new().buckets().is_empty());
    }
}
