//! A run with hardware: one thread for the loop, this one for record, display and operator.

mod housekeeping;
mod summary;
mod wiring;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Write;
use std::net::SocketAddr;
use std::num::NonZeroU32;
use std::path::PathBuf;
use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Waker};
use std::time::Duration;

use eclss_core::process::{InputState, Order as OutputOrder, OutputState, Process};
use eclss_core::protocol::{Drift, Estimate, Key, Link as Session, Role};
use eclss_core::{Excursion, Health, Place, Settings, Signal, Simulator};
use eclss_network_file::NamedSignal;
use eclss_target::control::{self, Event};
use eclss_target::coupling::{Coupling, LinkReport};
use eclss_target::plant::Plant as _;
use rtrb::{Consumer, Producer, RingBuffer};

use super::board::{Measured, Order, Pc, Stall, note};
use super::force::Channels;
use super::handover::{Giver, Layout, ring};
use super::key::{check_reach, fresh_nonce};
use super::loopback::{LoopbackFigures, Probe};
use super::pace::Pace;
use super::plant::HostPlant;
use super::realtime::{Wishes, become_real_time};
use super::recorder::Trigger;
use super::report::{ChannelFigures, Report};
use super::shot::Camera;
use super::tap::Tap;
use crate::output::write_whole;
use crate::refusal::refused;
use crate::trace::columns;
use crate::{Failure, HostBuffers, Source};
use eclss_target::wire::{Address, Link, LinkCounts, open};
use housekeeping::Housekeeping;
use summary::{Seen, cause, channels, report};
pub(super) use wiring::open_recorder;
use wiring::{channel_names, config, open_page, open_tester, with_image};

/// Time of rows for which there is room between loop and recorder [s].
const ROOM_S: u64 = 4;
/// Most words of that room.
const MOST_ROWS: u64 = 65_536;
/// Room for events and orders.
const EVENTS: usize = 1_024;
/// Overruns in a row, and lag, after which the loop goes to SAFE.
const OVERRUNS_TO_SAFE: u32 = 5;
/// See [`OVERRUNS_TO_SAFE`].
const LAG_TO_SAFE_US: u64 = 1_000_000;

/// What is to be recorded.
#[derive(Debug, Clone)]
pub struct RecordWishes {
    /// Folder of the files.
    pub folder: PathBuf,
    /// Ticks in a row of the record.
    pub every: u64,
    /// What starts a capture.
    pub triggers: Vec<Trigger>,
    /// Ticks before and after a trigger that are captured.
    pub around: (usize, u64),
}

/// What is to be run.
#[derive(Debug, Clone)]
#[allow(clippy::struct_excessive_bools, reason = "switches of a command line")]
pub struct Job {
    /// Method and step; a tick is a step.
    pub settings: Settings,
    /// Where hardware is.
    pub link: Option<Address>,
    /// The key of those who may command over it; anybody when absent.
    pub key: Option<Key>,
    /// Ticks after which the run ends; until somebody ends it when absent.
    pub ticks: Option<u64>,
    /// Pace at the start.
    pub pace: Pace,
    /// The core of the loop.
    pub core: Option<usize>,
    /// Whether hardware is armed as soon as it can be.
    pub arm: bool,
    /// The record.
    pub record: Option<RecordWishes>,
    /// State to start from.
    pub start: Option<Vec<u8>>,
    /// Whether that state is taken as it is: INIT takes no step, and the plant stands in READY until it is armed.
    pub resume: bool,
    /// Where to leave the state at the end.
    pub checkpoint: Option<PathBuf>,
    /// A tick that is made too long.
    pub stall: Option<Stall>,
    /// Whether orders are taken from the standard input.
    pub operator: bool,
    /// Whether events are shown.
    pub shows: bool,
    /// Whether an interrupt ends the run in good order.
    pub interrupts: bool,
    /// Whether and where a tester measures the delay by loopback.
    pub loopback: Option<Loopback>,
    /// Where the page is served.
    pub page: Option<SocketAddr>,
}

/// Where the tester of a loopback is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Loopback {
    /// At the other end of a socket within this program.
    Inside,
    /// At this address, whose wire leads to that of the link.
    Over(Address),
}

/// What the loop leaves behind.
struct Outcome {
    missing: Vec<String>,
    measured: Measured,
    state_hash: u64,
    /// Where the plant left its range and what did, if it stands there at the end.
    strayed: Option<(Place, Excursion)>,
    plant_ticks: u64,
    dropped: u32,
    link: Option<LinkReport>,
    clock: Option<Estimate>,
    drift: Option<Drift>,
    link_counts: Option<LinkCounts>,
    checkpoint: Vec<u8>,
    events_lost: u64,
    process_id: u64,
    channels: Vec<ChannelFigures>,
    loopback: Option<LoopbackFigures>,
}

