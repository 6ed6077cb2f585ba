//! Process image: the list of named channels between plant and hardware.
//!
//! An *input* brings a value from hardware to one of the network's input slots, an *output* brings one of the
//! plant's signals to hardware. A channel's description ([`InputChannel`], [`OutputChannel`]) is constant data from
//! the network file; names live with whoever made it. What changes is small: one [`InputState`] or
//! [`OutputState`] a channel.
//!
//! Once a tick [`Process::ingest`] judges what came in and [`Process::emit`] makes what goes out. A signal that is
//! not finite, out of range, faster than allowed or off its wire is rejected and counted by itself: it holds, then
//! goes to its safe value, and touches no other.

mod channel;
mod curve;
mod force;
mod input;
mod mover;
mod output;

pub use channel::{Calibration, Hold, InputChannel, OutputChannel, Port, Scaling};
pub use curve::Curve;
pub use force::Force;
pub use input::{Applied, InputState, Rejected};
use mover::Mover;
pub use output::OutputState;

use crate::mode::Conduct;
use crate::parameter::ParameterError;
use crate::{Fingerprint, InputError, Network, Signal};

/// Most channels in each direction.
pub const CHANNELS: usize = 64;
/// Most converters of a board in each direction.
pub const CONVERTERS: usize = 16;

/// What a channel's value is worth. The number goes over the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Quality {
    /// As measured.
    Good = 0,
    /// No value has come yet.
    #[default]
    Unknown = 1,
    /// The newest value is missing; an earlier one holds.
    Held = 2,
    /// Limited to the channel's range.
    Saturated = 3,
    /// Rejected: NaN or infinite.
    NotFinite = 4,
    /// Rejected: out of range.
    OutOfRange = 5,
    /// Rejected: changed faster than the channel can.
    TooFast = 6,
    /// Rejected: no such voltage or current comes over a sound wire.
    OpenWire = 7,
    /// Nothing acceptable for longer than allowed: the safe value stands in.
    Lost = 8,
    /// On the way to where it should be, at the channel's rate.
    Moving = 9,
}

impl Quality {
    /// Every quality, by its number.
    pub const ALL: [Self; 10] = [
        Self::Good,
        Self::Unknown,
        Self::Held,
        Self::Saturated,
        Self::NotFinite,
        Self::OutOfRange,
        Self::TooFast,
        Self::OpenWire,
        Self::Lost,
        Self::Moving,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Unknown => "nothing yet",
            Self::Held => "held",
            Self::Saturated => "limited",
            Self::NotFinite => "not finite",
            Self::OutOfRange => "out of range",
            Self::TooFast => "too fast",
            Self::OpenWire => "off its wire",
            Self::Lost => "lost",
            Self::Moving => "moving",
        }
    }
}

/// Why a process image was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ProcessError {
    /// More than [`CHANNELS`] in one direction.
    TooMany,
    /// A parameter of an input channel.
    Input(u16, ParameterError),
    /// A parameter of an output channel.
    Output(u16, ParameterError),
    /// An input channel names a slot that takes no value from outside.
    Slot(u16, InputError),
    /// Two input channels drive one slot.
    SlotTwice(u16),
    /// An input channel's range is wider than the slot's.
    SlotRange(u16),
    /// An output channel names a signal that does not exist.
    Signal(u16),
    /// A channel in this direction names a converter that no board has.
    Converter(Direction, u16),
    /// Two output channels go to one converter.
    ConverterTwice(u16),
    /// SAFE after no tick at all.
    SafeAfter,
    /// There are fewer states than channels.
    States,
}

/// Which way a channel goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Direction {
    /// From hardware to the plant.
    In,
    /// From the plant to hardware.
    Out,
}

/// When in a tick outputs are given out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// At its begin, together with reading the inputs: always one tick late, and never more or less.
    #[default]
    Latched,
    /// As soon as the step is done: earlier, at a time that varies with the step's.
    Immediate,
}

