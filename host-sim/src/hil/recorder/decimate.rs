//! Fewer rows without losing peaks: every so many ticks one bucket with last, smallest and largest value.

use super::super::handover::Row;

/// What is known of a number of ticks in a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Bucket {
    /// The last tick's row.
    pub last: Row,
    /// Smallest value of each figure; NaN where all were.
    pub min: Vec<f32>,
    /// Largest value of each figure.
    pub max: Vec<f32>,
    /// Ticks in the bucket.
    pub ticks: u64,
    /// Longest lateness [ns].
    pub late_ns: u32,
    /// Longest tick [ns].
    pub tick_ns: u32,
    /// Releases skipped.
    pub skipped: u64,
}

/// Collects ticks into buckets.
#[derive(Debug)]
pub struct Decimator {
    every: u64,
    bucket: Option<Bucket>,
}

impl Decimator {
    /// One bucket for every `every` ticks, by the loop's count of them.
    pub fn new(every: u64) -> Self {
        Self { every: every.max(1), bucket: None }
    }

    /// Takes a tick; returns the bucket that it completes.
    pub fn add(&mut self, row: &Row) -> Option<Bucket> {
        // By number and not by count, so that a dropped row does not shift the grid.
        let ends = (row.head.tick + 1).is_multiple_of(self.every);
        let behind = self
            .bucket
            .as_ref()
            .is_some_and(|bucket| bucket.last.head.tick / self.every != row.head.tick / self.every);
        // A bucket whose last tick was dropped ends late.
        let late = if behind { self.bucket.take() } else { None };
        let bucket = self.bucket.get_or_insert_with(|| Bucket {
            last: row.clone(),
            min: row.figures.clone(),
            max: row.figures.clone(),
            ticks: 0,
            late_ns: 0,
            tick_ns: 0,
            skipped: 0,
        });
        bucket.last.clone_from(row);
        bucket.ticks += 1;
        bucket.late_ns = bucket.late_ns.max(row.head.late_ns);
        bucket.tick_ns = bucket.tick_ns.max(row.head.tick_ns);
        bucket.skipped += u64::from(row.head.skipped);
        for ((min, max), value) in bucket.min.iter_mut().zip(&mut bucket.max).zip(&row.figures) {
            // A NaN gives way to a number.
            *min = min.min(*value);
            *max = max.max(*value);
        }
        late.or_else(|| if ends { self.bucket.take() } else { None })
    }

    /// Ends the bucket that is not full yet.
    pub fn rest(&mut self) -> Option<Bucket> {
        self.bucket.take()
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::handover::Head;
    use super::*;

    fn row(tick: u64, value: f32) -> Row {
        let head = Head { tick, late_ns: tick as u32, skipped: 1, ..Head::default() };
        Row { head, inputs: Vec::new(), figures: vec![value, f32::NAN] }
    }

    /// A peak of a single tick is in the record, whatever the decimation.
    #[test]
    fn no_peak_is_lost() {
        for every in [1, 2, 7, 100, 1_000] {
            let mut decimator = Decimator::new(every);
            let value = |tick: u64| match tick {
                123 => 50.0,
                456 => -50.0,
                _ => (tick as f32 * 0.1).sin(),
            };
            let mut buckets: Vec<_> =
                (0..1_000).filter_map(|tick| decimator.add(&row(tick, value(tick)))).collect();
            buckets.extend(decimator.rest());
            assert_eq!(buckets.len() as u64, 1_000u64.div_ceil(every));
            assert_eq!(buckets.iter().map(|bucket| bucket.ticks).sum::<u64>(), 1_000);
            assert_eq!(buckets.iter().map(|bucket| bucket.skipped).sum::<u64>(), 1_000);
            let (min, max) = buckets.iter().fold((f32::MAX, f32::MIN), |(min, max), bucket| {
                assert!(bucket.min[0] <= bucket.last.figures[0] && bucket.last.figures[0] <= bucket.max[0]);
                (min.min(bucket.min[0]), max.max(bucket.max[0]))
            });
            assert_eq!((min, max), (-50.0, 50.0));
            assert!(buckets[0].min[1].is_nan());
        }
    }

    #[test]
    fn a_dropped_row_does_not_shift_the_grid() {
        let mut decimator = Decimator::new(10);
        let kept = (0..40).filter(|tick| *tick != 9 && !(15..25).contains(tick));
        let mut ends: Vec<_> = kept.filter_map(|tick| decimator.add(&row(tick, 0.0))).collect();
        ends.extend(decimator.rest());
        let ends: Vec<_> = ends.iter().map(|bucket| (bucket.last.head.tick, bucket.ticks)).collect();
        assert_eq!(ends, [(8, 9), (14, 5), (29, 5), (39, 10)]);
    }
}
