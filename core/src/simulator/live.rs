//! Inputs from outside: what a sample does between its tick and the next.
//!
//! A live value is known when the tick begins and not at the later stage times of a method, where scheduled inputs
//! are evaluated. It is either held, or continued by its last change: held, a closing valve lags by up to a step,
//! and a second-order method is left with the error of a first-order one (the measured table stands in
//! `docs/hil-host.md`).

use super::Simulator;
use crate::component::Element;
use crate::method::implicit;
use crate::{Method, Network};

/// Why an input was not taken.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum InputError {
    /// The network has no such slot.
    NoSuchSlot,
    /// The slot follows a schedule of the network file.
    Scheduled,
    /// A control loop drives it.
    Controlled,
    /// No element reads the slot, so that it has no range.
    Unused,
    /// NaN or infinite.
    NotFinite,
    /// Outside the range that the slot's elements allow.
    OutOfRange {
        /// Smallest allowed value.
        min: f32,
        /// Largest allowed value.
        max: f32,
    },
}

impl core::fmt::Display for InputError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoSuchSlot => f.write_str("there is no such input"),
            Self::Scheduled => f.write_str("it follows a schedule"),
            Self::Controlled => f.write_str("a control loop drives it"),
            Self::Unused => f.write_str("no element reads it"),
            Self::NotFinite => f.write_str("not a finite number"),
            Self::OutOfRange { min, max } => write!(f, "outside {min} … {max}"),
        }
    }
}

impl core::error::Error for InputError {}

/// An input slot that was found to be settable from outside, and its range; looked up once, used every tick.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LiveInput {
    slot: usize,
    min: f32,
    max: f32,
}

impl LiveInput {
    /// The slot.
    pub fn slot(&self) -> usize {
        self.slot
    }

    /// Smallest and largest allowed value, in the input's unit.
    pub fn range(&self) -> (f32, f32) {
        (self.min, self.max)
    }

    fn check(&self, value: f32) -> Result<(), InputError> {
        if !value.is_finite() {
            Err(InputError::NotFinite)
        } else if value < self.min || value > self.max {
            Err(InputError::OutOfRange { min: self.min, max: self.max })
        } else {
            Ok(())
        }
    }

    fn limit(&self, value: f32) -> f32 {
        if value < self.min {
            self.min
        } else if value > self.max {
            self.max
        } else {
            value
        }
    }
}

impl<E: Element> Network<'_, E> {
    /// Looks up an input slot that is to be set from outside: by an operator, or by a channel of a process image.
    pub fn live_input(&self, slot: usize) -> Result<LiveInput, InputError> {
        if slot >= self.inputs.len() {
            return Err(InputError::NoSuchSlot);
        }
        if self.schedules.iter().any(|schedule| schedule.input as usize == slot) {
            return Err(InputError::Scheduled);
        }
        if self.climate.drives(slot) {
            return Err(InputError::Controlled);
        }
        let (min, max) = self.range_of(slot).ok_or(InputError::Unused)?;
        Ok(LiveInput { slot, min, max })
    }

    /// Whether every slot that something reads has a value that it takes; `value` tells a slot's.
    pub(crate) fn takes_inputs(&self, value: impl Fn(usize) -> Option<f32>) -> bool {
        let takes = |slot: usize, spec: &crate::InputSpec| {
            value(slot).is_some_and(|value| (spec.min..=spec.max).contains(&value))
        };
        let of_segments = self.segments.iter().all(|segment| {
            let specs = (0..).map_while(|index| segment.element.input_spec(index));
            (segment.first_input as usize..).zip(specs).all(|(slot, spec)| takes(slot, &spec))
        });
        let of_climate = |slot| self.climate.spec_of(slot).is_none_or(|spec| takes(slot, &spec));
        of_segments && (0..self.inputs.len()).all(of_climate)
    }

    /// What all elements that read a slot allow; `None` where none does.
    pub(crate) fn range_of(&self, slot: usize) -> Option<(f32, f32)> {
        let mut range = self.climate.spec_of(slot).map(|spec| (spec.min, spec.max));
        for segment in self.segments {
            let index = slot.checked_sub(segment.first_input as usize);
            if let Some(spec) = index.and_then(|index| segment.element.input_spec(index)) {
                let (min, max) = range.unwrap_or((spec.min, spec.max));
                let higher = if spec.min > min { spec.min } else { min };
                range = Some((higher, if spec.max < max { spec.max } else { max }));
            }
        }
        range
    }
}

