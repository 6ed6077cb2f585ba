//! What the loop knows about its own timing. Pure code: the same on every board, tested on the host.

use core::num::NonZeroU32;

/// Smallest, mean and largest of a series of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spread {
    count: u32,
    sum: u64,
    min: u32,
    max: u32,
}

impl Spread {
    /// No figure yet.
    pub const EMPTY: Self = Self { count: 0, sum: 0, min: u32::MAX, max: 0 };

    /// Takes one more figure.
    pub fn add(&mut self, value: u32) {
        self.count = self.count.saturating_add(1);
        self.sum += u64::from(value);
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }

    /// Smallest figure; 0 before the first.
    pub fn min(&self) -> u32 {
        if self.count == 0 { 0 } else { self.min }
    }

    /// Mean, rounded down; 0 before the first.
    pub fn mean(&self) -> u32 {
        self.sum.checked_div(u64::from(self.count)).unwrap_or(0) as u32
    }

    /// Largest figure; 0 before the first.
    pub fn max(&self) -> u32 {
        self.max
    }
}

/// One tick as it happened.
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// When it was due \[µs since start-up\].
    pub release_us: u64,
    /// When it began \[µs since start-up\], not before its release.
    pub begun_us: u64,
    /// Time from reading inputs to having written outputs \[counts of the board's counter\].
    pub tick_counts: u32,
    /// Share of the plant's step in that \[counts of the board's counter\].
    pub step_counts: u32,
    /// Share of the link in that \[counts of the board's counter\].
    pub link_counts: u32,
    /// Releases that it ran over; 0 when in time.
    pub skipped: u32,
}

/// Running account of all ticks since the loop began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Account {
    period_us: NonZeroU32,
    startup_ticks: u32,
    first_release_us: u64,
    wall_us: u64,
    /// Ticks that ran.
    pub ticks: u64,
    /// Releases at which no tick ran because an earlier one was still running.
    pub skipped: u64,
    /// Ticks that ended after the next release.
    pub overruns: u32,
    /// Those of them among the first ticks, when caches are cold.
    pub startup_overruns: u32,
    /// Overruns in a row up to now; a tick in time sets it to 0.
    pub consecutive_overruns: u32,
    /// The most overruns in a row so far.
    pub worst_consecutive_overruns: u32,
    /// Time from reading inputs to having written outputs \[counts of the board's counter\].
    pub tick_counts: Spread,
    /// Share of the plant's step in that \[counts of the board's counter\].
    pub step_counts: Spread,
    /// Share of the link in that \[counts of the board's counter\].
    pub link_counts: Spread,
    /// How long after its release a tick began \[µs\].
    pub lateness_us: Spread,
}

impl Account {
    /// Opens an account for a grid that starts at `first_release_us` with ticks `period_us` apart, of which
    /// the first `startup_ticks` count as start-up.
    pub fn new(first_release_us: u64, period_us: NonZeroU32, startup_ticks: u32) -> Self {
        Self {
            period_us,
            startup_ticks,
            first_release_us,
            wall_us: 0,
            ticks: 0,
            skipped: 0,
            overruns: 0,
            startup_overruns: 0,
            consecutive_overruns: 0,
            worst_consecutive_overruns: 0,
            tick_counts: Spread::EMPTY,
            step_counts: Spread::EMPTY,
            link_counts: Spread::EMPTY,
            lateness_us: Spread::EMPTY,
        }
    }

    /// Books one finished tick.
    pub fn book(&mut self, tick: &Tick) {
        self.ticks += 1;
        self.wall_us = tick.begun_us.saturating_sub(self.first_release_us);
        self.tick_counts.add(tick.tick_counts);
        self.step_counts.add(tick.step_counts);
        self.link_counts.add(tick.link_counts);
        let late_us = tick.begun_us.saturating_sub(tick.release_us);
        self.lateness_us.add(u32::try_from(late_us).unwrap_or(u32::MAX));
        self.skipped += u64::from(tick.skipped);
        if tick.skipped == 0 {
            self.consecutive_overruns = 0;
            return;
        }
        self.overruns = self.overruns.saturating_add(1);
        if self.ticks <= u64::from(self.startup_ticks) {
            self.startup_overruns += 1;
        }
        self.consecutive_overruns = self.consecutive_overruns.saturating_add(1);
        self.worst_consecutive_overruns = self.worst_consecutive_overruns.max(self.consecutive_overruns);
    }

