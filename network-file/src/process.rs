//! From `[process]` and `[[channel]]` to the core's process image: references, defaults, and the core's own check.

use std::collections::HashMap;

use eclss_core::process::{
    Calibration, Curve, Direction, Hold, Image, InputChannel, Order, OutputChannel, Port, ProcessError, Rest,
    Scaling,
};
use eclss_core::{InputSpec, Output, Signal};

use crate::document::{ChannelEntry, NetworkFile};
use crate::limits;
use crate::loaded::Loaded;
use crate::notes::Notes;
use crate::reason;
use crate::signal::NamedSignal;

/// What a channel's scaling borrows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scales {
    electrical: Vec<[f32; 2]>,
    engineering: Vec<[f32; 2]>,
    wire: Option<[f32; 2]>,
    calibration_id: String,
    calibration_date: u32,
}

impl Scales {
    fn scaling(&self) -> Scaling<'_> {
        Scaling {
            electrical: Curve { points: &self.electrical },
            engineering: Curve { points: &self.engineering },
            wire: self.wire,
            calibration: Calibration { id: &self.calibration_id, date: self.calibration_date },
        }
    }
}

/// An input channel with its name and what it borrows.
#[derive(Debug, Clone, PartialEq)]
pub struct InputEntry {
    /// Name of the slot, as in `valve.opening`.
    pub name: String,
    channel: InputChannel<'static>,
    scales: Scales,
}

impl InputEntry {
    /// Lends the channel.
    pub fn channel(&self) -> InputChannel<'_> {
        InputChannel { scaling: self.scales.scaling(), ..self.channel }
    }
}

/// An output channel with its name and what it borrows.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputEntry {
    /// Name of the signal, as in `loop.mass_flow`.
    pub name: String,
    channel: OutputChannel<'static>,
    scales: Scales,
}

impl OutputEntry {
    /// Lends the channel.
    pub fn channel(&self) -> OutputChannel<'_> {
        OutputChannel { scaling: self.scales.scaling(), ..self.channel }
    }
}

/// The process image of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessTables {
    /// From hardware to the plant, in file order.
    pub inputs: Vec<InputEntry>,
    /// From the plant to hardware, in file order.
    pub outputs: Vec<OutputEntry>,
    /// When outputs are given out.
    pub order: Order,
    /// Ticks of silence after which the plant goes to SAFE.
    pub safe_after_ticks: u32,
    /// When a plant in INIT counts as settled.
    pub rest: Rest,
}

impl Default for ProcessTables {
    fn default() -> Self {
        let Image { order, safe_after_ticks, rest, .. } = Image::EMPTY;
        Self { inputs: Vec::new(), outputs: Vec::new(), order, safe_after_ticks, rest }
    }
}

impl ProcessTables {
    /// Lends all input channels.
    pub fn input_channels(&self) -> Vec<InputChannel<'_>> {
        self.inputs.iter().map(InputEntry::channel).collect()
    }

    /// Lends all output channels.
    pub fn output_channels(&self) -> Vec<OutputChannel<'_>> {
        self.outputs.iter().map(OutputEntry::channel).collect()
    }

    /// Calls `take` with the description that a board runs.
    pub fn with_image<T>(&self, take: impl FnOnce(Image<'_>) -> T) -> T {
        let (inputs, outputs) = (self.input_channels(), self.output_channels());
        let (order, safe_after_ticks, rest) = (self.order, self.safe_after_ticks, self.rest);
        take(Image { inputs: &inputs, outputs: &outputs, order, safe_after_ticks, rest })
    }

    /// Id of the process image, on which both ends of a link must agree.
    pub fn id(&self) -> u64 {
        self.with_image(|image| image.id())
    }
}

