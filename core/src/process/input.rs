//! From a raw sample to the value that the plant gets: judged, filtered, held, moved at its rate.

use super::channel::{Hold, InputChannel};
use super::{Force, Mover, Quality};
use crate::mode::Inputs;

/// Samples rejected since the start, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rejected {
    /// NaN or infinite.
    pub not_finite: u32,
    /// Out of range.
    pub out_of_range: u32,
    /// Changed faster than allowed.
    pub too_fast: u32,
    /// Off the wire.
    pub open_wire: u32,
}

impl Rejected {
    /// All of them together.
    pub fn total(&self) -> u32 {
        [self.not_finite, self.out_of_range, self.too_fast, self.open_wire]
            .into_iter()
            .fold(0, u32::saturating_add)
    }
}

/// What the plant gets in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Applied {
    /// Value at the begin of the step.
    pub value: f32,
    /// How it goes on during the step [unit/s]; 0 for a held value.
    pub slope_per_s: f32,
}

impl Applied {
    /// The same with a slope that ends within the channel's range: hardware has end stops. A value that is outside,
    /// where the plant has it from its start, is not led in by this: that is the channel's rate to do.
    pub(super) fn within(self, channel: &InputChannel<'_>, step_s: f32) -> Self {
        let end = self.value + self.slope_per_s * step_s;
        let (rises, falls) = (self.slope_per_s > 0.0, self.slope_per_s < 0.0);
        let stop = match self.value {
            value if rises && end > channel.max => channel.max - value,
            value if falls && end < channel.min => channel.min - value,
            _ => return self,
        };
        let outward = (rises && stop > 0.0) || (falls && stop < 0.0);
        Self { slope_per_s: if outward { stop / step_s } else { 0.0 }, ..self }
    }
}

/// One input channel at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputState {
    /// What the plant has.
    value: Mover,
    /// Newest accepted sample, filtered, or what stands in for it.
    target: f32,
    /// Newest accepted sample.
    sample: f32,
    /// The same, filtered.
    filtered: Mover,
    /// Along which the target goes on [unit/s].
    slope_per_s: f32,
    /// Ticks since the newest accepted sample; `None` before the first.
    age_ticks: Option<u32>,
    /// Whether the plant has the target, not a value on the way there.
    arrived: bool,
    quality: Quality,
    rejected: Rejected,
    /// Samples limited to the range since the start.
    saturated: u32,
    force: Force,
}

impl InputState {
    /// Before the first sample.
    pub const fn new(value: f32) -> Self {
        Self {
            value: Mover::at(value),
            target: value,
            sample: value,
            filtered: Mover::at(value),
            slope_per_s: 0.0,
            age_ticks: None,
            arrived: false,
            quality: Quality::Unknown,
            rejected: Rejected { not_finite: 0, out_of_range: 0, too_fast: 0, open_wire: 0 },
            saturated: 0,
            force: Force::None,
        }
    }

    /// What the latest sample is worth.
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// Newest accepted value, filtered: what the plant gets, or would get.
    pub fn live(&self) -> f32 {
        self.target
    }

    /// Samples rejected since the start.
    pub fn rejected(&self) -> Rejected {
        self.rejected
    }

    /// Samples limited to the range since the start.
    pub fn saturated(&self) -> u32 {
        self.saturated
    }

    /// Value and slope for the step that begins now.
    pub fn applied(&self) -> Applied {
        let slope_per_s = if self.arrived { self.slope_per_s } else { 0.0 };
        Applied { value: self.value.value(), slope_per_s }
    }

    /// Whether the newest sample was accepted and is not too old.
    pub(super) fn is_good(&self) -> bool {
        matches!(self.quality, Quality::Good | Quality::Saturated | Quality::Moving | Quality::Held)
    }

    pub(super) fn start_from(&mut self, value: f32) {
        self.value = Mover::at(value);
        self.arrived = false;
    }