/// When a plant in INIT counts as settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// Part of its range by which no output may move \[1\].
    pub part: f32,
    /// For how long \[s\].
    pub time_s: f32,
}

impl Rest {
    /// Without any word in a file.
    pub const DEFAULT: Self = Self { part: 2e-5, time_s: 0.5 };
}

/// The description of a process image, borrowed.
#[derive(Debug, Clone, Copy)]
pub struct Image<'a> {
    /// From hardware to the plant.
    pub inputs: &'a [InputChannel<'a>],
    /// From the plant to hardware.
    pub outputs: &'a [OutputChannel<'a>],
    /// When outputs are given out.
    pub order: Order,
    /// Ticks without data from a link that brings inputs that the plant may run on; one more leads to SAFE. At least 1.
    pub safe_after_ticks: u32,
    /// When INIT is over. No part of the [`Image::id`], because the other end of a link has nothing to do with it.
    pub rest: Rest,
}

impl Default for Image<'_> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Image<'_> {
    /// No channel at all.
    pub const EMPTY: Self =
        Image { inputs: &[], outputs: &[], order: Order::Latched, safe_after_ticks: 20, rest: Rest::DEFAULT };

    /// Whether hardware is bound to the plant.
    pub fn is_bound(&self) -> bool {
        !self.inputs.is_empty() || !self.outputs.is_empty()
    }

    /// Finds the first thing wrong with the description, by itself and for `network`, whose elements know which slots
    /// take values from outside and in which range: [`Network::live_input`].
    pub fn check<E: crate::Element>(&self, network: &Network<'_, E>) -> Result<(), ProcessError> {
        if self.inputs.len() > CHANNELS || self.outputs.len() > CHANNELS {
            return Err(ProcessError::TooMany);
        }
        if self.safe_after_ticks == 0 {
            return Err(ProcessError::SafeAfter);
        }
        for (index, channel) in (0u16..).zip(self.inputs) {
            channel.check().map_err(|error| ProcessError::Input(index, error))?;
            let live = network.live_input(channel.slot as usize);
            let (least, most) = live.map_err(|error| ProcessError::Slot(index, error))?.range();
            if !channel.port.exists() {
                return Err(ProcessError::Converter(Direction::In, index));
            }
            let earlier = self.inputs.get(..usize::from(index)).unwrap_or(&[]);
            if earlier.iter().any(|other| other.slot == channel.slot) {
                return Err(ProcessError::SlotTwice(index));
            }
            if channel.min < least || channel.max > most {
                return Err(ProcessError::SlotRange(index));
            }
        }
        for (index, channel) in (0u16..).zip(self.outputs) {
            channel.check().map_err(|error| ProcessError::Output(index, error))?;
            if !network.publishes(channel.signal) {
                return Err(ProcessError::Signal(index));
            }
            if !channel.port.exists() {
                return Err(ProcessError::Converter(Direction::Out, index));
            }
            let earlier = self.outputs.get(..usize::from(index)).unwrap_or(&[]);
            if channel.port != Port::Link && earlier.iter().any(|other| other.port == channel.port) {
                return Err(ProcessError::ConverterTwice(index));
            }
        }
        Ok(())
    }

    /// A hash over every channel, the same on every machine: both ends of a link must agree on it.
    pub fn id(&self) -> u64 {
        let mut hash = Fingerprint::default();
        hash.word(self.order as u32);
        hash.word(self.safe_after_ticks);
        hash.word(self.inputs.len() as u32);
        for channel in self.inputs {
            channel.feed(&mut hash);
        }
        hash.word(self.outputs.len() as u32);
        for channel in self.outputs {
            channel.feed(&mut hash);
        }
        hash.finish()
    }
}

/// A process image at run time.
#[derive(Debug)]
pub struct Process<'a> {
    image: Image<'a>,
    step_s: f32,
    inputs: &'a mut [InputState],
    outputs: &'a mut [OutputState],
}

