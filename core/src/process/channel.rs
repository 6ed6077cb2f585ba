//! Description of a channel: what it is bound to, how it is scaled, how far and how fast it may go.

use super::{CONVERTERS, Curve};
use crate::parameter::{ParameterError, Reason};
use crate::{Fingerprint, Signal};

/// Where the raw value comes from or goes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Port {
    /// A value in the link's process data; raw is what stands in the frame.
    Link,
    /// One of the board's converters by number; raw is its count.
    Analog(u16),
}

impl Port {
    /// Whether a board can have it.
    pub(super) fn exists(self) -> bool {
        match self {
            Self::Link => true,
            Self::Analog(number) => usize::from(number) < CONVERTERS,
        }
    }
}

/// Who calibrated a signal, and when.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Calibration<'a> {
    /// Number of the certificate or instrument; empty where there is none.
    pub id: &'a str,
    /// Day as a number, 20260131 for 31 January 2026; 0 where there is none.
    pub date: u32,
}

/// From raw counts over volts or milliamperes to the unit of the plant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scaling<'a> {
    /// Raw → electrical [V or mA].
    pub electrical: Curve<'a>,
    /// Electrical → engineering, in the unit of the slot or signal.
    pub engineering: Curve<'a>,
    /// Electrical values that a sound wire can carry; outside of them it is broken or shorted.
    pub wire: Option<[f32; 2]>,
    /// Where the curves come from.
    pub calibration: Calibration<'a>,
}

impl Scaling<'_> {
    /// Raw is engineering.
    pub const NONE: Self = Scaling {
        electrical: Curve::IDENTITY,
        engineering: Curve::IDENTITY,
        wire: None,
        calibration: Calibration { id: "", date: 0 },
    };

    /// Returns the raw value for `engineering`.
    pub fn to_raw(&self, engineering: f32) -> f32 {
        self.electrical.backward(self.engineering.backward(engineering))
    }

    /// Returns the engineering value for `raw`.
    pub fn to_value(&self, raw: f32) -> f32 {
        self.engineering.forward(self.electrical.forward(raw))
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.electrical.check("electrical")?;
        self.engineering.check("engineering")?;
        let ordered =
            self.wire.is_none_or(|[least, most]| least.is_finite() && most.is_finite() && least < most);
        let error = ParameterError { parameter: "wire", reason: Reason::OutsideValidity };
        if ordered { Ok(()) } else { Err(error) }
    }

    fn feed(&self, hash: &mut Fingerprint) {
        self.electrical.feed(hash);
        self.engineering.feed(hash);
        hash.values(&self.wire.unwrap_or([f32::NAN; 2]));
        hash.word(self.calibration.date);
        hash.word(self.calibration.id.len() as u32);
        self.calibration.id.bytes().for_each(|byte| hash.word(u32::from(byte)));
    }
}

/// What an input does between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// Keeps the newest sample.
    Zero,
    /// Goes on along the line through the two newest samples, for a limited time and never after a discrete event.
    Linear,
}

/// From hardware to one input slot of the network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputChannel<'a> {
    /// The slot.
    pub slot: u32,
    /// Where values come from.
    pub port: Port,
    /// From raw to the slot's unit.
    pub scaling: Scaling<'a>,
    /// Smallest and largest value that is believed, in the slot's unit.
    pub min: f32,
    /// See [`Self::min`].
    pub max: f32,
    /// Whether a value beyond the range is limited to it instead of being rejected.
    pub saturates: bool,
    /// Fastest change that is believed [unit/s]; infinite where anything is.
    pub max_rate_per_s: f32,
    /// Time constant of the first-order filter [s]; 0 for none. It delays a slow signal by just this time.
    pub filter_s: f32,
    /// What happens between samples.
    pub hold: Hold,
    /// Ticks without a sample for which a linear hold goes on; afterwards it keeps its value.
    pub extrapolate_ticks: u16,
    /// Change from one sample to the next beyond which it is a discrete event, not a slope [unit].
    pub event_step: f32,
    /// Ticks without an acceptable sample after which the input is lost.
    pub stale_ticks: u16,
    /// What a lost input goes to, within the range.
    pub safe_value: f32,
    /// How fast it goes there, and from the plant's value to the live one [unit/s].
    pub safe_rate_per_s: f32,
    /// Whether losing it leads to SAFE.
    pub essential: bool,
}

