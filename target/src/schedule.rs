//! Release times of a periodic tick, on an absolute grid.
//!
//! A tick that ends after the next release has overrun. The releases it ran over are skipped, so that the
//! next tick starts on the grid again: ticks never come in bursts, and one slow tick delays no other.

use core::num::NonZeroU32;

/// The grid of release times.
#[derive(Clone, Copy, Debug)]
pub struct Schedule {
    period_us: NonZeroU32,
    release_us: u64,
}

impl Schedule {
    /// Starts a grid at `first_us` \[µs since start-up\] with a spacing of `period_us` \[µs\].
    pub fn new(first_us: u64, period_us: NonZeroU32) -> Self {
        Self { period_us, release_us: first_us }
    }

    /// When the current tick is due \[µs since start-up\].
    pub fn release_us(&self) -> u64 {
        self.release_us
    }

    /// Ends the current tick at `now_us` \[µs since start-up\] and moves on to the first release that is not
    /// past. Returns how many releases were skipped: 0 for a tick in time.
    pub fn finish(&mut self, now_us: u64) -> u32 {
        let period = self.period_us.get();
        let elapsed = u32::try_from(now_us.saturating_sub(self.release_us)).unwrap_or(u32::MAX);
        // A tick that ends exactly at the next release is in time.
        let skipped = if elapsed <= period { 0 } else { (elapsed - 1) / period };
        self.release_us += u64::from(period) * (u64::from(skipped) + 1);
        skipped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schedule() -> Schedule {
        Schedule::new(5_000, NonZeroU32::new(1_000).unwrap())
    }

    #[test]
    fn ticks_in_time_keep_the_grid() {
        let mut schedule = schedule();
        for n in 1..100 {
            let used_us = [0, 1, 999, 1_000][n % 4];
            assert_eq!(schedule.finish(schedule.release_us() + used_us), 0);
            assert_eq!(schedule.release_us(), 5_000 + 1_000 * n as u64);
        }
    }

    /// Whatever the tick's length, the next release lies on the grid, is not past, and is the first such.
    #[test]
    fn an_overrun_skips_to_the_next_release() {
        for used_us in [1_001, 1_999, 2_000, 2_001, 123_456, 10_000_000] {
            let mut schedule = schedule();
            let (begun, ended) = (schedule.release_us(), schedule.release_us() + used_us);
            let skipped = schedule.finish(ended);
            assert!(skipped >= 1, "{used_us}");
            assert_eq!(schedule.release_us(), begun + 1_000 * (u64::from(skipped) + 1));
            assert!(schedule.release_us() >= ended && schedule.release_us() < ended + 1_000, "{used_us}");
        }
    }

    #[test]
    fn a_clock_that_stood_still_is_no_overrun() {
        let mut schedule = schedule();
        assert_eq!(schedule.finish(0), 0);
        assert_eq!(schedule.release_us(), 6_000);
    }
}
