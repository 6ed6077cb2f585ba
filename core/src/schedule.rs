//! Scheduled inputs: values over time, right-continuous.
//!
//! Time is an integer number of microseconds; a segment of a schedule is measured from its own start, so that
//! an hour into a run a ramp is as exact as at its beginning. Two points at one time are a jump: the later one
//! holds from that time on. Before the first point its value holds, after the last point the last value.

use crate::Fingerprint;

/// How values between two points are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight line from point to point.
    Linear,
    /// The last point's value holds until the next.
    Hold,
}

/// One point of a schedule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SchedulePoint {
    /// Plant time [µs].
    pub time_us: u64,
    /// Value of the input, in the input's unit and range.
    pub value: f32,
}

/// Drives one input slot along its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    /// Returns the value at the instant `at` along `points`. `cursor` is the number of points whose time has
    /// come; it only moves forward, so that the usual cost is one comparison.
    pub(crate) fn value(&self, points: &[SchedulePoint], cursor: &mut u32, at: Instant) -> f32 {
        while points.get(*cursor as usize).is_some_and(|next| at.has_come(next.time_us)) {
            *cursor += 1;
        }
        let coming = points.get(*cursor as usize);
        let passed = (*cursor as usize).checked_sub(1).and_then(|index| points.get(index));
        let Some(last) = passed.or(coming) else { return 0.0 };
        match self.interpolation {
            Interpolation::Hold => last.value,
            // Before the first point and behind the last both ends are the same one, so that the cost is the same
            // everywhere.
            Interpolation::Linear => between(last, coming.unwrap_or(last), at),
        }
    }
}

/// An instant at which a method asks for its inputs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    /// Whole microseconds of plant time.
    pub(crate) time_us: u64,
    /// And this part of one [µs, 0…1), for stages inside a step.
    pub(crate) part_us: f32,
    /// The end of a step sees what holds just before it; a jump there belongs to the next step.
    pub(crate) before: bool,
}

impl Instant {
    fn has_come(self, time_us: u64) -> bool {
        if self.before { time_us < self.time_us } else { time_us <= self.time_us }
    }
}

impl SchedulePoint {
    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        hash.long(self.time_us);
        hash.value(self.value);
    }
}

/// Straight line between two points, or the value of one point that is both.
fn between(last: &SchedulePoint, next: &SchedulePoint, at: Instant) -> f32 {
    let (since, length) = (at.time_us.saturating_sub(last.time_us), next.time_us - last.time_us);
    // Both are shifted until the length fits a u32, which the processor converts in one instruction; the part
    // of a microsecond only matters where there is no shift.
    let shift = 32u32.saturating_sub(length.leading_zeros());
    let part = if shift == 0 { at.part_us } else { 0.0 };
    let length = crate::math::larger((length >> shift) as u32 as f32, 1.0);
    let passed = ((since >> shift) as u32 as f32 + part) / length;
    last.value + (next.value - last.value) * passed
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn point(time_us: u64, value: f32) -> SchedulePoint {
        SchedulePoint { time_us, value }
    }

    fn sample(points: &[SchedulePoint], interpolation: Interpolation, time_us: u64) -> f32 {
        let schedule = Schedule { input: 0, first_point: 0, points: points.len() as u32, interpolation };
        schedule.value(points, &mut 0, Instant { time_us, part_us: 0.0, before: false })
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
    fn the_end_of_a_step_does_not_see_the_jump_that_is_there() {
        let jump = [point(0, 1.0), point(5_000, 2.0), point(5_000, 7.0), point(6_000, 8.0)];
        let schedule = Schedule { input: 0, first_point: 0, points: 4, interpolation: Interpolation::Linear };
        let mut cursor = 0;
        let mut at = |time_us, part_us, before| {
            schedule.value(&jump, &mut cursor, Instant { time_us, part_us, before })
        };
        assert!((at(4_999, 0.5, false) - 1.9999).abs() < 1e-6);
        assert!((at(5_000, 0.0, true) - 2.0).abs() < 1e-6);
        assert!((at(5_000, 0.0, false) - 7.0).abs() < 1e-6);
        assert!((at(5_585, 0.786, false) - 7.585_786).abs() < 1e-5);
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