    pub(super) fn ingest(
        &mut self,
        channel: &InputChannel<'_>,
        raw: Option<f32>,
        step_s: f32,
        inputs: Inputs,
    ) {
        if inputs == Inputs::Ignored {
            return;
        }
        let judged = raw.map(|raw| self.judge(channel, raw, step_s));
        match (self.force, judged) {
            (Force::Value(value), judged) => self.stand_in(value, judged),
            (Force::Stuck, judged) if self.age_ticks.is_some() => self.stand_in(self.target, judged),
            (Force::OpenWire, _) => self.miss(channel, Quality::OpenWire, step_s),
            (Force::Offset(_) | Force::Noise(..), Some(Ok(sample))) => {
                self.accept(channel, sample, step_s);
                // The sample itself stays what the next one is judged by.
                let forced = self.force.added(sample).clamp(channel.min, channel.max);
                self.stand_in(forced, None);
            }
            (_, Some(Ok(sample))) => self.accept(channel, sample, step_s),
            (_, Some(Err(quality))) => self.miss(channel, quality, step_s),
            (_, None) => self.miss(channel, Quality::Held, step_s),
        }
        if inputs != Inputs::Applied {
            self.arrived = false;
            return;
        }
        if self.arrived {
            self.value = Mover::at(self.target);
            return;
        }
        let there = self.value.towards(self.target, channel.safe_rate_per_s * step_s);
        // A lost input never counts as arrived, so that it comes back at its rate as well.
        self.arrived = there && self.quality != Quality::Lost;
        if !self.arrived && self.quality == Quality::Good {
            self.quality = Quality::Moving;
        }
    }

    /// Puts something in the channel's place; what comes after it is released is reached at the channel's rate.
    pub(super) fn force(&mut self, force: Force) {
        self.force = force;
        self.arrived = false;
    }

    /// Takes a forced value as if it had come, and remembers what has come in truth.
    fn stand_in(&mut self, value: f32, judged: Option<Result<f32, Quality>>) {
        if let Some(Ok(sample)) = judged {
            self.sample = sample;
        }
        self.target = value;
        self.filtered = Mover::at(value);
        self.slope_per_s = 0.0;
        self.age_ticks = Some(0);
        self.quality = Quality::Good;
    }

    /// The sample in the slot's unit, or why it is rejected.
    fn judge(&mut self, channel: &InputChannel<'_>, raw: f32, step_s: f32) -> Result<f32, Quality> {
        let count = |counter: &mut u32, quality| {
            *counter = counter.saturating_add(1);
            Err(quality)
        };
        if !raw.is_finite() {
            return count(&mut self.rejected.not_finite, Quality::NotFinite);
        }
        let electrical = channel.scaling.electrical.forward(raw);
        if channel.scaling.wire.is_some_and(|[least, most]| !(least..=most).contains(&electrical)) {
            return count(&mut self.rejected.open_wire, Quality::OpenWire);
        }
        let sample = channel.scaling.engineering.forward(electrical);
        if !sample.is_finite() {
            return count(&mut self.rejected.not_finite, Quality::NotFinite);
        }
        let within = (channel.min..=channel.max).contains(&sample);
        if !within && !channel.saturates {
            return count(&mut self.rejected.out_of_range, Quality::OutOfRange);
        }
        let sample = if within { sample } else { sample.clamp(channel.min, channel.max) };
        if let Some(age) = self.age_ticks {
            // What was far away a while ago may be reached by now: no signal is rejected for ever.
            let ticks = age.saturating_add(1) as f32;
            // Who moves just as fast as is allowed is not refused for what rounding adds to either sample.
            let rounding = 2.0 * f32::EPSILON * (sample.abs() + self.sample.abs());
            if (sample - self.sample).abs() > channel.max_rate_per_s * step_s * ticks + rounding {
                return count(&mut self.rejected.too_fast, Quality::TooFast);
            }
        }
        self.quality = if within { Quality::Good } else { Quality::Saturated };
        self.saturated = self.saturated.saturating_add(u32::from(!within));
        Ok(sample)
    }