/// The loop's ends of what leads to the other thread.
struct Ends {
    giver: Option<Giver>,
    events: Producer<Event>,
    orders: Consumer<Order>,
    link: Option<Link>,
    camera: Option<Camera>,
    /// What is recorded of a tick, and how many inputs there are.
    signals: Vec<Signal>,
    slots: usize,
    /// This run's number for its session.
    nonce: u32,
}

/// Runs `job` on `source`; what happens meanwhile is written to `out`.
pub fn run(source: &Source, job: &Job, out: &mut dyn Write) -> Result<Report, Failure> {
    let loaded = &source.loaded;
    let bound = !loaded.process.inputs.is_empty() || !loaded.process.outputs.is_empty();
    if bound && (job.link.is_some() || job.loopback.is_some()) && job.pace != Pace::Real {
        let text = "hardware is bound to this network: it runs in real time, or without --link";
        return Err(Failure::BadInput(text.into()));
    }
    job.link.as_ref().map_or(Ok(()), |link| check_reach(link, job.key.as_ref()))?;
    let network = loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator =
        buffers.simulator(&network, job.settings).map_err(|error| refused(source, job.settings, &error))?;
    if let Some(bytes) = &job.start {
        let wrong = |error| Failure::BadInput(format!("the checkpoint to start from: {error}"));
        simulator.restore(bytes).map_err(wrong)?;
    }
    let probe = job.loopback.as_ref().map(|_| Probe::new(&loaded.process, simulator.inputs())).transpose();
    let probe = probe.map_err(|why| Failure::BadInput(format!("--loopback: {why}")))?;
    let mut start = vec![0; simulator.checkpoint_bytes()];
    simulator.save(&mut start).map_err(|error| Failure::Failed(format!("cannot save the start: {error}")))?;

    let columns = columns(loaded);
    let names: Vec<String> = columns.iter().map(NamedSignal::column).collect();
    let signals: Vec<Signal> = columns.iter().map(|column| column.signal).collect();
    let layout = Layout { inputs: network.inputs.len(), figures: columns.len() };
    let epoch_ns = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |since| since.as_nanos() as u64);
    let toml = loaded.file.to_toml();
    let rows = (ROOM_S * 1_000_000 / u64::from(job.settings.step_us).max(1)).clamp(1_024, MOST_ROWS);
    let broken = |error: std::io::Error| Failure::BadInput(error.to_string());
    let (link, keeper) = job.link.as_ref().map(open).transpose().map_err(broken)?.unzip();
    let (events, events_out) = RingBuffer::new(EVENTS);
    let (orders_in, orders) = RingBuffer::new(EVENTS);
    let (link, tester) = open_tester(job.loopback.as_ref(), link).map_err(broken)?;
    let (page, camera) = open_page(source, job, out)?;
    // Last, so that no empty record is left behind by a run that was refused.
    let recorder = open_recorder(job.record.as_ref(), &names, epoch_ns, &toml, &start, &told(job.settings))?;
    let (giver, taker) = recorder.as_ref().map(|_| ring(layout, rows as usize)).unzip();
    let mut housekeeping = Housekeeping::new(
        out,
        job,
        Channels::new(&loaded.process),
        recorder,
        taker,
        events_out,
        orders_in,
        page,
    );
    let slots = layout.inputs;
    let ends = Ends { giver, events, orders, link, camera, signals, slots, nonce: fresh_nonce() };
    let tested = AtomicBool::new(false);
    let started = std::time::Instant::now();
    let outcome = std::thread::scope(|scope| -> Result<Outcome, Failure> {
        let thread = std::thread::Builder::new()
            .name("loop".into())
            .spawn_scoped(scope, || loop_thread(source, job, probe.as_ref(), simulator, ends));
        let thread = thread.map_err(|error| Failure::Failed(format!("cannot start the loop: {error}")))?;
        let tester = tester.zip(probe.as_ref()).map(|((link, keeper), probe)| {
            let config = with_image(source, Some(probe), |image| {
                config(&image, network.id(), job.settings.step_us, Role::Controller)
            });
            let (probe, tested) = (probe.clone(), &tested);
            scope.spawn(move || {
                let figures = probe.test(link, config, job.key, tested);
                drop(keeper);
                figures
            })
        });
        while !thread.is_finished() {
            housekeeping.turn();
            std::thread::sleep(Duration::from_millis(5));
        }
        housekeeping.turn();
        tested.store(true, Ordering::Release);
        let loopback = tester.map(std::thread::ScopedJoinHandle::join).transpose();
        let outcome = thread.join().unwrap_or_else(|_| Err(Failure::Failed("the loop panicked".into())))?;
        let loopback = loopback.map_err(|_| Failure::Failed("the tester panicked".into()))?;
        Ok(Outcome { loopback, ..outcome })
    })?;
    drop(keeper);
    let wall_s = started.elapsed().as_secs_f64();
    if let Some(path) = &job.checkpoint {
        write_whole(path, &outcome.checkpoint)?;
    }
    let seen = housekeeping.end(&outcome, job.settings)?;
    Ok(report(source, job, &outcome, seen, wall_s))
}

