//! A plant from `networks/hil.toml` in the one loop, on a board whose clock and link are in memory, with a controller
//! at the other end of the link.

use core::num::NonZeroU32;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use eclss_core::mode::{Mode, Refusal, Request};
use eclss_core::process::{Image, InputState, OutputState, Process};
use eclss_core::protocol::{Command, Config, Link, Outcome, Outgoing, Role};
use eclss_core::{Buffers, Network, Simulator};
use eclss_network_file::{Loaded, parse};
use eclss_target::board::{Board, Converters};
use eclss_target::control::{self, Event, Settings};
use eclss_target::coupling::{Coupling, link_counts};
use eclss_target::network::{self, NetworkPlant};
use std::cell::Cell;
use std::rc::Rc;

pub(crate) const HIL: &str = include_str!("../../../networks/hil.toml");

/// What the loop told, where the peer can see it.
pub(crate) type Told = Rc<Cell<(u64, Mode)>>;

/// The other end of the link: called once a tick of the plant, with the tick's number.
pub(crate) trait Peer {
    fn tick(&mut self, tick: u64, bytes: &[u8]) -> Vec<u8>;
}

/// A board in memory.
pub(crate) struct Bench<P> {
    pub(crate) peer: P,
    clock_us: u64,
    tick: u64,
    to_peer: Vec<u8>,
    from_peer: Vec<u8>,
    /// What each tick takes from reading the link to the end of the step [µs], over and over.
    takes_us: &'static [u64],
}

impl<P: Peer> Board for Bench<P> {
    const COUNTER_HZ: u32 = 1_000_000;

    fn name(&self) -> &'static str {
        "bench"
    }
    fn now_us(&self) -> u64 {
        self.clock_us
    }
    async fn sleep_until(&mut self, at_us: u64) {
        self.clock_us = self.clock_us.max(at_us);
    }
    fn counter(&self) -> u32 {
        self.clock_us as u32
    }
    fn read_inputs(&mut self, _converters: &mut Converters) {
        let sent = std::mem::take(&mut self.to_peer);
        self.from_peer.extend(self.peer.tick(self.tick, &sent));
        self.tick += 1;
    }
    fn write_outputs(&mut self, _converters: &Converters, _armed: bool) {}
    fn read_link(&mut self, bytes: &mut [u8]) -> usize {
        let length = bytes.len().min(self.from_peer.len());
        for (to, from) in bytes.iter_mut().zip(self.from_peer.drain(..length)) {
            *to = from;
        }
        let takes = self.tick as usize % self.takes_us.len().max(1);
        self.clock_us += self.takes_us.get(takes).copied().unwrap_or(0);
        length
    }
    fn write_link(&mut self, bytes: &[u8]) -> usize {
        self.to_peer.extend_from_slice(bytes);
        bytes.len()
    }
    fn safe_outputs(&mut self) {}
    fn feed_watchdog(&mut self) {}
}

pub(crate) fn loaded() -> Loaded {
    parse(HIL, "hil.toml").expect("it ships")
}

pub(crate) fn plant(loaded: Loaded) -> NetworkPlant {
    let loaded: &'static Loaded = Box::leak(Box::new(loaded));
    let network: &'static Network<'static> = Box::leak(Box::new(loaded.network()));
    let settings = eclss_core::Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let sizes = settings.method.sizes(network);
    let zeros = |length| Box::leak(vec![0.0; length].into_boxed_slice());
    let buffers = Buffers {
        state: zeros(sizes.state),
        work: zeros(sizes.work),
        inputs: zeros(sizes.inputs),
        cursors: Box::leak(vec![0; sizes.cursors].into_boxed_slice()),
    };
    let simulator = Simulator::new(network, settings, buffers).expect("it was checked");
    network::loaded(simulator, "hil", &[])
}

/// Settings of the link that both ends share.
pub(crate) fn config_of(loaded: &Loaded, role: Role) -> Config {
    let (network_id, process_id) = (loaded.network().id(), loaded.process.id());
    let (inputs, outputs) = loaded.process.with_image(|image| link_counts(&image));
    Config { role, network_id, process_id, step_us: loaded.run.step_us, inputs, outputs, ..Config::default() }
}

/// Runs the loop for so many ticks against the peer; `told` takes tick and mode of what was told last.
pub(crate) fn run<P: Peer>(peer: P, ticks: u64, told: &Told) -> (P, Vec<Event>) {
    run_from(peer, ticks, told, false)
}

