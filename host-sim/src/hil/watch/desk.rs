//! What the bench knows of the board's channels: the values that it sends, and those that came.

use eclss_core::mode::Mode;
use eclss_core::process::{Port, Quality};
use eclss_core::protocol::{Link as Session, Outgoing, Received, RefusedReason};
use eclss_network_file::Loaded;

use super::super::report::{LinkFigures, RecordFigures};
use super::report::{WatchReport, WatchedChannel};
use crate::Source;
use crate::serve::feed::{Frame, Hardware, Value, Wire};

/// Packets that may be under way: what is sent faster than the board takes it only grows old in a queue.
const UNDER_WAY: u32 = 8;

/// An input of the plant, which the bench drives.
#[derive(Debug)]
struct Driven {
    name: String,
    /// Its place in the process image's inputs.
    channel: usize,
    min: f32,
    max: f32,
    /// Fastest change from one packet to the next.
    most: f32,
    value: f32,
    wanted: f32,
    seen: Quality,
    not_good: u32,
}

/// An output of the plant.
#[derive(Debug)]
struct Shown {
    name: String,
    channel: usize,
    value: f32,
    quality: Quality,
    not_good: u32,
}

/// The bench's values.
#[derive(Debug)]
pub(super) struct Desk {
    loaded: Loaded,
    inputs: Vec<Driven>,
    outputs: Vec<Shown>,
    raw: Vec<f32>,
    mode: Mode,
    cause: u8,
    step_us: u32,
    /// Ticks of the first and the newest packet, and their stamps [µs].
    first: Option<(u64, u64)>,
    newest: (u64, u64),
    missing: u32,
    missing_in_all: u64,
    packets: u64,
}

impl Desk {
    pub(super) fn new(loaded: &Loaded, step_us: u32) -> Self {
        let network = loaded.network();
        let entries = loaded.process.inputs.iter().enumerate();
        let linked = entries.filter(|(_, entry)| entry.channel().port == Port::Link);
        let inputs = linked.map(|(place, entry)| {
            let channel = entry.channel();
            let start = network.inputs.get(channel.slot as usize).copied().unwrap_or(channel.safe_value);
            let value = start.clamp(channel.min, channel.max);
            // Half of what is believed, so that a packet that is lost or late breaks nothing.
            let most = 0.5 * channel.max_rate_per_s * step_us as f32 * 1e-6;
            Driven {
                name: entry.name.clone(),
                channel: place,
                min: channel.min,
                max: channel.max,
                most,
                value,
                wanted: value,
                seen: Quality::Unknown,
                not_good: 0,
            }
        });
        let entries = loaded.process.outputs.iter().enumerate();
        let linked = entries.filter(|(_, entry)| entry.channel().port == Port::Link);
        let outputs = linked.map(|(channel, entry)| Shown {
            name: entry.name.clone(),
            channel,
            value: f32::NAN,
            quality: Quality::Unknown,
            not_good: 0,
        });
        Self {
            inputs: inputs.collect(),
            outputs: outputs.collect(),
            loaded: loaded.clone(),
            raw: Vec::new(),
            mode: Mode::PowerUp,
            cause: 0,
            step_us,
            first: None,
            newest: (0, 0),
            missing: 0,
            missing_in_all: 0,
            packets: 0,
        }
    }

    /// Names of what is recorded: outputs with their quality, inputs as sent with what the board thinks of them.
    pub(super) fn columns(&self) -> Vec<String> {
        let outputs =
            self.outputs.iter().flat_map(|shown| [shown.name.clone(), format!("{}_quality", shown.name)]);
        let inputs = self
            .inputs
            .iter()
            .flat_map(|driven| [format!("{}_sent", driven.name), format!("{}_seen", driven.name)]);
        outputs.chain(inputs).collect()
    }

    /// Values of the columns.
    pub(super) fn figures(&self, into: &mut [f32]) {
        let outputs = self.outputs.iter().flat_map(|shown| [shown.value, f32::from(shown.quality as u8)]);
        let inputs = self.inputs.iter().flat_map(|driven| [driven.value, f32::from(driven.seen as u8)]);
        for (place, value) in into.iter_mut().zip(outputs.chain(inputs)) {
            *place = value;
        }
    }

