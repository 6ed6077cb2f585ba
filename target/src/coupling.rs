//! What couples plant and hardware: the process image, the board's converters and the link.

use crate::board::{Board, Converters};
use crate::plant::Plant;
use eclss_core::mode::{Cause, Conduct, Machine, Outputs};
use eclss_core::process::{CHANNELS, CONVERTERS, Image, Order, Port, Process};
use eclss_core::protocol::{CommandFrame, Counters, Link, Outcome, Outgoing};
use heapless::Vec;

/// Most bytes of the link that are looked at in a tick: what comes faster waits outside, so that no flood delays a
/// tick.
pub const LINK_BYTES: usize = 256;
/// Part of its range by which no output may move while the plant settles \[1\].
const SETTLED: f32 = 2e-5;
/// For how long \[s\].
const SETTLED_S: f32 = 0.5;

static NO_CONVERTERS: Converters = [None; CONVERTERS];

/// What the link is like, for a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkReport {
    /// Whether there is a session.
    pub connected: bool,
    /// What became of each frame.
    pub counters: Counters,
    /// Packets sent in this session.
    pub sent: u32,
    /// Ticks since data came.
    pub silence: u32,
}

/// Process image and link of a running loop.
pub struct Coupling<'a> {
    process: Process<'a>,
    link: Option<Link>,
    step_s: f32,
    /// Whether inputs come over the link.
    link_brings: bool,
    /// Raw values of this tick, by input channel.
    raw: [Option<f32>; CHANNELS],
    /// Values from which the plant has not moved while it settles, by output channel, and for how long.
    rest: [f32; CHANNELS],
    rested: u32,
}

impl<'a> Coupling<'a> {
    /// Couples by `process`, whose ticks are `step_s` \[s\] long, and `link`, if there is one.
    pub fn new(process: Process<'a>, step_s: f32, link: Option<Link>) -> Self {
        let link_brings = process.image().inputs.iter().any(|channel| channel.port == Port::Link);
        let (raw, rest) = ([None; CHANNELS], [f32::NAN; CHANNELS]);
        Self { process, link, step_s, link_brings, raw, rest, rested: 0 }
    }

    /// Couples nothing.
    ///
    /// # Panics
    /// Never: an empty image needs no state.
    pub fn none() -> Self {
        let process = Process::new(Image::EMPTY, 0.0, &mut [], &mut []);
        Self::new(process.expect("no channel needs no state"), 0.0, None)
    }

    /// Whether hardware is bound to the plant.
    pub fn is_bound(&self) -> bool {
        self.process.image().is_bound()
    }

    /// When outputs are given out.
    pub fn order(&self) -> Order {
        self.process.image().order
    }