impl<'a> Process<'a> {
    /// Starts an image that passed [`Image::check`], for ticks of `step_s` \[s\], with one state a channel.
    pub fn new(
        image: Image<'a>,
        step_s: f32,
        inputs: &'a mut [InputState],
        outputs: &'a mut [OutputState],
    ) -> Result<Self, ProcessError> {
        let inputs = inputs.get_mut(..image.inputs.len()).ok_or(ProcessError::States)?;
        let outputs = outputs.get_mut(..image.outputs.len()).ok_or(ProcessError::States)?;
        for (state, channel) in inputs.iter_mut().zip(image.inputs) {
            *state = InputState::new(channel.safe_value);
        }
        for (state, channel) in outputs.iter_mut().zip(image.outputs) {
            *state = OutputState::new(channel.safe_value);
        }
        Ok(Self { image, step_s, inputs, outputs })
    }

    /// The description.
    pub fn image(&self) -> Image<'a> {
        self.image
    }

    /// Tells which values the plant has, one per input channel: where inputs start from when they are applied.
    pub fn start_from(&mut self, mut value: impl FnMut(&InputChannel<'_>) -> f32) {
        for (state, channel) in self.inputs.iter_mut().zip(self.image.inputs) {
            state.start_from(value(channel));
        }
    }

    /// Judges what came in since the last tick: the raw value of each input channel, `None` where nothing came.
    /// Missing entries count as nothing.
    pub fn ingest(&mut self, raw: &[Option<f32>], conduct: &Conduct) {
        let raw = raw.iter().copied().chain(core::iter::repeat(None));
        for ((state, channel), raw) in self.inputs.iter_mut().zip(self.image.inputs).zip(raw) {
            state.ingest(channel, raw, self.step_s, conduct.inputs);
        }
    }

    /// Slot, value and slope of every input channel for the step that begins now; no slope leads out of its channel's
    /// range within the step.
    pub fn applied(&self) -> impl Iterator<Item = (u32, Applied)> + '_ {
        self.image
            .inputs
            .iter()
            .zip(self.inputs.iter())
            .map(|(channel, state)| (channel.slot, state.applied().within(channel, self.step_s)))
    }

    /// Makes what goes out of the plant's signals. `value` gives a signal's value in its unit.
    pub fn emit(&mut self, mut value: impl FnMut(Signal) -> f32, conduct: &Conduct) {
        for (state, channel) in self.outputs.iter_mut().zip(self.image.outputs) {
            state.emit(channel, value(channel.signal), self.step_s, conduct.outputs);
        }
    }

    /// Puts `force` in a channel's place until another one is; false where there is no such channel, or it cannot carry
    /// the value.
    pub fn force(&mut self, direction: Direction, channel: u16, force: Force) -> bool {
        let place = usize::from(channel);
        let carries = |min: f32, max: f32| match force {
            Force::Value(value) => (min..=max).contains(&value),
            Force::Offset(more) | Force::Noise(more, _) => more.is_finite(),
            Force::None | Force::Stuck | Force::OpenWire => true,
        };
        match direction {
            Direction::In => match (self.image.inputs.get(place), self.inputs.get_mut(place)) {
                (Some(channel), Some(state)) if carries(channel.min, channel.max) => state.force(force),
                _ => return false,
            },
            Direction::Out => match (self.image.outputs.get(place), self.outputs.get_mut(place)) {
                (Some(channel), Some(state)) if carries(channel.min, channel.max) => state.force(force),
                _ => return false,
            },
        }
        true
    }

    /// States of the input channels.
    pub fn inputs(&self) -> &[InputState] {
        self.inputs
    }

    /// States of the output channels.
    pub fn outputs(&self) -> &[OutputState] {
        self.outputs
    }

    /// The first essential input that has been lost.
    pub fn lost_input(&self) -> Option<u16> {
        let mut channels = (0u16..).zip(self.image.inputs.iter().zip(self.inputs.iter()));
        let lost = |channel: &InputChannel<'_>, state: &InputState| {
            channel.essential && state.quality() == Quality::Lost
        };
        channels.find_map(|(index, (channel, state))| lost(channel, state).then_some(index))
    }

    /// Whether the newest sample of every essential input was accepted and is not too old.
    pub fn inputs_good(&self) -> bool {
        self.image
            .inputs
            .iter()
            .zip(self.inputs.iter())
            .all(|(channel, state)| !channel.essential || state.is_good())
    }

    /// Whether every output has reached what it is going to.
    pub fn outputs_arrived(&self) -> bool {
        self.outputs.iter().all(OutputState::has_arrived)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Interpolation, Output, Schedule, SchedulePoint, example};

    const VALVE: InputChannel<'_> = InputChannel {
        slot: 1,
        port: Port::Link,
        scaling: Scaling::NONE,
        min: 0.0,
        max: 1.0,
        saturates: false,
        max_rate_per_s: 4.0,
        filter_s: 0.0,
        hold: Hold::Zero,
        extrapolate_ticks: 1,
        event_step: 0.1,
        stale_ticks: 10,
        safe_value: 0.5,
        safe_rate_per_s: 1.0,
        essential: true,
    };
    const FLOW: OutputChannel<'_> = OutputChannel {
        signal: Output::MassFlow.of(0),
        port: Port::Analog(0),
        scaling: Scaling::NONE,
        min: 0.0,
        max: 0.1,
        max_rate_per_s: 1.0,
        safe_value: 0.0,
        safe_rate_per_s: 1.0,
    };

    fn check(inputs: &[InputChannel<'_>], outputs: &[OutputChannel<'_>]) -> Result<(), ProcessError> {
        Image { inputs, outputs, ..Image::EMPTY }.check(&example::paper_loop())
    }

    #[test]
    fn what_cannot_be_bound_is_refused_by_name() {
        assert_eq!(check(&[VALVE], &[FLOW, OutputChannel { port: Port::Analog(1), ..FLOW }]), Ok(()));
        let input = |channel: InputChannel<'_>| check(&[VALVE, channel], &[]).unwrap_err();
        assert_eq!(input(InputChannel { slot: 9, ..VALVE }), ProcessError::Slot(1, InputError::NoSuchSlot));
        assert_eq!(input(VALVE), ProcessError::SlotTwice(1));
        assert_eq!(check(&[InputChannel { max: 1.5, ..VALVE }], &[]), Err(ProcessError::SlotRange(0)));
        let far = Port::Analog(CONVERTERS as u16);
        assert_eq!(
            check(&[InputChannel { port: far, ..VALVE }], &[]),
            Err(ProcessError::Converter(Direction::In, 0))
        );
        assert_eq!(
            check(&[], &[OutputChannel { port: far, ..FLOW }]),
            Err(ProcessError::Converter(Direction::Out, 0))
        );
        assert_eq!(check(&[], &[FLOW, FLOW]), Err(ProcessError::ConverterTwice(1)));
        let signal = Output::Pressure.of(7);
        assert_eq!(check(&[], &[OutputChannel { signal, ..FLOW }]), Err(ProcessError::Signal(0)));
    }

    /// Every force on an input and on an output: what the plant and the hardware get, and that it is released at the
    /// channel's rate with nothing left.
    #[test]
    #[allow(clippy::float_cmp, reason = "values that must come through unchanged")]
    fn a_channel_is_forced_and_released() {
        let valve = InputChannel { max_rate_per_s: f32::INFINITY, ..VALVE };
        let (inputs, outputs) = ([valve], [FLOW]);
        let (mut states, mut outs) = ([InputState::new(0.0)], [OutputState::new(0.0)]);
        let image = Image { inputs: &inputs, outputs: &outputs, ..Image::EMPTY };
        let mut process = Process::new(image, 1e-3, &mut states, &mut outs).unwrap();
        let conduct = crate::mode::Mode::Run.conduct();
        let ticks = |process: &mut Process<'_>, count: usize, raw: f32| {
            let mut seen = std::vec::Vec::new();
            for _ in 0..count {
                process.ingest(&[Some(raw)], conduct);
                process.emit(|_| 0.05, conduct);
                let [input, output] =
                    [process.applied().next().unwrap().1.value, process.outputs()[0].value()];
                seen.push((input, output));
            }
            seen
        };
        assert_eq!(ticks(&mut process, 2_000, 0.25).pop(), Some((0.25, 0.05)));
        for (force, input, output) in
            [(Force::Value(0.08), 0.08, 0.08), (Force::Offset(0.02), 0.27, 0.07), (Force::Stuck, 0.25, 0.05)]
        {
            assert!(process.force(Direction::In, 0, force) && process.force(Direction::Out, 0, force));
            let seen = ticks(&mut process, 2_000, 0.25);
            let (got_in, got_out) = *seen.last().unwrap();
            assert!(
                (got_in - input).abs() < 1e-6 && (got_out - output).abs() < 1e-6,
                "{force:?}: {got_in} {got_out}"
            );
            assert!(
                process.force(Direction::In, 0, Force::None) && process.force(Direction::Out, 0, Force::None)
            );
            let back = ticks(&mut process, 2_000, 0.25);
            // Valve and flow both change at a rate of 1 in a second.
            assert!(
                back.array_windows().all(|[a, b]| (b.0 - a.0).abs() < 1.1e-3 && (b.1 - a.1).abs() < 1.1e-3)
            );
            assert_eq!(back.last(), Some(&(0.25, 0.05)), "after {force:?}");
        }
        // Stuck keeps what it had, whatever comes.
        process.force(Direction::In, 0, Force::Stuck);
        assert_eq!(ticks(&mut process, 10, 0.9).pop().unwrap().0, 0.25);
        process.force(Direction::In, 0, Force::None);
        ticks(&mut process, 2_000, 0.25);
        // The same noise for the same seed, around the signal and within its amplitude.
        let mut noisy = || {
            process.force(Direction::In, 0, Force::Noise(0.1, 7));
            ticks(&mut process, 1_000, 0.25).split_off(500)
        };
        let (first, second) = (noisy(), noisy());
        assert_eq!(first, second);
        let mean = first.iter().map(|(input, _)| input).sum::<f32>() / 500.0;
        assert!(
            (mean - 0.25).abs() < 0.01 && first.iter().all(|(input, _)| (input - 0.25).abs() <= 0.1),
            "{mean}"
        );
        assert!(first.iter().any(|(input, _)| (input - 0.25).abs() > 0.08));
        // A wire that has come off: the input is lost, the output vouches for nothing.
        process.force(Direction::In, 0, Force::OpenWire);
        process.force(Direction::Out, 0, Force::OpenWire);
        assert_eq!(ticks(&mut process, 2_000, 0.25).pop(), Some((VALVE.safe_value, FLOW.safe_value)));
        assert_eq!(process.outputs()[0].quality(), Quality::OpenWire);
        assert!(process.lost_input().is_some());
        assert!(
            !process.force(Direction::In, 0, Force::Value(7.0))
                && !process.force(Direction::Out, 1, Force::None)
        );
    }

    /// What the simulator would not take from a channel is no channel's to drive.
    #[test]
    fn a_slot_that_a_schedule_drives_takes_no_channel() {
        let points = [SchedulePoint { time_us: 0, value: 1.0 }];
        let schedules =
            [Schedule { input: 1, first_point: 0, points: 1, interpolation: Interpolation::Hold }];
        let network = Network { schedules: &schedules, points: &points, ..example::paper_loop() };
        let refused = Image { inputs: &[VALVE], ..Image::EMPTY }.check(&network);
        assert_eq!(refused, Err(ProcessError::Slot(0, InputError::Scheduled)));
    }
}
