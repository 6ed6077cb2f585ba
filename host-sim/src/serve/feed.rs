//! What a page shows and what it asks for: ids once, values often, commands back.
//!
//! A [`Feed`] is the page's end and a [`Publisher`] the plant's. Whatever computes or relays a plant can hold the
//! publisher: the thread of [`super::plant`], or the loop of `hil`, or a link to a board. Between the two stands one slot:
//! the plant tries its lock, never waits for it, and a frame that nobody has fetched is replaced and counted.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use eclss_core::Excursion;
use eclss_core::climate::monitor::Limit;
use eclss_network_file::NamedSignal;

/// Commands that wait at most; more are refused, so that nobody fills the plant's memory.
const COMMANDS: usize = 64;

/// A published value.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Value {
    /// Id, such as `cabin.pressure`, `fan.mass_flow`, `valve.opening`, `loop.phi`. The part before the last dot is a
    /// node, line or element; the page draws what it knows by the part behind it and lists everything.
    pub id: String,
    /// Unit; `1` for a ratio.
    pub unit: String,
    /// Name for people.
    pub label: &'static str,
    /// Name of its form, [`eclss_core::signal::Display::name`]: which unit people read, gauge or absolute.
    pub display: &'static str,
}

impl Value {
    /// Published description of a signal.
    pub fn of(named: &NamedSignal) -> Self {
        let spec = &named.spec;
        Self {
            id: named.name.clone(),
            unit: spec.unit().to_owned(),
            label: spec.label,
            display: spec.display.name(),
        }
    }
}

/// An input that can be moved.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Input {
    /// Id, such as `valve.opening`; a value of the same id is published.
    pub id: String,
    /// Unit.
    pub unit: String,
    /// Name of its form, as of a [`Value`].
    pub display: &'static str,
    /// Smallest value.
    pub min: f32,
    /// Largest value.
    pub max: f32,
}

/// How an input can fail. Until it is repaired the input follows no slider.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Malfunction {
    /// It stays where it is.
    Stuck,
    /// It goes to its lower end: a valve shut, a fan stopped.
    Low,
    /// It goes to its upper end: a valve open, a fan running away.
    High,
}

/// What the page asks of the plant.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Moves an input.
    Set {
        /// Its number among [`Catalogue::inputs`].
        input: usize,
        /// Value; kept within the input's range.
        value: f32,
    },
    /// Breaks an input, or repairs it.
    Break {
        /// Its number.
        input: usize,
        /// How; nothing repairs.
        how: Option<Malfunction>,
    },
    /// Holds the plant, or lets it run.
    Pause {
        /// Whether it is held.
        on: bool,
    },
    /// Takes this many steps and holds.
    Step {
        /// Steps; at most a million.
        steps: u32,
    },
    /// Sets how much faster than the clock the plant runs.
    Speed {
        /// Factor, 0.01 … 1000.
        factor: f32,
    },
    /// Starts anew with a scenario.
    Scenario {
        /// Its number among [`Catalogue::scenarios`].
        number: usize,
    },
}

/// Everything that does not change while a page is open.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Catalogue {
    /// Title of the network.
    pub title: String,
    /// Where it came from.
    pub source: String,
    /// What computes it, such as `this computer` or a board's name.
    pub plant: String,
    /// Id of the network, hexadecimal.
    pub network_id: String,
    /// Method and step, for people.
    pub method: String,
    /// Whether transients are pseudo-time, so that only states of rest are physical.
    pub pseudo_time: bool,
    /// Pressure from which gauge pressures count [Pa].
    pub reference_pa: f32,
    /// Whether commands are taken.
    pub control: bool,
    /// Scenarios, the first one running at the start.
    pub scenarios: Vec<String>,
    /// Published values.
    pub values: Vec<Value>,
    /// Inputs.
    pub inputs: Vec<Input>,
    /// Nodes in the numbering of the schematic.
    pub nodes: Vec<NodeInfo>,
    /// Lines in the numbering of the schematic.
    pub lines: Vec<LineInfo>,
    /// Channels to hardware, inputs first; empty where there is none.
    pub channels: Vec<ChannelInfo>,
}

/// A channel to hardware.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct ChannelInfo {
    /// Id of its slot or point.
    pub id: String,
    /// Whether it goes from hardware to the plant.
    pub input: bool,
}

/// A node for the page.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NodeInfo {
    /// Id.
    pub id: String,
    /// Kind.
    pub kind: String,
    /// Temperature where none is published [K].
    pub temperature_k: f32,
}

/// A line for the page.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LineInfo {
    /// Id.
    pub id: String,
    /// Node at the inlet.
    pub from: usize,
    /// Node at the outlet.
    pub to: usize,
    /// Ids and kinds of its elements.
    pub elements: Vec<(String, String)>,
}