    /// Takes a packet; returns the mode before and the new one where it has changed.
    pub(super) fn take(&mut self, received: &Received) -> Option<(&'static str, String)> {
        let data = &received.data;
        let quality = |numbers: &[u8], index: usize| {
            let number = numbers.get(index).copied().unwrap_or(0);
            Quality::ALL.get(usize::from(number)).copied().unwrap_or(Quality::Unknown)
        };
        for (index, shown) in self.outputs.iter_mut().enumerate() {
            let scaling = self.loaded.process.outputs.get(shown.channel).map(|entry| {
                entry.channel().scaling.to_value(data.values.get(index).copied().unwrap_or(f32::NAN))
            });
            shown.value = scaling.unwrap_or(f32::NAN);
            shown.quality = quality(&data.quality, index);
            shown.not_good += u32::from(shown.quality != Quality::Good);
        }
        for (index, driven) in self.inputs.iter_mut().enumerate() {
            driven.seen = if data.seen.is_empty() { Quality::Unknown } else { quality(&data.seen, index) };
            driven.not_good += u32::from(driven.seen != Quality::Good);
        }
        // A board that has started anew counts from 0 again.
        let again = received.tick <= self.newest.0;
        self.missing = match self.first {
            Some(_) if !again => (received.tick - self.newest.0 - 1).try_into().unwrap_or(u32::MAX),
            _ => 0,
        };
        self.missing_in_all += u64::from(self.missing);
        self.packets += 1;
        self.newest = (received.tick, received.time_us);
        if again || self.first.is_none() {
            self.first = Some(self.newest);
        }
        let was = std::mem::replace(&mut self.mode, data.mode);
        self.cause = data.cause;
        (was != self.mode).then(|| (was.name(), self.state()))
    }

    /// Mode, with the cause of SAFE.
    pub(super) fn state(&self) -> String {
        match self.cause() {
            Some(cause) => format!("{}: {cause}", self.mode.name()),
            None => self.mode.name().to_owned(),
        }
    }

