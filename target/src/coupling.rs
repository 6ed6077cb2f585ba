//! What couples plant and hardware: the process image, the board's converters and the link.

use crate::board::{Board, Converters, Forcing};
use crate::plant::Plant;
use eclss_core::mode::{Cause, Conduct, Machine, Outputs};
use eclss_core::process::{CHANNELS, CONVERTERS, Image, Order, Port, Process, Rest};
use eclss_core::protocol::{CommandFrame, Counters, Link, Outcome, Outgoing};
use heapless::Vec;

/// Bytes of the link that are taken at once.
const CHUNK: usize = 256;

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
    /// Ticks since data came over the link, as seen when this tick had read it: the same in either [`Order`].
    silence: u32,
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
        Self { process, link, step_s, link_brings, silence: u32::MAX, raw, rest, rested: 0 }
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
            silence: self.silence,
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
            read_link(board, link, now_us);
            self.silence = link.silence_ticks();
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

    /// Puts something in a channel's place; false where the channel cannot carry it.
    pub fn force(&mut self, Forcing { direction, channel, force }: Forcing) -> bool {
        self.process.force(direction, channel, force)
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
        let ticks = self.silence;
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

    /// Makes outputs of the plant's signals.
    pub fn emit<P: Plant>(&mut self, plant: &P, conduct: &Conduct) {
        self.process.emit(|signal| plant.signal(signal), conduct);
    }

    /// Forgets how long the plant has stood still.
    pub fn unsettle(&mut self) {
        self.rested = 0;
        self.rest = [f32::NAN; CHANNELS];
    }

    /// Takes note of a tick of settling; returns whether every output has stood still for long enough.
    pub fn settle<P: Plant>(&mut self, plant: &P) -> bool {
        let Image { outputs, rest: Rest { part, time_s }, .. } = self.process.image();
        let moved = |channel: &eclss_core::process::OutputChannel<'_>, rest: f32| {
            let way = (plant.signal(channel.signal) - rest).abs();
            // NaN, before the first tick, has moved.
            !matches!(way.partial_cmp(&((channel.max - channel.min) * part)), Some(core::cmp::Ordering::Less))
        };
        self.rested = self.rested.saturating_add(1);
        if outputs.iter().zip(&self.rest).any(|(channel, rest)| moved(channel, *rest)) {
            self.rested = 0;
            for (rest, channel) in self.rest.iter_mut().zip(outputs) {
                *rest = plant.signal(channel.signal);
            }
        }
        self.rested as f32 * self.step_s >= time_s
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

/// Hands the link what has come for it, at most [`Board::LINK_BYTES`] or what it needs to keep step with its peer, so that
/// no flood delays a tick. Where more waits, the newest is what counts.
pub(crate) fn read_link<B: Board>(board: &mut B, link: &mut Link, now_us: u64) {
    let mut bytes = [0; CHUNK];
    let mut left = link.bytes_a_tick().max(B::LINK_BYTES);
    board.skip_link(left);
    while left > 0 {
        let Some(place) = bytes.get_mut(..left.min(CHUNK)) else { return };
        let came = board.read_link(place).min(place.len());
        link.feed(place.get(..came).unwrap_or(&[]), now_us);
        if came < place.len() {
            return;
        }
        left -= came;
    }
}

/// Numbers of values that go over a link each way.
pub fn link_counts(image: &Image<'_>) -> (u16, u16) {
    let inputs = image.inputs.iter().filter(|channel| channel.port == Port::Link).count();
    let outputs = image.outputs.iter().filter(|channel| channel.port == Port::Link).count();
    (inputs as u16, outputs as u16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::mode::Mode;
    use eclss_core::process::{Hold, InputChannel, InputState, Scaling};
    use eclss_core::protocol::{Config, Role};
    use std::vec::Vec;

    const CHANNEL: InputChannel<'_> = InputChannel {
        slot: 0,
        port: Port::Link,
        scaling: Scaling::NONE,
        min: 0.0,
        max: 1e6,
        saturates: false,
        max_rate_per_s: f32::INFINITY,
        filter_s: 0.0,
        hold: Hold::Zero,
        extrapolate_ticks: 1,
        event_step: 1.0,
        stale_ticks: 100,
        safe_value: 0.5,
        safe_rate_per_s: 1.0,
        essential: true,
    };

    /// A wire to a controller, and nothing else.
    struct Wire {
        controller: Link,
        to_plant: Vec<u8>,
    }

    impl Board for Wire {
        const COUNTER_HZ: u32 = 1;
        fn name(&self) -> &'static str {
            "wire"
        }
        fn counter(&self) -> u32 {
            0
        }
        fn read_inputs(&mut self, _converters: &mut Converters) {}
        fn write_outputs(&mut self, _converters: &Converters, _armed: bool) {}
        fn read_link(&mut self, bytes: &mut [u8]) -> usize {
            let length = bytes.len().min(self.to_plant.len());
            for (to, from) in bytes.iter_mut().zip(self.to_plant.drain(..length)) {
                *to = from;
            }
            length
        }
        fn write_link(&mut self, bytes: &[u8]) -> usize {
            self.controller.feed(bytes, 0);
            bytes.len()
        }
        fn safe_outputs(&mut self) {}
        fn feed_watchdog(&mut self) {}
    }

    impl Wire {
        /// The controller says so many values, all of them the tick.
        fn controller_says(&mut self, tick: u64, values: usize) {
            let values = vec![tick as f32; values];
            let quality = vec![0; values.len()];
            let says = Outgoing { values: &values, quality: &quality, seen: &quality, ..Outgoing::default() };
            self.controller.send_tick(tick, tick * 1_000, &says);
            self.to_plant.extend_from_slice(self.controller.outgoing());
            self.controller.sent(usize::MAX);
        }
    }

    /// Runs `body` with a coupling of `channels` inputs over a wire to its controller.
    fn coupled<T>(channels: usize, order: Order, body: impl FnOnce(&mut Coupling<'_>, &mut Wire) -> T) -> T {
        let config = Config { inputs: channels as u16, ..Config::default() };
        let inputs = vec![CHANNEL; channels];
        let mut states = vec![InputState::new(0.0); channels];
        let image = Image { inputs: &inputs, order, ..Image::EMPTY };
        let process = Process::new(image, 1e-3, &mut states, &mut []).unwrap();
        let mut coupling = Coupling::new(process, 1e-3, Some(Link::new(config, 3)));
        let controller = Link::new(Config { role: Role::Controller, ..config }, 4);
        body(&mut coupling, &mut Wire { controller, to_plant: Vec::new() })
    }

    fn tick(coupling: &mut Coupling<'_>, wire: &mut Wire, tick: u64) -> Option<Cause> {
        let machine = Machine::new();
        let now_us = 1_000 * tick;
        coupling.read(wire, now_us);
        if coupling.order() == Order::Latched {
            coupling.write(wire, tick, &machine, now_us);
        }
        coupling.ingest(Mode::Run.conduct());
        let trouble = coupling.trouble();
        if coupling.order() == Order::Immediate {
            coupling.write(wire, tick, &machine, now_us);
        }
        trouble
    }

    /// Silence is counted from when data were read, whenever in the tick outputs are given out.
    #[test]
    fn silence_is_the_same_in_either_order() {
        for order in [Order::Latched, Order::Immediate] {
            let silent = coupled(1, order, |coupling, wire| {
                for now in 0..100 {
                    wire.controller_says(now, 1);
                    tick(coupling, wire, now);
                }
                assert_eq!(coupling.link_report().unwrap().silence, 0);
                (100..1_000).take_while(|now| tick(coupling, wire, *now).is_none()).count() as u32
            });
            assert_eq!(silent, Image::EMPTY.safe_after_ticks, "{order:?}");
        }
    }

    /// The largest image that a link carries: the plant keeps step with its controller and sees what it said last.
    #[test]
    fn no_image_is_too_large_to_keep_step_with() {
        coupled(CHANNELS, Order::Latched, |coupling, wire| {
            for now in 0..1_000 {
                wire.controller_says(now, CHANNELS);
                tick(coupling, wire, now);
                let behind = wire.to_plant.len();
                assert!(behind < 600, "{behind} bytes wait in tick {now}");
            }
            let newest = coupling.process().inputs()[CHANNELS - 1].live();
            assert!((newest - 999.0).abs() < 1.5, "the value of tick {newest}");
        });
    }
}