/// Real-time and health figures of one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Figures {
    /// Steps taken.
    pub tick: u64,
    /// Plant time [s].
    pub t_s: f64,
    /// Number of the scenario.
    pub scenario: usize,
    /// Whether the plant is held.
    pub paused: bool,
    /// Asked speed over the clock's [1].
    pub speed: f32,
    /// Wake-ups that came too late and were skipped; none where nobody tells.
    pub overruns: Option<u64>,
    /// Time that the plant lies behind the clock by them [s].
    pub lag_s: f64,
    /// Mean time of a step over the last window [µs].
    pub mean_us: f64,
    /// 99th percentile of the time of a step over the last window [µs].
    pub p99_us: f64,
    /// Longest step so far [µs].
    pub worst_us: f64,
    /// Part of the time between two wake-ups that is left over [1].
    pub headroom: f64,
    /// Smallest φ of the last step [1].
    pub phi: f32,
    /// Smallest φ of all steps [1].
    pub phi_worst: f32,
    /// What the mass ledger lacks over all mass [1].
    pub closure: f64,
    /// Whether the run may be trusted.
    pub trusted: bool,
    /// Number of the node or line that left its range, where one did.
    pub fault_node: Option<u32>,
    /// See [`Self::fault_node`].
    pub fault_line: Option<u32>,
    /// What left its range there, its value and the range, in words.
    #[serde(serialize_with = "in_words")]
    pub fault: Option<Excursion>,
    /// Number of the first node of which something is doubtful, though the run goes on.
    pub warned_node: Option<u32>,
    /// What, in words.
    pub warning: Option<&'static str>,
    /// Commands that were refused: out of range, of a scheduled input.
    pub refused: u64,
}

impl Figures {
    /// Takes over the first node of which something is doubtful, and what.
    pub fn warn(&mut self, first: Option<(usize, Limit)>) {
        (self.warned_node, self.warning) =
            (first.map(|(node, _)| node as u32), first.map(|(_, limit)| limit.text()));
    }
}

#[allow(clippy::ref_option, reason = "the form that serde asks for")]
fn in_words<S: serde::Serializer>(what: &Option<Excursion>, to: S) -> Result<S::Ok, S::Error> {
    match what {
        Some(what) => to.collect_str(what),
        None => to.serialize_none(),
    }
}

/// The loop and its hardware at one moment.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Hardware {
    /// Mode.
    pub mode: &'static str,
    /// Why it is SAFE, where it is.
    pub cause: Option<&'static str>,
    /// Rate reached [Hz].
    pub rate_hz: f64,
    /// Ticks that ended after the next release; none where a board does not tell.
    pub overruns: Option<u32>,
    /// The most of them in a row.
    pub overruns_in_a_row: Option<u32>,
    /// Releases at which no tick ran.
    pub missed: Option<u64>,
    /// Longest wake-up after its release [µs].
    pub late_us: Option<u32>,
    /// What each channel is worth, in the order of [`Catalogue::channels`].
    pub quality: Vec<&'static str>,
    /// Values of each channel that were rejected since the start.
    pub rejected: Vec<u32>,
    /// The link, where there is one.
    pub link: Option<Wire>,
}

/// A link at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Wire {
    /// Whether there is a session.
    pub connected: bool,
    /// Sessions that began.
    pub sessions: u32,
    /// Frames that were taken.
    pub accepted: u32,
    /// Frames that never came.
    pub lost: u32,
    /// Frames that came late, out of order or twice.
    pub late: u32,
    /// Frames that were damaged.
    pub damaged: u32,
    /// Frames that were meant for somebody else.
    pub foreign: u32,
    /// Ticks since data came.
    pub silence: u32,
    /// Time that a frame takes to the peer and back [µs], of the fastest exchange.
    pub round_trip_us: Option<u64>,
}

/// All values of one moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// Figures.
    pub figures: Figures,
    /// Values in the order of [`Catalogue::values`].
    pub values: Vec<f32>,
    /// State of each input.
    pub inputs: Vec<InputState>,
    /// The loop and its hardware, where the plant runs in one.
    pub hardware: Option<Hardware>,
}

/// What moves an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InputState {
    /// Whoever holds its slider.
    #[default]
    Free,
    /// The scenario's schedule.
    Scheduled,
    /// A control loop of the plant.
    Controlled,
    /// Nobody: it is broken.
    Stuck,
    /// Nobody: it is broken.
    Low,
    /// Nobody: it is broken.
    High,
}

/// The slot between plant and page.
#[derive(Debug, Default)]
struct Slot {
    frame: Mutex<(Frame, bool)>,
    dropped: AtomicU64,
}

/// The plant's end.
#[derive(Debug)]
pub struct Publisher {
    slot: Arc<Slot>,
    commands: Receiver<Command>,
    next: Frame,
}

/// The page's end.
#[derive(Debug, Clone)]
pub struct Feed {
    /// What does not change.
    pub catalogue: Arc<Catalogue>,
    slot: Arc<Slot>,
    commands: SyncSender<Command>,
}

