//! Scheduled inputs: values over time, right-continuous.
//!
//! Time is an integer number of microseconds; a segment of a schedule is measured from its own start, so that
//! an hour into a run a ramp is as exact as at its beginning. Two points at one time are a jump: the later one
//! holds from that time on. Before the first point its value holds, after the last point the last value.

use crate::Fingerprint;

/// How values between two points are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Interpolation {
    /// Straight line from point to point.
    Linear,
    /// The last point's value holds until the next.
    Hold,
}

/// One point of a schedule.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SchedulePoint {
    /// Plant time [µs].
    pub time_us: u64,
    /// Value of the input, in the input's unit and range.
    pub value: f32,
}

/// Drives one input slot along its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Schedule {
    /// The input slot.
    pub input: u32,
    /// First of the schedule's points.
    pub first_point: u32,
    /// Number of points, ≥ 1.
    pub points: u32,
    /// How values between points are found.
    pub interpolation: Interpolation,
}

impl Schedule {
    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        for word in [self.input, self.first_point, self.points, self.interpolation as u32] {
            hash.word(word);
        }
    }

    /// Returns the value at `time_us` [µs] along `points`. `cursor` is the number of points whose time has
    /// come; it only moves forward, so that the usual cost is one comparison.
    pub(crate) fn value(&self, points: &[SchedulePoint], cursor: &mut u32, time_us: u64) -> f32 {
        while points.get(*cursor as usize).is_some_and(|next| next.time_us <= time_us) {
            *cursor += 1;
        }
        let next = points.get(*cursor as usize);
        let last = (*cursor as usize).checked_sub(1).and_then(|index| points.get(index));
        match (last, next) {
            (Some(last), Some(next)) if self.interpolation == Interpolation::Linear => {
                between(last, next, time_us)
            }
            (Some(point), _) | (None, Some(point)) => point.value,
            (None, None) => 0.0,
        }
    }
}

impl SchedulePoint {
    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        hash.long(self.time_us);
        hash.value(self.value);
    }
}

/// Straight line between two points of different time; `time_us` lies between them.
fn between(last: &SchedulePoint, next: &SchedulePoint, time_us: u64) -> f32 {
    let (since, length) = (time_us - last.time_us, next.time_us - last.time_us);
    // Both are shifted until the length fits a u32, which the processor converts in one instruction.
    let shift = 32u32.saturating_sub(length.leading_zeros());
    let part = (since >> shift) as u32 as f32 / (length >> shift) as u32 as f32;
    last.value + (next.value - last.value) * part
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn point(time_us: u64, value: f32) -> SchedulePoint {
        SchedulePoint { time_us, value }
    }

    fn sample(points: &[SchedulePoint], interpolation: Interpolation, time_us: u64) -> f32 {
        let schedule = Schedule { input: 0, first_point: 0, points: points.len() as u32, interpolation };
        schedule.value(points, &mut 0, time_us)
    }

    #[test]
    fn the_valve_ramp_of_the_paper() {
        let ramp = [point(0, 1.0), point(10_000_000, 1.0), point(11_000_000, 0.02)];
        for (time_us, exact) in [
            (0, 1.0),
            (9_999_999, 1.0),
            (10_250_000, 0.755),
            (10_900_000, 0.118),
            (11_000_000, 0.02),
            (u64::MAX, 0.02),
        ] {
            let value = sample(&ramp, Interpolation::Linear, time_us);
            assert!((value - exact).abs() < 1e-6, "{time_us}: {value}");
        }
    }

    #[test]
    fn a_jump_holds_from_its_own_instant_on() {
        let jump = [point(0, 1.0), point(5_000, 1.0), point(5_000, 0.25)];
        assert!((sample(&jump, Interpolation::Linear, 4_999) - 1.0).abs() < 1e-7);
        assert!((sample(&jump, Interpolation::Linear, 5_000) - 0.25).abs() < 1e-7);
        let steps = [point(1_000, 0.5), point(2_000, 0.75)];
        assert!((sample(&steps, Interpolation::Hold, 0) - 0.5).abs() < 1e-7);
        assert!((sample(&steps, Interpolation::Hold, 1_999) - 0.5).abs() < 1e-7);
        assert!((sample(&steps, Interpolation::Hold, 2_000) - 0.75).abs() < 1e-7);
    }

    #[test]
    fn a_day_long_ramp_late_in_a_run_is_as_exact_as_at_its_start() {
        let day = 86_400_000_000u64;
        let ramp = [point(1_000 * day, 0.0), point(1_001 * day, 1.0)];
        for part in [0.1f64, 0.5, 0.9] {
            let time = 1_000 * day + (part * day as f64) as u64;
            assert!((f64::from(sample(&ramp, Interpolation::Linear, time)) - part).abs() < 2e-7);
        }
    }
}
