//! The loop's clock: real time, or for a plant that no hardware hangs on faster, slower, step by step or not at all.
//!
//! The loop asks for the time and sleeps until times on this clock alone, so that a pause is no lag and a scaled run
//! skips nothing. While hardware is armed the clock is the wall's and refuses to be anything else.

use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};

const CLOCK: ClockId = ClockId::Monotonic;

/// What the clock is asked to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// Real time.
    Real,
    /// So many times as fast; infinite for as fast as it goes.
    Scaled(f64),
    /// Stands.
    Paused,
}

/// Returns the wall's clock [ns].
pub fn wall_ns() -> u64 {
    let now = clock_gettime(CLOCK);
    now.tv_sec.cast_unsigned() * 1_000_000_000 + now.tv_nsec.cast_unsigned()
}

/// Sleeps until the wall's clock shows `at_ns`, not at all when that is past.
pub fn sleep_until_wall(at_ns: u64) {
    let tv_nsec = (at_ns % 1_000_000_000).cast_signed();
    let at = Timespec { tv_sec: (at_ns / 1_000_000_000).cast_signed(), tv_nsec };
    while clock_nanosleep_absolute(CLOCK, &at).is_err() {}
}

/// The loop's clock.
#[derive(Debug)]
pub struct Clock {
    pace: Pace,
    /// Where both clocks stood when the pace last changed [ns].
    wall_from: u64,
    from: u64,
}

impl Clock {
    /// Starts with the wall's time.
    pub fn new() -> Self {
        let now = wall_ns();
        Self { pace: Pace::Real, wall_from: now, from: now }
    }

    /// The pace.
    pub fn pace(&self) -> Pace {
        self.pace
    }

    /// The time [ns].
    pub fn now_ns(&self) -> u64 {
        let passed = wall_ns().saturating_sub(self.wall_from);
        match self.pace {
            Pace::Real => self.from + passed,
            Pace::Scaled(speed) if speed.is_finite() => self.from + (passed as f64 * speed) as u64,
            Pace::Scaled(_) | Pace::Paused => self.from,
        }
    }

    /// Changes the pace from now on; refused while hardware is armed.
    pub fn set(&mut self, pace: Pace, armed: bool) -> Result<(), &'static str> {
        if armed && pace != Pace::Real {
            return Err("hardware is armed: time is the wall's");
        }
        if matches!(pace, Pace::Scaled(speed) if speed.is_nan() || speed <= 0.0) {
            return Err("a speed is larger than 0");
        }
        self.from = self.now_ns();
        self.wall_from = wall_ns();
        self.pace = pace;
        Ok(())
    }

    /// Sleeps until `at_ns` on this clock and returns how late it is then [ns]. A clock that stands is moved there:
    /// whoever holds it decides when.
    pub fn sleep_until(&mut self, at_ns: u64) -> u64 {
        let to_go = at_ns.saturating_sub(self.from);
        match self.pace {
            Pace::Real => sleep_until_wall(self.wall_from + to_go),
            Pace::Scaled(speed) if speed.is_finite() => {
                sleep_until_wall(self.wall_from + (to_go as f64 / speed) as u64);
            }
            Pace::Scaled(_) | Pace::Paused => {
                self.from = self.from.max(at_ns);
                self.wall_from = wall_ns();
            }
        }
        self.now_ns().saturating_sub(at_ns)
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_time_is_the_walls() {
        let mut clock = Clock::new();
        let at = clock.now_ns() + 3_000_000;
        let begun = wall_ns();
        clock.sleep_until(at);
        assert!(wall_ns() - begun >= 2_900_000 && clock.now_ns() >= at);
    }

    #[test]
    fn scaled_time_runs_at_its_speed() {
        let mut clock = Clock::new();
        clock.set(Pace::Scaled(100.0), false).unwrap();
        let (begun, at) = (wall_ns(), clock.now_ns() + 1_000_000_000);
        clock.sleep_until(at);
        let took = wall_ns() - begun;
        assert!((9_900_000..500_000_000).contains(&took), "{took}");
        clock.set(Pace::Scaled(f64::INFINITY), false).unwrap();
        let (begun, at) = (wall_ns(), clock.now_ns() + 1_000_000_000_000);
        assert_eq!(clock.sleep_until(at), 0);
        assert!(wall_ns() - begun < 500_000_000 && clock.now_ns() >= at);
    }

    #[test]
    fn a_pause_is_no_lag() {
        let mut clock = Clock::new();
        clock.set(Pace::Paused, false).unwrap();
        let stood = clock.now_ns();
        sleep_until_wall(wall_ns() + 5_000_000);
        assert_eq!(clock.now_ns(), stood);
        clock.set(Pace::Real, false).unwrap();
        assert!(clock.now_ns() - stood < 4_000_000);
    }

    #[test]
    fn armed_hardware_has_the_walls_time() {
        let mut clock = Clock::new();
        for pace in [Pace::Paused, Pace::Scaled(2.0), Pace::Scaled(f64::INFINITY)] {
            assert!(clock.set(pace, true).is_err());
            assert_eq!(clock.pace(), Pace::Real);
        }
        assert!(clock.set(Pace::Scaled(f64::NAN), false).is_err());
        assert_eq!(clock.set(Pace::Real, true), Ok(()));
    }
}