/// The same after a start that was a clean one or not.
pub(crate) fn run_from<P: Peer>(peer: P, ticks: u64, told: &Told, start_safe: bool) -> (P, Vec<Event>) {
    run_on(&loaded(), peer, ticks, told, start_safe, &[])
}

/// The same on another network, with ticks that take some time.
pub(crate) fn run_on<P: Peer>(
    loaded: &Loaded,
    peer: P,
    ticks: u64,
    told: &Told,
    start_safe: bool,
    takes_us: &'static [u64],
) -> (P, Vec<Event>) {
    let (inputs, outputs) = (loaded.process.input_channels(), loaded.process.output_channels());
    let image = Image {
        inputs: &inputs,
        outputs: &outputs,
        order: loaded.process.order,
        safe_after_ticks: loaded.process.safe_after_ticks,
        rest: loaded.process.rest,
    };
    let mut input_states = vec![InputState::new(0.0); inputs.len()];
    let mut output_states = vec![OutputState::new(0.0); outputs.len()];
    let process = Process::new(image, 1e-3, &mut input_states, &mut output_states).expect("as many states");
    let mut coupling = Coupling::new(process, 1e-3, Some(Link::new(config_of(loaded, Role::Plant), 11)));
    let mut plant = plant(loaded.clone());
    let mut bench =
        Bench { peer, clock_us: 0, tick: 0, to_peer: Vec::new(), from_peer: Vec::new(), takes_us };
    let settings = Settings {
        period_us: NonZeroU32::new(1_000).unwrap(),
        ticks: Some(ticks),
        startup_ticks: 0,
        overruns_to_safe: 3,
        lag_to_safe_us: 1_000_000,
        start_safe,
        settled: false,
        status_every: NonZeroU32::new(1_000_000).unwrap(),
    };
    let mut events = Vec::new();
    {
        let tell = |event| {
            match event {
                Event::Mode { tick, to, .. } => told.set((tick, to)),
                Event::Safe { tick, .. } => told.set((tick, Mode::Safe)),
                _ => {}
            }
            events.push(event);
        };
        let looped = pin!(control::run(&mut bench, &mut plant, &mut coupling, &settings, tell));
        assert_eq!(looped.poll(&mut Context::from_waker(Waker::noop())), Poll::Ready(()));
    }
    (bench.peer, events)
}

/// A controller that sends fixed values and arms the plant as soon as it can.
pub(crate) struct Operator {
    pub(crate) link: Link,
    pub(crate) values: Vec<f32>,
    /// Whether the wire is cut, both ways.
    pub(crate) cut: bool,
    /// Whether it may acknowledge and arm.
    pub(crate) willing: bool,
    /// Mode and outputs that the plant reported last.
    pub(crate) mode: Mode,
    pub(crate) outputs: Vec<f32>,
    pub(crate) refused: usize,
    /// Whether the plant has to be restarted.
    restart: bool,
}

impl Operator {
    pub(crate) fn new(values: &[f32]) -> Self {
        Self::of(&loaded(), values)
    }

    /// The same for another network.
    pub(crate) fn of(loaded: &Loaded, values: &[f32]) -> Self {
        Self {
            link: Link::new(config_of(loaded, Role::Controller), 22),
            values: values.to_vec(),
            cut: false,
            willing: true,
            mode: Mode::PowerUp,
            outputs: Vec::new(),
            refused: 0,
            restart: false,
        }
    }

    /// One tick of an end that may be cut off.
    pub(crate) fn exchange(&mut self, tick: u64, bytes: &[u8]) -> Vec<u8> {
        if !self.cut {
            self.link.feed(bytes, tick * 1_000);
        }
        if let Some(data) = self.link.take_data() {
            self.mode = data.mode;
            self.outputs = data.values.to_vec();
        }
        if let Some(ack) = self.link.take_ack() {
            self.refused += usize::from(matches!(ack.outcome, Outcome::Refused(_)));
            self.restart = ack.outcome == Outcome::Refused(Refusal::Plant);
        }
        let request = match self.mode {
            Mode::Ready => Some(Request::Arm),
            Mode::Safe if self.restart => Some(Request::Restart),
            Mode::Safe => Some(Request::Acknowledge),
            _ => None,
        };
        if let Some(request) = request.filter(|_| self.willing && !self.cut && !self.link.is_commanding()) {
            self.link.command(Command::Mode(request));
        }
        let outgoing = Outgoing { mode: Mode::Run, values: &self.values, ..Outgoing::default() };
        self.link.send_tick(tick, tick * 1_000, &outgoing);
        let bytes = self.link.outgoing().to_vec();
        self.link.sent(bytes.len());
        if self.cut { Vec::new() } else { bytes }
    }
}
