//! Durations on the command line: a number and a unit, exact to the microsecond.
//!
//! `1ms`, `0.1ms`, `500us`, `26s`, `2min`, `24h`. A duration that is no whole number of microseconds is
//! refused rather than rounded: plant time is an integer.

use core::fmt;
use core::str::FromStr;

/// A duration in whole microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Duration {
    us: u64,
}

impl Duration {
    /// A duration of `us` microseconds.
    pub const fn from_us(us: u64) -> Self {
        Self { us }
    }

    /// The duration in microseconds.
    pub const fn us(self) -> u64 {
        self.us
    }

    /// The duration in seconds, for reports.
    pub fn seconds(self) -> f64 {
        // Divided, not multiplied: 100 us are 0.0001 s then.
        self.us as f64 / 1e6
    }
}

impl FromStr for Duration {
    type Err = eclss_network_file::DurationError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        eclss_network_file::duration_us(text).map(Self::from_us)
    }
}

impl fmt::Display for Duration {
    /// Writes the duration in the largest unit of s, ms and us in which it is whole, or in seconds with digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.us {
            us if us % 1_000_000 == 0 => write!(f, "{} s", us / 1_000_000),
            us if us > 1_000_000 => write!(f, "{} s", self.seconds()),
            us if us >= 100 => write!(f, "{} ms", us as f64 * 1e-3),
            us => write!(f, "{us} us"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shown_in_a_unit_that_reads_well() {
        let shown = |us| Duration::from_us(us).to_string();
        assert_eq!(shown(26_000_000), "26 s");
        assert_eq!(shown(10_946_000), "10.946 s");
        assert_eq!(shown(1_000), "1 ms");
        assert_eq!(shown(100), "0.1 ms");
        assert_eq!(shown(7), "7 us");
    }
}