impl InputChannel<'_> {
    /// Checks the channel by itself.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.scaling.check()?;
        range(self.min, self.max, self.safe_value, self.safe_rate_per_s)?;
        positive("max_rate_per_s", self.max_rate_per_s)?;
        positive("event_step", self.event_step)?;
        ParameterError::unless_not_negative("filter_s", self.filter_s)
    }

    /// Delay of a slow signal by the filter [s]; the hold adds half a tick, latched outputs a whole one.
    pub fn delay_s(&self) -> f32 {
        self.filter_s
    }

    pub(super) fn feed(&self, hash: &mut Fingerprint) {
        hash.word(self.slot);
        feed_port(self.port, hash);
        self.scaling.feed(hash);
        hash.values(&[self.min, self.max, self.max_rate_per_s, self.filter_s, self.event_step]);
        hash.values(&[self.safe_value, self.safe_rate_per_s]);
        for word in [self.extrapolate_ticks, self.stale_ticks] {
            hash.word(u32::from(word));
        }
        for flag in [self.saturates, self.hold == Hold::Linear, self.essential] {
            hash.word(u32::from(flag));
        }
    }
}

/// From one signal of the plant to hardware.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputChannel<'a> {
    /// The signal.
    pub signal: Signal,
    /// Where values go.
    pub port: Port,
    /// From raw to the signal's unit; followed backwards.
    pub scaling: Scaling<'a>,
    /// Smallest and largest value that is given out, in the signal's unit.
    pub min: f32,
    /// See [`Self::min`].
    pub max: f32,
    /// Fastest change that is given out [unit/s]; infinite where there is no limit.
    pub max_rate_per_s: f32,
    /// What connected hardware takes without harm, within the range.
    pub safe_value: f32,
    /// How fast the output goes there, and back to the plant's value [unit/s].
    pub safe_rate_per_s: f32,
}

impl OutputChannel<'_> {
    /// Checks the channel by itself.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.scaling.check()?;
        range(self.min, self.max, self.safe_value, self.safe_rate_per_s)?;
        positive("max_rate_per_s", self.max_rate_per_s)
    }

    pub(super) fn feed(&self, hash: &mut Fingerprint) {
        self.signal.hash_into(hash);
        feed_port(self.port, hash);
        self.scaling.feed(hash);
        hash.values(&[self.min, self.max, self.max_rate_per_s, self.safe_value, self.safe_rate_per_s]);
    }
}

fn feed_port(port: Port, hash: &mut Fingerprint) {
    hash.word(match port {
        Port::Link => u32::MAX,
        Port::Analog(number) => u32::from(number),
    });
}

/// Greater than 0, possibly infinite.
fn positive(parameter: &'static str, value: f32) -> Result<(), ParameterError> {
    if value > 0.0 { Ok(()) } else { Err(ParameterError { parameter, reason: Reason::NotPositive }) }
}

fn range(min: f32, max: f32, safe_value: f32, safe_rate_per_s: f32) -> Result<(), ParameterError> {
    ParameterError::unless_finite("min", min)?;
    ParameterError::unless_finite("max", max)?;
    positive("safe_rate_per_s", safe_rate_per_s)?;
    let error = |parameter| Err(ParameterError { parameter, reason: Reason::OutsideValidity });
    if min >= max {
        return error("max");
    }
    if (min..=max).contains(&safe_value) { Ok(()) } else { error("safe_value") }
}