    fn accept(&mut self, channel: &InputChannel<'_>, sample: f32, step_s: f32) {
        match self.age_ticks {
            Some(age) if age <= u32::from(channel.stale_ticks) => {
                // Whoever sends less often than every tick is filtered and continued over just as much time.
                let since_s = step_s * age.saturating_add(1) as f32;
                let before = self.filtered.value();
                if channel.filter_s > 0.0 {
                    // Backward Euler: stable for any time constant, and late by just this constant.
                    self.filtered.add(since_s / (channel.filter_s + since_s) * (sample - before));
                } else {
                    self.filtered = Mover::at(sample);
                }
                self.target = self.filtered.value();
                let event = (sample - self.sample).abs() > channel.event_step;
                let recent = age <= u32::from(channel.extrapolate_ticks);
                self.slope_per_s = if channel.hold == Hold::Linear && recent && !event {
                    (self.target - before) / since_s
                } else {
                    0.0
                };
            }
            _ => {
                self.target = sample;
                self.filtered = Mover::at(sample);
                self.slope_per_s = 0.0;
                self.arrived = false;
            }
        }
        self.sample = sample;
        self.age_ticks = Some(0);
    }

    /// Nothing acceptable came: hold, then the safe value.
    fn miss(&mut self, channel: &InputChannel<'_>, quality: Quality, step_s: f32) {
        let age = self.age_ticks.map(|age| age.saturating_add(1));
        if let Some(age) = age {
            self.age_ticks = Some(age);
        }
        match age {
            Some(age) if age <= u32::from(channel.stale_ticks) => {
                // The plant went along the slope in the tick before, so this is where it is.
                let next = self.target + self.slope_per_s * step_s;
                self.target = next.clamp(channel.min, channel.max);
                if age > u32::from(channel.extrapolate_ticks) {
                    self.slope_per_s = 0.0;
                }
                self.quality = quality;
            }
            Some(_) => {
                self.target = channel.safe_value;
                self.slope_per_s = 0.0;
                self.arrived = false;
                self.quality = Quality::Lost;
            }
            None => self.quality = if quality == Quality::Held { Quality::Unknown } else { quality },
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that must come through unchanged")]
mod tests {
    use super::super::{Curve, Port, Scaling};
    use super::*;
    use std::vec::Vec;

    const H: f32 = 0.001;

    const CHANNEL: InputChannel<'_> = InputChannel {
        slot: 0,
        port: Port::Link,
        scaling: Scaling::NONE,
        min: 0.0,
        max: 1.0,
        saturates: false,
        max_rate_per_s: 100.0,
        filter_s: 0.0,
        hold: Hold::Zero,
        extrapolate_ticks: 3,
        event_step: 0.05,
        stale_ticks: 5,
        safe_value: 0.25,
        safe_rate_per_s: 10.0,
        essential: true,
    };

    /// Applies the samples one a tick and returns what the plant got.
    fn applied(channel: &InputChannel<'_>, state: &mut InputState, raw: &[Option<f32>]) -> Vec<Applied> {
        let each = |raw: &Option<f32>| {
            state.ingest(channel, *raw, H, Inputs::Applied);
            state.applied()
        };
        raw.iter().map(each).collect()
    }

    fn arrived(channel: &InputChannel<'_>, value: f32) -> InputState {
        let mut state = InputState::new(value);
        applied(channel, &mut state, &[Some(value), Some(value)]);
        assert!(state.arrived && state.is_good());
        state
    }

    #[test]
    fn whatever_is_not_believed_is_counted_and_changes_nothing() {
        let four_to_twenty = Scaling {
            engineering: Curve { points: &[[4.0, 0.0], [20.0, 1.0]] },
            wire: Some([3.6, 21.0]),
            ..Scaling::NONE
        };
        let channel = InputChannel { scaling: four_to_twenty, ..CHANNEL };
        let cases = [
            (f32::NAN, Quality::NotFinite),
            (f32::INFINITY, Quality::NotFinite),
            (0.0, Quality::OpenWire),
            (21.5, Quality::OpenWire),
            (3.8, Quality::OutOfRange),
            (20.0, Quality::TooFast),
        ];
        for (raw, quality) in cases {
            let mut state = InputState::new(0.5);
            applied(&channel, &mut state, &[Some(12.0), Some(12.0)]);
            let got = applied(&channel, &mut state, &[Some(raw)]);
            assert_eq!((got[0].value, state.quality(), state.rejected().total()), (0.5, quality, 1), "{raw}");
        }
    }

    #[test]
    fn a_value_beyond_the_range_is_limited_where_that_is_wanted() {
        let channel = InputChannel { saturates: true, ..CHANNEL };
        let mut state = arrived(&channel, 0.95);
        let got = applied(&channel, &mut state, &[Some(7.0)]);
        assert_eq!((got[0].value, state.quality(), state.saturated()), (1.0, Quality::Saturated, 1));
    }

    /// A step of the signal is refused at first, and believed once it could have got there at the allowed rate.
    #[test]
    fn a_signal_that_has_moved_is_believed_again() {
        let mut state = arrived(&CHANNEL, 0.2);
        let got = applied(&CHANNEL, &mut state, &[Some(0.55); 4]);
        let values: Vec<f32> = got.iter().map(|got| got.value).collect();
        assert_eq!(values[..3], [0.2; 3]);
        assert_eq!(state.rejected().too_fast, 3);
        assert_eq!(values[3], 0.55);
    }

    #[test]
    fn silence_holds_then_goes_to_the_safe_value_and_back_at_the_rate() {
        let mut state = arrived(&CHANNEL, 0.5);
        let held = applied(&CHANNEL, &mut state, &[None; 5]);
        assert!(held.iter().all(|got| got.value == 0.5) && state.quality() == Quality::Held);
        let lost = applied(&CHANNEL, &mut state, &[None; 40]);
        assert_eq!((state.quality(), state.is_good()), (Quality::Lost, false));
        let mut last = 0.5;
        for got in lost.iter().chain(&applied(&CHANNEL, &mut state, &[Some(0.5); 40])) {
            assert!((got.value - last).abs() <= 10.0 * H * 1.001, "{} after {last}", got.value);
            last = got.value;
        }
        assert_eq!((lost.last().unwrap().value, last), (0.25, 0.5));
        assert_eq!(state.quality(), Quality::Good);
    }

    /// On a ramp the linear hold has the value at any time of the step; it stops after its ticks, and a jump has
    /// no slope.
    #[test]
    fn a_linear_hold_goes_on_along_the_ramp_and_no_further() {
        let channel = InputChannel { hold: Hold::Linear, ..CHANNEL };
        let mut state = arrived(&channel, 0.0);
        let ramp: Vec<_> = (1..=50).map(|n| Some(0.01 * n as f32)).collect();
        for got in &applied(&channel, &mut state, &ramp)[1..] {
            assert!((got.slope_per_s - 10.0).abs() < 1e-2, "{got:?}");
        }
        let held = applied(&channel, &mut state, &[None; 5]);
        // The third tick without a sample ends at 0.54, and there it stays: nothing jumps back.
        for (got, expected) in held.iter().zip([0.51, 0.52, 0.53, 0.54, 0.54]) {
            assert!((got.value - expected).abs() < 1e-5, "{got:?}, not {expected}");
        }
        for pair in held.windows(2) {
            assert!((pair[0].value + pair[0].slope_per_s * H - pair[1].value).abs() < 1e-6, "{pair:?}");
        }
        assert_eq!(held[4].slope_per_s, 0.0);
        let mut state = arrived(&channel, 0.5);
        let jump = applied(&channel, &mut state, &[Some(0.56), Some(0.56)]);
        assert_eq!((jump[0].value, jump[0].slope_per_s), (0.56, 0.0));
    }

    /// A slow ramp comes out late by the time constant.
    #[test]
    fn the_filter_delays_by_its_time_constant() {
        let channel = InputChannel { filter_s: 0.01, max_rate_per_s: f32::INFINITY, ..CHANNEL };
        let mut state = arrived(&channel, 0.0);
        let ramp: Vec<_> = (0..400).map(|n| Some(0.002 * n as f32)).collect();
        let got = applied(&channel, &mut state, &ramp);
        let late = (0.002 * 399.0 - got[399].value) / (0.002 / H);
        assert!((late - channel.delay_s()).abs() < 1e-5, "{late} s");
    }

    /// A controller of a third of the rate: the line goes through its two newest samples, and the filter's delay is the
    /// same in time, not in samples.
    #[test]
    fn a_slower_controller_is_continued_and_filtered_in_its_own_time() {
        let every_third: Vec<_> = (0..600).map(|n| (n % 3 == 0).then_some(0.001 * n as f32)).collect();
        let channel = InputChannel { hold: Hold::Linear, ..CHANNEL };
        let mut state = arrived(&channel, 0.0);
        for (tick, got) in applied(&channel, &mut state, &every_third).iter().enumerate().skip(6) {
            assert!((got.value - 0.001 * tick as f32).abs() < 1e-5, "{got:?} in tick {tick}");
        }
        let channel = InputChannel { filter_s: 0.01, ..CHANNEL };
        let mut state = arrived(&channel, 0.0);
        let got = applied(&channel, &mut state, &every_third);
        let late = (0.001 * 597.0 - got[597].value) / (0.001 / H);
        assert!((late - channel.delay_s()).abs() < 1e-4, "{late} s");
    }

    /// What moves at just the fastest rate that is believed is believed, wherever rounding puts it.
    #[test]
    fn the_fastest_rate_itself_is_no_mistake() {
        let channel = InputChannel { max_rate_per_s: 4.0, ..CHANNEL };
        let mut state = arrived(&channel, 0.0);
        let ramp: Vec<_> = (0..=250).map(|n| Some(0.004 * n as f32)).collect();
        applied(&channel, &mut state, &ramp);
        assert_eq!(state.rejected().total(), 0);
        assert_eq!(applied(&channel, &mut state, &[Some(1.0 - 0.0041)]).len(), 1);
        assert_eq!(state.rejected().too_fast, 1);
    }

    /// A coolant temperature: a thousandth of a degree a second is less than half of the last digit in a tick, and so
    /// is what a slow filter adds. Both get there all the same, in their time.
    #[test]
    fn slow_rates_and_filters_are_not_lost_in_the_last_digit() {
        let coolant = InputChannel {
            min: 270.0,
            max: 320.0,
            safe_value: 280.0,
            safe_rate_per_s: 0.001,
            event_step: 10.0,
            max_rate_per_s: f32::INFINITY,
            ..CHANNEL
        };
        let mut state = InputState::new(290.0);
        let got = applied(&coolant, &mut state, &std::vec![Some(290.1); 60_000]);
        let moved = got[59_999].value - 290.0;
        assert!((moved - 0.06).abs() < 1e-4, "{moved} K in a minute");
        let filtered = InputChannel { filter_s: 10.0, safe_rate_per_s: 10.0, ..coolant };
        let mut state = arrived(&filtered, 290.0);
        let got = applied(&filtered, &mut state, &std::vec![Some(290.1); 60_000]);
        let short = 290.1 - got[59_999].value;
        assert!((short - 0.1 * (-6.0_f32).exp()).abs() < 1e-4, "{short} K short after six time constants");
    }

    /// A plant that starts outside of what hardware can set is led in at the channel's rate, also within the step.
    #[test]
    fn a_start_beyond_the_range_is_left_at_the_rate() {
        let channel = InputChannel { max: 0.5, hold: Hold::Linear, ..CHANNEL };
        let mut state = InputState::new(0.0);
        state.start_from(0.9);
        for got in applied(&channel, &mut state, &[Some(0.3); 30]) {
            let within = got.within(&channel, H);
            assert_eq!((within.value, within.slope_per_s), (got.value, 0.0));
        }
        let up = Applied { value: 0.499, slope_per_s: 10.0 }.within(&channel, H);
        assert!((up.slope_per_s - 1.0).abs() < 1e-3, "{up:?}");
        let down = Applied { value: 0.9, slope_per_s: -10.0 }.within(&channel, H);
        assert_eq!(down.slope_per_s, -10.0);
    }

    /// The plant's value does not jump when inputs are applied, and is not touched before.
    #[test]
    fn inputs_start_from_the_plants_value() {
        let mut state = InputState::new(0.0);
        state.start_from(0.8);
        state.ingest(&CHANNEL, Some(0.3), H, Inputs::Watched);
        assert_eq!((state.applied().value, state.live()), (0.8, 0.3));
        let got = applied(&CHANNEL, &mut state, &[Some(0.3); 60]);
        assert!((got[0].value - 0.79).abs() < 1e-6);
        assert_eq!(got[59].value, 0.3);
    }
}