    /// Why it is SAFE, where it is.
    pub(super) fn cause(&self) -> Option<&'static str> {
        Some(match self.cause {
            0 => return None,
            1 => "its last run did not end well",
            2 => "overruns in a row",
            3 => "too far behind the clock",
            4 => "its plant left its range",
            5 => "the link was silent",
            6 => "an input was lost",
            7 => "somebody asked for it",
            _ => "a cause that this program does not know",
        })
    }

    pub(super) fn mode(&self) -> Mode {
        self.mode
    }

    /// Ticks between the newest packet and the one before of which none came.
    pub(super) fn missing(&self) -> u32 {
        self.missing
    }

    /// Rate of the board's ticks by its own clock [Hz].
    pub(super) fn rate_hz(&self) -> f64 {
        let (first, newest) = (self.first.unwrap_or_default(), self.newest);
        let (ticks, us) = (newest.0.saturating_sub(first.0), newest.1.saturating_sub(first.1));
        if us == 0 { f64::NAN } else { ticks as f64 * 1e6 / us as f64 }
    }

    /// Lets an input go to `value`; refused with what is allowed, `None` where it is no input of the bench.
    pub(super) fn set(&mut self, name: &str, value: f32) -> Option<Result<(), String>> {
        let driven = self.inputs.iter_mut().find(|driven| driven.name == name)?;
        Some(if (driven.min..=driven.max).contains(&value) {
            driven.wanted = value;
            Ok(())
        } else {
            Err(format!("{name} takes {} to {}", driven.min, driven.max))
        })
    }

    /// What an input or output has, where it is one of the bench's.
    pub(super) fn value(&self, name: &str) -> Option<f32> {
        let driven = self.inputs.iter().find(|driven| driven.name == name).map(|driven| driven.value);
        driven.or_else(|| self.outputs.iter().find(|shown| shown.name == name).map(|shown| shown.value))
    }

    /// The outputs, in words.
    pub(super) fn line(&self) -> String {
        let one = |shown: &Shown| match shown.quality {
            Quality::Good => format!(", {} {}", shown.name, shown.value),
            other => format!(", {} {} ({})", shown.name, shown.value, other.name()),
        };
        self.outputs.iter().take(4).map(one).collect()
    }

    /// Moves the inputs on their way and sends them, unless the board is behind with what was sent before.
    pub(super) fn send(&mut self, session: &mut Session, tick: u64, now_us: u64) {
        if session.under_way() > UNDER_WAY {
            session.send_quiet_tick(tick, now_us);
            return;
        }
        self.raw.clear();
        for driven in &mut self.inputs {
            let way = driven.wanted - driven.value;
            driven.value = if way.abs() <= driven.most {
                driven.wanted
            } else {
                driven.value + driven.most.copysign(way)
            };
            let entry = self.loaded.process.inputs.get(driven.channel);
            self.raw.push(entry.map_or(driven.value, |entry| entry.channel().scaling.to_raw(driven.value)));
        }
        let outgoing = Outgoing { mode: Mode::Run, values: &self.raw, ..Outgoing::default() };
        session.send_tick(tick, now_us, &outgoing);
    }

    /// Fills a frame of the page.
    pub(super) fn show(&self, frame: &mut Frame, places: &[Option<usize>], wire: Wire) {
        let outputs = self.outputs.iter().map(|shown| shown.value);
        let known: Vec<f32> = outputs.chain(self.inputs.iter().map(|driven| driven.value)).collect();
        for (value, place) in frame.values.iter_mut().zip(places) {
            *value = place.and_then(|place| known.get(place).copied()).unwrap_or(f32::NAN);
        }
        let figures = &mut frame.figures;
        figures.tick = self.newest.0;
        figures.t_s = self.newest.0 as f64 * f64::from(self.step_us) * 1e-6;
        (figures.overruns, figures.speed) = (None, 1.0);
        figures.paused = self.mode == Mode::Hold;
        for unknown in [
            &mut figures.lag_s,
            &mut figures.mean_us,
            &mut figures.p99_us,
            &mut figures.worst_us,
            &mut figures.headroom,
            &mut figures.closure,
        ] {
            *unknown = f64::NAN;
        }
        (figures.phi, figures.phi_worst) = (f32::NAN, f32::NAN);
        // Cause 4 is a plant that left its range.
        figures.trusted = self.cause != 4;
        let hardware = frame.hardware.get_or_insert_with(Hardware::default);
        hardware.mode = self.mode.name();
        hardware.cause = self.cause();
        hardware.rate_hz = self.rate_hz();
        hardware.link = Some(wire);
        let process = &self.loaded.process;
        hardware.quality = vec![""; process.inputs.len() + process.outputs.len()];
        let inputs = self.inputs.iter().map(|driven| (driven.channel, driven.seen));
        let outputs = self.outputs.iter().map(|shown| (process.inputs.len() + shown.channel, shown.quality));
        for (place, quality) in inputs.chain(outputs) {
            if let Some(shown) = hardware.quality.get_mut(place) {
                *shown = quality.name();
            }
        }
    }

    pub(super) fn report(
        &self,
        source: &Source,
        wall_s: f64,
        link: LinkFigures,
        refused: Option<RefusedReason>,
        record: Option<RecordFigures>,
    ) -> WatchReport {
        let inputs = self.inputs.iter().map(|driven| WatchedChannel {
            name: driven.name.clone(),
            direction: "in",
            value: driven.value,
            quality: driven.seen.name(),
            not_good: driven.not_good,
        });
        let outputs = self.outputs.iter().map(|shown| WatchedChannel {
            name: shown.name.clone(),
            direction: "out",
            value: shown.value,
            quality: shown.quality.name(),
            not_good: shown.not_good,
        });
        WatchReport {
            format: super::super::report::FORMAT,
            network: source.name.clone(),
            network_id: format!("{:016x}", source.loaded.network().id()),
            process_id: format!("{:016x}", source.loaded.process.id()),
            wall_s,
            rate_hz: Some(self.rate_hz()).filter(|rate| rate.is_finite()),
            tick: self.newest.0,
            packets: self.packets,
            missing: self.missing_in_all,
            mode: if self.packets == 0 { "unknown" } else { self.mode.name() },
            cause: self.cause(),
            refused: refused.map(|reason| format!("{reason:?}")),
            channels: inputs.chain(outputs).collect(),
            link,
            record,
        }
    }
}

/// Where each published value stands among outputs and inputs over the link.
pub(super) fn places(loaded: &Loaded, values: &[Value]) -> Vec<Option<usize>> {
    let process = &loaded.process;
    let outputs =
        process.outputs.iter().filter(|entry| entry.channel().port == Port::Link).map(|entry| &entry.name);
    let inputs =
        process.inputs.iter().filter(|entry| entry.channel().port == Port::Link).map(|entry| &entry.name);
    let names: Vec<&String> = outputs.chain(inputs).collect();
    values.iter().map(|value| names.iter().position(|name| **name == value.id)).collect()
}