/// Converts all channels.
pub(crate) fn lower(
    file: &NetworkFile,
    all: &[NamedSignal],
    specs: &[InputSpec],
    notes: &mut Notes,
) -> ProcessTables {
    let mut tables = ProcessTables::default();
    if let Some(process) = &file.process {
        if process.order.as_deref() == Some("immediate") {
            tables.order = Order::Immediate;
        }
        let or = |given: Option<f64>, default: f32| given.map_or(default, |given| given as f32);
        tables.rest = Rest {
            part: or(process.settled_part, Rest::DEFAULT.part),
            time_s: or(process.settled_s, Rest::DEFAULT.time_s),
        };
        tables.safe_after_ticks = process.safe_after_ticks.unwrap_or(limits::SAFE_AFTER_TICKS) as u32;
    }
    let signals: HashMap<&str, Signal> =
        all.iter().map(|named| (named.name.as_str(), named.signal)).collect();
    let mut bound: HashMap<(&str, &str), usize> = HashMap::new();
    for (index, entry) in file.channels.iter().enumerate() {
        let path = format!("channel[{index}]");
        let Some(&signal) = signals.get(entry.bind.as_str()) else {
            let help =
                "channels are bound to signals like `cabin.pressure`, `loop.mass_flow`, `valve.opening`";
            let span = notes.place(&path, &["bind"]);
            notes.refuse_with(span, format!("there is no signal `{}`", entry.bind), help);
            continue;
        };
        if bound.insert((&entry.bind, &entry.direction), index).is_some() {
            notes.refuse_at(&path, &["bind"], format!("`{}` has such a channel already", entry.bind));
        }
        if entry.direction == "in" {
            if signal.output != Output::Input {
                let reason = format!("`{}` is no input: only inputs take values from hardware", entry.bind);
                notes.refuse_at(&path, &["bind"], reason);
                continue;
            }
            tables.inputs.push(input(entry, signal.owner, &specs[signal.owner as usize], &path, notes));
        } else if let Some(output) = output(entry, signal, &path, notes) {
            tables.outputs.push(output);
        }
    }
    let most = limits::CHANNELS;
    if tables.inputs.len() > most || tables.outputs.len() > most {
        notes.refuse_at("channel", &[], format!("more than {most} channels in one direction"));
    }
    tables
}

fn input(entry: &ChannelEntry, slot: u32, spec: &InputSpec, path: &str, notes: &mut Notes) -> InputEntry {
    let (min, max) =
        (entry.min.map_or(spec.min, |min| min as f32), entry.max.map_or(spec.max, |max| max as f32));
    let keys = &entry.input;
    let channel = InputChannel {
        slot,
        port: port(entry),
        scaling: Scaling::NONE,
        min,
        max,
        saturates: keys.beyond.as_deref() == Some("limit"),
        max_rate_per_s: entry.max_rate_per_s.map_or(f32::INFINITY, |rate| rate as f32),
        filter_s: keys.filter_s.unwrap_or(0.0) as f32,
        hold: if keys.hold.as_deref() == Some("linear") { Hold::Linear } else { Hold::Zero },
        extrapolate_ticks: keys.extrapolate_ticks.unwrap_or(limits::EXTRAPOLATE_TICKS) as u16,
        event_step: keys.event_step.map_or((max - min) * 0.1, |step| step as f32),
        stale_ticks: keys.stale_ticks.unwrap_or(limits::STALE_TICKS) as u16,
        safe_value: entry.safe_value as f32,
        safe_rate_per_s: entry.safe_rate_per_s.map_or(max - min, |rate| rate as f32),
        essential: keys.loss.as_deref() != Some("go_on"),
    };
    InputEntry { name: entry.bind.clone(), channel, scales: scales(entry, path, notes) }
}

fn output(entry: &ChannelEntry, signal: Signal, path: &str, notes: &mut Notes) -> Option<OutputEntry> {
    let (Some(min), Some(max)) = (entry.min, entry.max) else {
        notes.refuse_at(path, &["bind"], "an output needs its range, `min` and `max`");
        return None;
    };
    let (min, max) = (min as f32, max as f32);
    let channel = OutputChannel {
        signal,
        port: port(entry),
        scaling: Scaling::NONE,
        min,
        max,
        max_rate_per_s: entry.max_rate_per_s.map_or(f32::INFINITY, |rate| rate as f32),
        safe_value: entry.safe_value as f32,
        safe_rate_per_s: entry.safe_rate_per_s.map_or(max - min, |rate| rate as f32),
    };
    Some(OutputEntry { name: entry.bind.clone(), channel, scales: scales(entry, path, notes) })
}

