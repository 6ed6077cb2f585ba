//! What a page shows of the loop: a few buffers that go back and forth, without locks and without taking memory.

use eclss_core::climate::monitor::Limit;
use eclss_core::mode::{Cause, Machine, Mode};
use eclss_core::process::{InputState, OutputState, Quality};
use eclss_core::protocol::Estimate;
use eclss_core::{Excursion, Health, Signal, Simulator};
use eclss_network_file::Loaded;
use eclss_target::account::Account;
use eclss_target::coupling::{Coupling, LinkReport};
use rtrb::{Consumer, Producer, RingBuffer};

use crate::Closure;

/// Buffers on their way.
const SHOTS: usize = 4;
/// Most times of ticks in one; of a faster loop the first ones since the last shot.
const TICKS: usize = 128;

/// Figures of one moment.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// Timing of the loop; none before its first tick.
    pub account: Option<Account>,
    /// Mode.
    pub mode: Mode,
    /// Why it is SAFE, where it is.
    pub cause: Option<Cause>,
    /// The link.
    pub link: Option<LinkReport>,
    /// The peer's clock.
    pub clock: Option<Estimate>,
    /// Steps of the plant.
    pub steps: u64,
    /// Its time [s].
    pub t_s: f64,
    /// Smallest φ of the last step and of all.
    pub phi: [f32; 2],
    /// What the mass ledger lacks over all mass [1].
    pub closure: f64,
    /// Whether the run may be trusted.
    pub health: Health,
    /// What left its range, if something did.
    pub excursion: Option<Excursion>,
    /// The first node of which something is doubtful, and what.
    pub warning: Option<(usize, Limit)>,
    /// Shots that found no buffer.
    pub dropped: u32,
}

/// One moment with its values.
#[derive(Debug)]
pub struct Shot {
    /// Figures.
    pub moment: Moment,
    /// Published values.
    pub values: Vec<f32>,
    /// What each channel is worth, inputs first.
    pub quality: Vec<Quality>,
    /// Values of each channel that were rejected since the start; of outputs those that were not finite.
    pub rejected: Vec<u32>,
    /// How long ticks took since the last shot [ns].
    pub tick_ns: Vec<u32>,
}

impl Shot {
    fn new(values: usize, channels: usize) -> Self {
        let moment = Moment {
            account: None,
            mode: Mode::PowerUp,
            cause: None,
            link: None,
            clock: None,
            steps: 0,
            t_s: 0.0,
            phi: [f32::NAN; 2],
            closure: f64::NAN,
            health: Health::Trusted,
            excursion: None,
            warning: None,
            dropped: 0,
        };
        Self {
            moment,
            values: vec![f32::NAN; values],
            quality: vec![Quality::Unknown; channels],
            rejected: vec![0; channels],
            tick_ns: Vec::with_capacity(TICKS),
        }
    }

    /// Takes the other's content over; both have the same lengths.
    fn copy(&mut self, other: &Self) {
        self.moment = other.moment;
        self.values.copy_from_slice(&other.values);
        self.quality.copy_from_slice(&other.quality);
        self.rejected.copy_from_slice(&other.rejected);
        self.tick_ns.clear();
        self.tick_ns.extend_from_slice(&other.tick_ns);
    }
}

/// The loop's end.
#[derive(Debug)]
pub struct Camera {
    signals: Vec<Signal>,
    ledger: Closure,
    now: Shot,
    every: u64,
    until: u64,
    free: Consumer<Shot>,
    taken: Producer<Shot>,
}

/// The page's end.
#[derive(Debug)]
pub struct Album {
    taken: Consumer<Shot>,
    free: Producer<Shot>,
}

/// Makes both ends for published `signals` and `channels`, with a shot every `every` ticks.
pub fn camera(loaded: &Loaded, signals: Vec<Signal>, channels: usize, every: u64) -> (Camera, Album) {
    let values = signals.len();
    let (mut free, free_out) = RingBuffer::new(SHOTS);
    let (taken, taken_out) = RingBuffer::new(SHOTS);
    for _ in 0..SHOTS {
        // There is room for just so many.
        let _ = free.push(Shot::new(values, channels));
    }
    let camera = Camera {
        signals,
        ledger: Closure::new(loaded),
        now: Shot::new(values, channels),
        every: every.max(1),
        until: 0,
        free: free_out,
        taken,
    };
    (camera, Album { taken: taken_out, free })
}

impl Camera {
    /// Reads the plant if a shot is due in this tick.
    pub fn read(&mut self, simulator: &Simulator<'_>) {
        if self.until > 0 {
            return;
        }
        simulator.read_signals(&self.signals, &mut self.now.values);
        let moment = &mut self.now.moment;
        (moment.steps, moment.t_s) = (simulator.tick(), simulator.time_us() as f64 * 1e-6);
        moment.phi = [simulator.margin().phi, simulator.worst_margin().phi];
        moment.closure = self.ledger.read(simulator);
        (moment.health, moment.excursion) = (simulator.health(), simulator.excursion());
        moment.warning = simulator.first_warning();
    }

    /// Takes note of how long a tick took.
    pub fn note(&mut self, tick_ns: u32) {
        if self.now.tick_ns.len() < TICKS {
            self.now.tick_ns.push(tick_ns);
        }
    }

    /// Ends a tick: hands a shot over where one is due.
    pub fn observe(&mut self, account: &Account, machine: &Machine, coupling: &Coupling<'_>) {
        let due = self.until == 0;
        self.until = if due { self.every } else { self.until } - 1;
        if !due {
            return;
        }
        let now = &mut self.now;
        now.moment.account = Some(*account);
        (now.moment.mode, now.moment.cause) = (machine.mode(), machine.cause());
        now.moment.link = coupling.link_report();
        now.moment.clock = coupling.link().and_then(|link| link.clock().estimate());
        let process = coupling.process();
        let inputs = process.inputs().iter().map(InputState::quality);
        let outputs = process.outputs().iter().map(OutputState::quality);
        for (place, quality) in now.quality.iter_mut().zip(inputs.chain(outputs)) {
            *place = quality;
        }
        let inputs = process.inputs().iter().map(|state| state.rejected().total());
        let outputs = process.outputs().iter().map(OutputState::not_finite);
        for (place, rejected) in now.rejected.iter_mut().zip(inputs.chain(outputs)) {
            *place = rejected;
        }
        if let Ok(mut shot) = self.free.pop() {
            shot.copy(now);
            // There are no more shots than room.
            let _ = self.taken.push(shot);
        } else {
            now.moment.dropped = now.moment.dropped.saturating_add(1);
        }
        now.tick_ns.clear();
    }
}

impl Album {
    /// Shows every shot that has been taken, oldest first.
    pub fn look(&mut self, mut show: impl FnMut(&Shot)) {
        while let Ok(shot) = self.taken.pop() {
            show(&shot);
            // It came out of there.
            let _ = self.free.push(shot);
        }
    }
}