/// Joins a plant and a page.
pub fn feed(catalogue: Catalogue) -> (Publisher, Feed) {
    let slot = Arc::new(Slot::default());
    let (sender, receiver) = sync_channel(COMMANDS);
    let blank = || Frame {
        figures: Figures::default(),
        values: vec![f32::NAN; catalogue.values.len()],
        inputs: vec![InputState::Free; catalogue.inputs.len()],
        hardware: None,
    };
    if let Ok(mut held) = slot.frame.lock() {
        held.0 = blank();
    }
    let publisher = Publisher { slot: Arc::clone(&slot), commands: receiver, next: blank() };
    (publisher, Feed { catalogue: Arc::new(catalogue), slot, commands: sender })
}

impl Publisher {
    /// Fills a frame and offers it. Never waits: where the page is just reading, or has not read the last one, a
    /// frame is dropped and counted. Takes no memory.
    pub fn publish(&mut self, fill: impl FnOnce(&mut Frame)) {
        fill(&mut self.next);
        let Ok(mut held) = self.slot.frame.try_lock() else {
            self.slot.dropped.fetch_add(1, Ordering::Relaxed);
            return;
        };
        std::mem::swap(&mut held.0, &mut self.next);
        if std::mem::replace(&mut held.1, true) {
            self.slot.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The next command, if one waits.
    pub fn command(&self) -> Option<Command> {
        self.commands.try_recv().ok()
    }
}

impl Feed {
    /// Copies the latest frame into `into`, if there is one that was not fetched yet.
    pub fn fetch(&self, into: &mut Frame) -> bool {
        let mut held = self.slot.frame.lock().unwrap_or_else(PoisonError::into_inner);
        if !std::mem::replace(&mut held.1, false) {
            return false;
        }
        into.clone_from(&held.0);
        true
    }

    /// Frames that were dropped on the way.
    pub fn dropped(&self) -> u64 {
        self.slot.dropped.load(Ordering::Relaxed)
    }

    /// Hands a command over. Returns false where too many wait or the plant is gone.
    pub fn command(&self, command: Command) -> bool {
        match self.commands.try_send(command) {
            Ok(()) => true,
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => false,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::serve) fn catalogue() -> Catalogue {
        Catalogue {
            title: String::new(),
            source: String::new(),
            plant: String::new(),
            network_id: String::new(),
            method: String::new(),
            pseudo_time: false,
            reference_pa: 0.0,
            control: true,
            scenarios: Vec::new(),
            values: vec![Value {
                id: "a.pressure".into(),
                unit: "Pa".into(),
                label: "",
                display: "gauge_pressure",
            }],
            inputs: Vec::new(),
            nodes: Vec::new(),
            lines: Vec::new(),
            channels: Vec::new(),
        }
    }

    #[test]
    fn the_latest_frame_counts_and_dropped_ones_are_counted() {
        let (mut publisher, feed) = feed(catalogue());
        let mut frame = Frame::default();
        assert!(!feed.fetch(&mut frame));
        for value in [1.0, 2.0, 3.0] {
            publisher.publish(|frame| frame.values[0] = value);
        }
        assert!(feed.fetch(&mut frame) && !feed.fetch(&mut frame.clone()));
        assert_eq!((frame.values[0].to_bits(), feed.dropped()), (3.0f32.to_bits(), 2));
    }

    #[test]
    fn a_page_that_reads_does_not_hold_the_plant() {
        let (mut publisher, feed) = feed(catalogue());
        let held = feed.slot.frame.lock().unwrap();
        publisher.publish(|frame| frame.values[0] = 1.0);
        assert_eq!(feed.dropped(), 1);
        drop(held);
    }

    #[test]
    fn commands_are_bounded() {
        let (publisher, feed) = feed(catalogue());
        let sent = (0..1_000).filter(|_| feed.command(Command::Pause { on: true })).count();
        assert_eq!(sent, COMMANDS);
        assert_eq!(std::iter::from_fn(|| publisher.command()).count(), COMMANDS);
        drop(publisher);
        assert!(!feed.command(Command::Pause { on: true }));
    }

    #[test]
    fn commands_are_read_strictly() {
        let read = |text: &str| serde_json::from_str::<Command>(text);
        assert_eq!(
            read(r#"{"do":"set","input":1,"value":0.5}"#).unwrap(),
            Command::Set { input: 1, value: 0.5 }
        );
        assert_eq!(
            read(r#"{"do":"break","input":0,"how":null}"#).unwrap(),
            Command::Break { input: 0, how: None }
        );
        for wrong in [
            "{}",
            r#"{"do":"fly"}"#,
            r#"{"do":"pause","on":1}"#,
            r#"{"do":"pause","on":true,"x":1}"#,
            "[]",
            "1",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