fn port(entry: &ChannelEntry) -> Port {
    entry.analog.map_or(Port::Link, |number| Port::Analog(number as u16))
}

fn scales(entry: &ChannelEntry, path: &str, notes: &mut Notes) -> Scales {
    let pairs = |pairs: &[(f64, f64)]| pairs.iter().map(|&(from, to)| [from as f32, to as f32]).collect();
    let date = entry.calibration_date.as_deref().map(|text| {
        date(text).unwrap_or_else(|| {
            let reason = format!("`{text}` is no day; days are like 2026-01-31");
            notes.refuse_at(path, &["calibration_date"], reason);
            0
        })
    });
    Scales {
        electrical: pairs(&entry.electrical),
        engineering: pairs(&entry.scale),
        wire: entry.wire.map(|(least, most)| [least as f32, most as f32]),
        calibration_id: entry.calibration_id.clone().unwrap_or_default(),
        calibration_date: date.unwrap_or(0),
    }
}

/// `2026-01-31` as 20260131.
fn date(text: &str) -> Option<u32> {
    let plain = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
    let parts: Vec<&str> = text.split('-').filter(plain).collect();
    let [year, month, day] = parts[..] else { return None };
    let fits = (year.len(), month.len(), day.len(), text.len()) == (4, 2, 2, 10);
    let (year, month, day): (u32, u32, u32) = (year.parse().ok()?, month.parse().ok()?, day.parse().ok()?);
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        2 => 28 + u32::from(leap),
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    };
    let exists = (1..=12).contains(&month) && (1..=days).contains(&day);
    (fits && exists).then_some(10_000 * year + 100 * month + day)
}

/// The core's last word on the image.
pub(crate) fn check(loaded: &Loaded, notes: &mut Notes) {
    let Err(error) = loaded.process.with_image(|image| image.check(&loaded.network())) else { return };
    let channel = |direction: &str, index: u16| {
        let mut places =
            loaded.file.channels.iter().enumerate().filter(|(_, entry)| entry.direction == direction);
        format!("channel[{}]", places.nth(usize::from(index)).map_or(0, |(place, _)| place))
    };
    let (path, keys, reason): (String, &[&str], String) = match error {
        ProcessError::TooMany => ("channel".into(), &[], "too many channels".into()),
        ProcessError::SafeAfter => {
            ("process".into(), &["safe_after_ticks"], "`safe_after_ticks` must be 1 or more".into())
        }
        ProcessError::Input(index, error) => {
            (channel("in", index), reason::keys_of(error.parameter), reason::text(error))
        }
        ProcessError::Output(index, error) => {
            (channel("out", index), reason::keys_of(error.parameter), reason::text(error))
        }
        ProcessError::Slot(index, error) => {
            (channel("in", index), &["bind"], format!("no hardware can drive the input: {error}"))
        }
        ProcessError::SlotTwice(index) => {
            (channel("in", index), &["bind"], "another channel drives the input".into())
        }
        ProcessError::Converter(direction, index) => {
            let words = if direction == Direction::In { "in" } else { "out" };
            (channel(words, index), &["analog"], "no board has this converter".into())
        }
        ProcessError::ConverterTwice(index) => {
            (channel("out", index), &["analog"], "another output goes to this converter".into())
        }
        ProcessError::SlotRange(index) => {
            (channel("in", index), &["min", "max"], "the range is wider than the input's own".into())
        }
        ProcessError::Signal(index) => (channel("out", index), &["bind"], "there is no such signal".into()),
        // There are as many states as channels wherever there are any.
        ProcessError::States => return,
    };
    notes.refuse_at(&path, keys, reason);
}