    /// Tick rate asked for \[mHz\].
    pub fn target_millihertz(&self) -> u32 {
        // The quotient fits: a period is at least 1 µs, hence 10⁹ mHz at most.
        1_000_000_000 / self.period_us.get()
    }

    /// Tick rate reached since the first release \[mHz\]; the target until a second tick has run.
    pub fn actual_millihertz(&self) -> u32 {
        let intervals = self.ticks.saturating_sub(1);
        if intervals == 0 || self.wall_us == 0 {
            return self.target_millihertz();
        }
        (intervals.saturating_mul(1_000_000_000) / self.wall_us) as u32
    }

    /// Time that has passed in the plant at the begin of the latest tick \[µs\].
    pub fn plant_us(&self) -> u64 {
        self.ticks.saturating_sub(1) * u64::from(self.period_us.get())
    }

    /// Time from the first release to the begin of the latest tick \[µs\].
    pub fn wall_us(&self) -> u64 {
        self.wall_us
    }

    /// How far the plant's clock is behind the wall's \[µs\]: skipped releases and the latest lateness.
    pub fn lag_us(&self) -> u64 {
        self.wall_us.saturating_sub(self.plant_us())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: NonZeroU32 = NonZeroU32::new(1_000).unwrap();

    fn tick(n: u64, late_us: u64, skipped: u32) -> Tick {
        let release_us = 7_000 + n * 1_000;
        Tick {
            release_us,
            begun_us: release_us + late_us,
            tick_counts: 40,
            step_counts: 30,
            link_counts: 5,
            skipped,
        }
    }

    #[test]
    fn a_spread_orders_its_figures() {
        let mut spread = Spread::EMPTY;
        assert_eq!((spread.min(), spread.mean(), spread.max()), (0, 0, 0));
        for value in [7, 3, 8] {
            spread.add(value);
        }
        assert_eq!((spread.min(), spread.mean(), spread.max()), (3, 6, 8));
    }

    #[test]
    fn undisturbed_ticks_run_at_the_target_rate_without_lag() {
        let mut account = Account::new(7_000, PERIOD, 10);
        (0..2_001).for_each(|n| account.book(&tick(n, 0, 0)));
        assert_eq!(account.actual_millihertz(), account.target_millihertz());
        assert_eq!((account.plant_us(), account.wall_us(), account.lag_us()), (2_000_000, 2_000_000, 0));
        assert_eq!((account.overruns, account.skipped), (0, 0));
    }

    /// Skipped releases are time that the plant lost: they stay visible as lag, whatever happens later.
    #[test]
    fn skipped_releases_remain_as_lag() {
        let mut account = Account::new(7_000, PERIOD, 0);
        account.book(&tick(0, 0, 3));
        (4..1_000).for_each(|n| account.book(&tick(n, 0, 0)));
        assert_eq!(account.lag_us(), 3_000);
        assert!(account.actual_millihertz() < account.target_millihertz());
    }

    #[test]
    fn overruns_are_counted_in_a_row_and_during_start_up() {
        let mut account = Account::new(7_000, PERIOD, 2);
        let skips = [1, 0, 1, 2, 1, 0, 1];
        let mut n = 0;
        for skipped in skips {
            account.book(&tick(n, 0, skipped));
            n += u64::from(skipped) + 1;
        }
        assert_eq!((account.ticks, account.overruns, account.skipped), (7, 5, 6));
        assert_eq!((account.startup_overruns, account.consecutive_overruns), (1, 1));
        assert_eq!(account.worst_consecutive_overruns, 3);
    }

    #[test]
    fn lateness_is_a_figure_of_its_own() {
        let mut account = Account::new(7_000, PERIOD, 0);
        for (n, late_us) in [(0, 2), (1, 9), (2, 4)] {
            account.book(&tick(n, late_us, 0));
        }
        assert_eq!(
            (account.lateness_us.min(), account.lateness_us.mean(), account.lateness_us.max()),
            (2, 5, 9)
        );
        assert_eq!(account.lag_us(), 4, "the latest tick's lateness");
    }
}