impl<E: Element> Simulator<'_, E> {
    /// Looks up an input slot that is to be set from outside.
    pub fn live_input(&self, slot: usize) -> Result<LiveInput, InputError> {
        self.network.live_input(slot)
    }

    /// Sets an input for the coming steps, as an operator does; it holds until it is set again.
    pub fn set_input(&mut self, slot: usize, value: f32) -> Result<(), InputError> {
        let input = self.live_input(slot)?;
        self.set_live(&input, value, 0.0)
    }

    /// Sets a live input for the coming step, as [`crate::process::Applied`] says it: `value` when it begins, from
    /// there along a straight line of `slope_per_s` \[unit/s\], kept within the input's range. To be called every
    /// tick where the slope is not 0, because the next step would go through the same values again.
    pub fn set_live(&mut self, input: &LiveInput, value: f32, slope_per_s: f32) -> Result<(), InputError> {
        input.check(value)?;
        let slope_per_s = if slope_per_s.is_finite() { slope_per_s } else { 0.0 };
        let implicit = matches!(self.settings.method, Method::ImplicitEuler | Method::TrBdf2);
        let parts = if implicit { [0.0, implicit::INNER_STAGE, 1.0] } else { [0.0; 3] };
        let change = slope_per_s * (self.settings.step_us as f32 * 1e-6);
        let stages = self.inputs.iter_mut().skip(input.slot).step_by(self.network.inputs.len());
        for (stage, part) in stages.zip(parts) {
            *stage = input.limit(value + part * change);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Settings, Storage, example};

    const VALVE: usize = 1;

    fn with_loop<T>(method: Method, body: impl FnOnce(&mut Simulator<'_>) -> T) -> T {
        let network = example::paper_loop();
        let mut storage = Storage::<64, 192, 8, 4>::new();
        let settings = Settings { method, step_us: 1_000 };
        body(&mut Simulator::new(&network, settings, storage.buffers()).expect("the example is accepted"))
    }

    #[test]
    fn only_what_is_in_range_is_taken() {
        with_loop(Method::TrBdf2, |simulator| {
            assert_eq!(simulator.set_input(7, 1.0), Err(InputError::NoSuchSlot));
            assert_eq!(simulator.set_input(VALVE, f32::NAN), Err(InputError::NotFinite));
            let before = simulator.inputs()[VALVE];
            for wrong in [-0.1, 1.1] {
                assert_eq!(
                    simulator.set_input(VALVE, wrong),
                    Err(InputError::OutOfRange { min: 0.0, max: 1.0 })
                );
            }
            assert_eq!(simulator.inputs()[VALVE].to_bits(), before.to_bits());
            assert_eq!(simulator.set_input(VALVE, 0.5), Ok(()));
            assert!((simulator.inputs()[VALVE] - 0.5).abs() < 1e-9);
        });
    }

    #[test]
    fn a_schedule_keeps_its_input() {
        let points = [crate::SchedulePoint { time_us: 0, value: 1.0 }];
        let schedules = [crate::Schedule {
            input: 1,
            first_point: 0,
            points: 1,
            interpolation: crate::Interpolation::Hold,
        }];
        let network = crate::Network { schedules: &schedules, points: &points, ..example::paper_loop() };
        let mut storage = Storage::<64, 192, 8, 4>::new();
        let settings = Settings { method: Method::Relaxation, step_us: 1_000 };
        let mut simulator = Simulator::new(&network, settings, storage.buffers()).unwrap();
        assert_eq!(simulator.set_input(VALVE, 0.5), Err(InputError::Scheduled));
        assert_eq!(simulator.set_input(0, 0.5), Ok(()));
    }

    /// The line reaches every stage of an implicit method and never leaves the input's range.
    #[test]
    fn a_slope_goes_on_through_the_step_within_the_range() {
        with_loop(Method::TrBdf2, |simulator| {
            let valve = simulator.live_input(VALVE).unwrap();
            simulator.set_live(&valve, 0.5, -200.0).unwrap();
            let stages: std::vec::Vec<f32> =
                simulator.inputs.iter().copied().skip(VALVE).step_by(2).collect();
            for (stage, exact) in stages.iter().zip([0.5, 0.5 - 0.2 * 0.292_893_2, 0.3]) {
                assert!((stage - exact).abs() < 1e-6, "{stages:?}");
            }
            simulator.set_live(&valve, 0.1, -200.0).unwrap();
            assert!(simulator.inputs()[VALVE].abs() < 1e-9, "the range ends at 0");
        });
    }

    #[test]
    fn an_explicit_step_sees_the_sample_alone() {
        with_loop(Method::Adaptive, |simulator| {
            let valve = simulator.live_input(VALVE).unwrap();
            simulator.set_live(&valve, 0.5, -200.0).unwrap();
            assert!((simulator.inputs()[VALVE] - 0.5).abs() < 1e-9);
        });
    }
}