/// Data of the run that a record states from its beginning.
fn told(settings: Settings) -> BTreeMap<String, String> {
    BTreeMap::from([
        ("method".to_owned(), settings.method.name().to_owned()),
        ("step_us".to_owned(), settings.step_us.to_string()),
    ])
}

/// Builds the loop in its own thread and runs it.
fn loop_thread(
    source: &Source,
    job: &Job,
    probe: Option<&Probe>,
    simulator: Simulator<'_>,
    ends: Ends,
) -> Result<Outcome, Failure> {
    with_image(source, probe, |image| {
        let mut states = (
            vec![InputState::new(0.0); image.inputs.len()],
            vec![OutputState::new(0.0); image.outputs.len()],
        );
        let step_s = job.settings.step_us as f32 * 1e-6;
        let process = Process::new(image, step_s, &mut states.0, &mut states.1)
            .map_err(|error| Failure::Failed(format!("the process image: {error:?}")))?;
        let config = config(&image, simulator.network_id(), job.settings.step_us, Role::Plant);
        let session = ends.link.is_some().then(|| Session::new(config, ends.nonce).with_key(job.key));
        let coupling = Coupling::new(process, step_s, session);
        let tap = Tap::new(ends.signals, ends.slots, ends.giver, ends.camera);
        let plant = HostPlant::new(simulator, &tap);
        let latched = image.order == OutputOrder::Latched;
        let armable = (image.is_bound() && ends.link.is_some(), latched);
        let board = Pc::new(&tap, ends.link, ends.orders, armable, job.stall);
        in_thread(job, board, plant, coupling, &tap, ends.events, &channel_names(source, probe))
    })
}

/// Everything is allocated: from here to the end of the loop nothing is.
fn in_thread(
    job: &Job,
    mut board: Pc<'_>,
    mut plant: HostPlant<'_>,
    mut coupling: Coupling<'_>,
    tap: &RefCell<Tap>,
    mut events: Producer<Event>,
    names: &[String],
) -> Result<Outcome, Failure> {
    let missing = become_real_time(Wishes { core: job.core });
    board.start_at(job.pace).map_err(|why| Failure::BadInput(why.into()))?;
    let mut events_lost = 0;
    drive(&mut board, &mut plant, &mut coupling, job, |event| {
        note(tap, &event);
        events_lost += u64::from(events.push(event).is_err());
    });
    let link_counts = board.link_counts();
    let measured = board.measured().clone();
    let simulator = plant.simulator();
    let mut checkpoint = vec![0; simulator.checkpoint_bytes()];
    simulator
        .save(&mut checkpoint)
        .map_err(|error| Failure::Failed(format!("cannot save the end: {error}")))?;
    let clock = coupling.link().map(Session::clock);
    Ok(Outcome {
        missing: missing.iter().map(ToString::to_string).collect(),
        state_hash: plant.state_hash(),
        strayed: match simulator.health() {
            Health::Trusted => None,
            Health::Faulted(fault) => simulator.excursion().map(|what| (fault.place, what)),
        },
        plant_ticks: simulator.tick(),
        dropped: tap.borrow().dropped(),
        link: coupling.link_report(),
        clock: clock.and_then(eclss_core::protocol::Clock::estimate),
        drift: clock.and_then(eclss_core::protocol::Clock::drift),
        link_counts,
        measured,
        checkpoint,
        events_lost,
        process_id: coupling.process().image().id(),
        channels: channels(names, coupling.process()),
        loopback: None,
    })
}

/// Runs the loop in this thread until it ends or is ordered to. Neither allocates, locks nor prints.
pub fn drive(
    board: &mut Pc<'_>,
    plant: &mut HostPlant<'_>,
    coupling: &mut Coupling<'_>,
    job: &Job,
    tell: impl FnMut(Event),
) {
    let period_us = NonZeroU32::new(job.settings.step_us).unwrap_or(NonZeroU32::MIN);
    let per_second = NonZeroU32::new(1_000_000 / period_us).unwrap_or(NonZeroU32::MIN);
    let settings = control::Settings {
        period_us,
        ticks: job.ticks,
        startup_ticks: per_second.get(),
        overruns_to_safe: OVERRUNS_TO_SAFE,
        lag_to_safe_us: LAG_TO_SAFE_US,
        start_safe: false,
        settled: job.resume,
        status_every: NonZeroU32::new(per_second.get() / 10).unwrap_or(NonZeroU32::MIN),
    };
    let looped = pin!(control::run(board, plant, coupling, &settings, tell));
    // The board blocks where it waits, so that one poll runs to the end; it is pending once the end was ordered.
    let _ = looped.poll(&mut Context::from_waker(Waker::noop()));
}