    /// The process image.
    pub fn process(&self) -> &Process<'a> {
        &self.process
    }

    /// The link.
    pub fn link(&self) -> Option<&Link> {
        self.link.as_ref()
    }

    /// What the link is like.
    pub fn link_report(&self) -> Option<LinkReport> {
        self.link.as_ref().map(|link| LinkReport {
            connected: link.is_connected(),
            counters: *link.counters(),
            sent: link.sent_packets(),
            silence: link.silence_ticks(),
        })
    }

    /// Reads converters and link; a bounded amount of work, whatever has come.
    pub fn read<B: Board>(&mut self, board: &mut B, now_us: u64) {
        let mut converters: Converters = [None; CONVERTERS];
        board.read_inputs(&mut converters);
        if !self.is_bound() {
            return;
        }
        let mut data = None;
        if let Some(link) = &mut self.link {
            let mut bytes = [0; LINK_BYTES];
            let came = board.read_link(&mut bytes).min(LINK_BYTES);
            link.feed(bytes.get(..came).unwrap_or(&[]), now_us);
            data = link.take_data();
        }
        let mut number = 0;
        for (raw, channel) in self.raw.iter_mut().zip(self.process.image().inputs) {
            *raw = match channel.port {
                Port::Analog(converter) => converters.get(usize::from(converter)).copied().flatten(),
                Port::Link => {
                    number += 1;
                    data.and_then(|data| data.value(number - 1))
                }
            };
        }
    }

    /// The command that waits to be done.
    pub fn take_command(&mut self) -> Option<CommandFrame> {
        self.link.as_mut()?.take_command()
    }

    /// Answers a command.
    pub fn acknowledge(&mut self, id: u32, outcome: Outcome) {
        if let Some(link) = &mut self.link {
            link.acknowledge(id, outcome);
        }
    }

    /// Judges what was read.
    pub fn ingest(&mut self, conduct: &Conduct) {
        self.process.ingest(&self.raw, conduct);
    }

    /// Whether every essential input is good and the link that brings some of them is up.
    pub fn inputs_good(&self) -> bool {
        let up = self.link.as_ref().is_some_and(Link::is_connected);
        self.process.inputs_good() && (up || !self.link_brings)
    }

    /// Whether every output has reached the plant's value.
    pub fn outputs_arrived(&self) -> bool {
        self.process.outputs_arrived()
    }

    /// What speaks against going on.
    pub fn trouble(&self) -> Option<Cause> {
        let ticks = self.link.as_ref().map_or(u32::MAX, Link::silence_ticks);
        if self.link_brings && ticks > self.process.image().safe_after_ticks {
            return Some(Cause::Silence { ticks });
        }
        self.process.lost_input().map(|channel| Cause::Input { channel })
    }

    /// Lets every input start from what the plant has.
    pub fn start_from<P: Plant>(&mut self, plant: &P) {
        self.process.start_from(|channel| plant.input(channel.slot).unwrap_or(channel.safe_value));
    }

    /// Hands the plant its inputs for the coming step.
    pub fn apply<P: Plant>(&self, plant: &mut P) {
        for (channel, (slot, applied)) in self.process.applied().enumerate() {
            plant.apply(channel, slot, applied);
        }
    }

    /// Makes outputs of the plant's points.
    pub fn emit<P: Plant>(&mut self, plant: &P, conduct: &Conduct) {
        self.process.emit(|point| plant.point(point), conduct);
    }

    /// Forgets how long the plant has stood still.
    pub fn unsettle(&mut self) {
        self.rested = 0;
        self.rest = [f32::NAN; CHANNELS];
    }

    /// Takes note of a tick of settling; returns whether every output has stood still for long enough.
    pub fn settle<P: Plant>(&mut self, plant: &P) -> bool {
        let outputs = self.process.image().outputs;
        let moved = |channel: &eclss_core::process::OutputChannel<'_>, rest: f32| {
            let way = (plant.point(channel.point) - rest).abs();
            // NaN, before the first tick, has moved.
            !matches!(
                way.partial_cmp(&((channel.max - channel.min) * SETTLED)),
                Some(core::cmp::Ordering::Less)
            )
        };
        self.rested = self.rested.saturating_add(1);
        if outputs.iter().zip(&self.rest).any(|(channel, rest)| moved(channel, *rest)) {
            self.rested = 0;
            for (rest, channel) in self.rest.iter_mut().zip(outputs) {
                *rest = plant.point(channel.point);
            }
        }
        self.rested as f32 * self.step_s >= SETTLED_S
    }

    /// Gives out what the latest [`Self::emit`] made.
    pub fn write<B: Board>(&mut self, board: &mut B, tick: u64, machine: &Machine, now_us: u64) {
        let mode = machine.mode();
        if !self.is_bound() {
            board.write_outputs(&NO_CONVERTERS, mode.is_armed());
            return;
        }
        let image = self.process.image();
        let mut converters: Converters = [None; CONVERTERS];
        let (mut values, mut quality) = (Vec::<f32, CHANNELS>::new(), Vec::<u8, CHANNELS>::new());
        for (channel, state) in image.outputs.iter().zip(self.process.outputs()) {
            let raw = state.raw(channel);
            match channel.port {
                Port::Analog(number) => {
                    if let Some(converter) = converters.get_mut(usize::from(number)) {
                        *converter = Some(raw);
                    }
                }
                Port::Link => {
                    // There is room for every channel of an image.
                    let _ = (values.push(raw), quality.push(state.quality() as u8));
                }
            }
        }
        if mode.conduct().outputs != Outputs::Reset {
            board.write_outputs(&converters, mode.is_armed());
        }
        let Some(link) = &mut self.link else { return };
        let mut seen = Vec::<u8, CHANNELS>::new();
        for (channel, state) in image.inputs.iter().zip(self.process.inputs()) {
            if channel.port == Port::Link {
                let _ = seen.push(state.quality() as u8);
            }
        }
        let cause = machine.cause().map_or(0, Cause::code);
        let outgoing = Outgoing { mode, cause, values: &values, quality: &quality, seen: &seen };
        link.send_tick(tick, now_us, &outgoing);
        let taken = board.write_link(link.outgoing());
        link.sent(taken);
    }
}

/// Numbers of values that go over a link each way.
pub fn link_counts(image: &Image<'_>) -> (u16, u16) {
    let inputs = image.inputs.iter().filter(|channel| channel.port == Port::Link).count();
    let outputs = image.outputs.iter().filter(|channel| channel.port == Port::Link).count();
    (inputs as u16, outputs as u16)
}
