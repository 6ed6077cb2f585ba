//! From a signal of the plant to the raw value that hardware gets.

use super::channel::OutputChannel;
use super::{Force, Mover, Quality};
use crate::mode::Outputs;

/// One output channel at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputState {
    value: Mover,
    arrived: bool,
    quality: Quality,
    /// Values limited to the range since the start.
    saturated: u32,
    /// Values that were not finite since the start.
    not_finite: u32,
    force: Force,
}

impl OutputState {
    /// At its safe value.
    pub const fn new(safe_value: f32) -> Self {
        Self {
            value: Mover::at(safe_value),
            arrived: false,
            quality: Quality::Unknown,
            saturated: 0,
            not_finite: 0,
            force: Force::None,
        }
    }

    /// Output value, in the signal's unit.
    pub fn value(&self) -> f32 {
        self.value.value()
    }

    /// What goes out, in raw counts.
    pub fn raw(&self, channel: &OutputChannel<'_>) -> f32 {
        channel.scaling.to_raw(self.value())
    }

    /// What it is worth.
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// Whether it has reached the plant's value.
    pub fn has_arrived(&self) -> bool {
        self.arrived
    }

    /// Values limited to the range since the start.
    pub fn saturated(&self) -> u32 {
        self.saturated
    }

    /// Values that were not finite since the start.
    pub fn not_finite(&self) -> u32 {
        self.not_finite
    }

    /// Puts something in the channel's place; the plant's value is reached again at the channel's rate.
    pub(super) fn force(&mut self, force: Force) {
        self.force = force;
        self.arrived = false;
    }

    pub(super) fn emit(&mut self, channel: &OutputChannel<'_>, point: f32, step_s: f32, outputs: Outputs) {
        let safe_way = channel.safe_rate_per_s * step_s;
        let follows = match outputs {
            Outputs::Reset | Outputs::Frozen => return,
            Outputs::Safe => None,
            Outputs::Approach | Outputs::Follow => Some(point),
        };
        let follows = follows.map(|point| match &mut self.force {
            Force::Value(value) => *value,
            Force::Stuck => self.value.value(),
            Force::OpenWire => f32::NAN,
            force => force.added(point),
        });
        let Some(point) = follows.filter(|point| point.is_finite()) else {
            self.not_finite = self.not_finite.saturating_add(u32::from(follows.is_some()));
            self.value.towards(channel.safe_value, safe_way);
            self.arrived = false;
            self.quality = match (follows, self.force) {
                (None, _) => Quality::Lost,
                (Some(_), Force::OpenWire) => Quality::OpenWire,
                (Some(_), _) => Quality::NotFinite,
            };
            return;
        };
        let target = point.clamp(channel.min, channel.max);
        let limited = target.to_bits() != point.to_bits();
        self.saturated = self.saturated.saturating_add(u32::from(limited));
        let way = if self.arrived { channel.max_rate_per_s * step_s } else { safe_way };
        let there = self.value.towards(target, way);
        self.arrived |= there;
        self.quality = match (there, limited) {
            (false, _) => Quality::Moving,
            (true, true) => Quality::Saturated,
            (true, false) => Quality::Good,
        };
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that must come through unchanged")]
mod tests {
    use super::super::{Curve, Port, Scaling};
    use super::*;
    use crate::Output;

    const H: f32 = 0.001;

    const CHANNEL: OutputChannel<'_> = OutputChannel {
        signal: Output::MassFlow.of(0),
        port: Port::Link,
        scaling: Scaling::NONE,
        min: -0.1,
        max: 0.1,
        max_rate_per_s: f32::INFINITY,
        safe_value: 0.0,
        safe_rate_per_s: 1.0,
    };

    #[test]
    fn it_approaches_at_its_rate_follows_and_returns_to_its_safe_value() {
        let mut state = OutputState::new(CHANNEL.safe_value);
        let mut last = 0.0_f32;
        let mut run = |state: &mut OutputState, ticks: u32, point: f32, outputs| {
            for _ in 0..ticks {
                state.emit(&CHANNEL, point, H, outputs);
                let moved = (state.value() - last).abs();
                assert!(moved <= 1.001e-3 || state.has_arrived(), "moved by {moved}");
                last = state.value();
            }
        };
        run(&mut state, 20, 0.08, Outputs::Approach);
        assert!(!state.has_arrived() && state.quality() == Quality::Moving);
        run(&mut state, 80, 0.08, Outputs::Approach);
        assert!(state.has_arrived());
        run(&mut state, 1, -0.05, Outputs::Follow);
        assert_eq!((state.value(), state.quality()), (-0.05, Quality::Good), "once there it follows at once");
        run(&mut state, 5, 0.09, Outputs::Frozen);
        assert_eq!(state.value(), -0.05);
        run(&mut state, 200, 0.09, Outputs::Safe);
        assert_eq!((state.value(), state.quality(), state.has_arrived()), (0.0, Quality::Lost, false));
    }

    /// An absolute pressure at a rate that is less than half of its last digit in a tick.
    #[test]
    fn a_slow_way_is_gone_in_its_time() {
        let cabin = OutputChannel { min: 0.0, max: 2e5, safe_value: 1e5, safe_rate_per_s: 2.0, ..CHANNEL };
        let mut state = OutputState::new(cabin.safe_value);
        for _ in 0..10_000 {
            state.emit(&cabin, 101_325.0, H, Outputs::Approach);
        }
        assert!((state.value() - 100_020.0).abs() < 0.02, "{}", state.value());
    }

    #[test]
    fn what_no_hardware_can_take_is_limited_or_replaced() {
        let mut state = OutputState::new(0.0);
        for _ in 0..200 {
            state.emit(&CHANNEL, 5.0, H, Outputs::Follow);
        }
        assert_eq!((state.value(), state.quality()), (0.1, Quality::Saturated));
        for _ in 0..200 {
            state.emit(&CHANNEL, f32::NAN, H, Outputs::Follow);
        }
        assert_eq!((state.value(), state.quality(), state.not_finite()), (0.0, Quality::NotFinite, 200));
    }

    #[test]
    fn raw_is_the_scaling_backwards() {
        let scaling = Scaling {
            electrical: Curve { points: &[[0.0, 0.0], [4095.0, 3.3]] },
            engineering: Curve { points: &[[0.0, -0.1], [3.3, 0.1]] },
            ..Scaling::NONE
        };
        let channel = OutputChannel { scaling, ..CHANNEL };
        let state = OutputState::new(0.05);
        assert!((state.raw(&channel) - 0.75 * 4095.0).abs() < 1e-2);
    }
}
