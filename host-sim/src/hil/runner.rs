//! A run with hardware: one thread for the loop, this one for record, display and operator.

mod housekeeping;

use std::cell::RefCell;
use std::io::Write;
use std::num::NonZeroU32;
use std::path::PathBuf;
use std::pin::pin;
use std::task::{Context, Waker};
use std::time::Duration;

use eclss_core::Settings;
use eclss_core::mode::{Cause, Mode};
use eclss_core::process::{InputState, Order as OutputOrder, OutputState, Process};
use eclss_core::protocol::{Config, Estimate, Link as Session, Role};
use eclss_target::control::{self, Event};
use eclss_target::coupling::{Coupling, LinkReport, link_counts};
use eclss_target::plant::Plant as _;
use rtrb::{Consumer, Producer, RingBuffer};

use super::board::{Measured, Order, Pc, Stall, note};
use super::handover::{Giver, Layout, ring};
use super::pace::Pace;
use super::plant::HostPlant;
use super::realtime::{Wishes, become_real_time};
use super::recorder::{self, Recorder, Trigger};
use super::report::{FORMAT, LinkFigures, Machine, Overruns, RecordFigures, Report};
use super::tap::Tap;
use crate::refusal::refused;
use crate::trace::Column;
use crate::{Failure, HostBuffers, Source};
use eclss_target::wire::{Address, Link, LinkCounts, open};
use housekeeping::Housekeeping;

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
}

/// What the loop leaves behind.
struct Outcome {
    missing: Vec<String>,
    measured: Measured,
    state_hash: u64,
    plant_ticks: u64,
    dropped: u32,
    link: Option<LinkReport>,
    clock: Option<Estimate>,
    drift_ppb: Option<i64>,
    link_counts: Option<LinkCounts>,
    checkpoint: Vec<u8>,
    events_lost: u64,
}

/// The loop's ends of what leads to the other thread.
struct Ends {
    giver: Option<Giver>,
    events: Producer<Event>,
    orders: Consumer<Order>,
    link: Option<Link>,
}

/// Runs `job` on `source`; what happens meanwhile is written to `out`.
pub fn run(source: &Source, job: &Job, out: &mut dyn Write) -> Result<Report, Failure> {
    let loaded = &source.loaded;
    let bound = !loaded.process.inputs.is_empty() || !loaded.process.outputs.is_empty();
    if bound && job.link.is_some() && job.pace != Pace::Real {
        let text = "hardware is bound to this network: it runs in real time, or without --link";
        return Err(Failure::BadInput(text.into()));
    }
    let network = loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator =
        buffers.simulator(&network, job.settings).map_err(|error| refused(source, job.settings, &error))?;
    if let Some(bytes) = &job.start {
        let wrong = |error| Failure::BadInput(format!("the checkpoint to start from: {error}"));
        simulator.restore(bytes).map_err(wrong)?;
    }
    let mut start = vec![0; simulator.checkpoint_bytes()];
    simulator.save(&mut start).map_err(|error| Failure::Failed(format!("cannot save the start: {error}")))?;

    let columns = Column::all(&loaded.records);
    let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let layout = Layout { inputs: network.inputs.len(), figures: columns.len() };
    let epoch_ns = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |since| since.as_nanos() as u64);
    let toml = loaded.file.to_toml();
    let open_recorder = |wishes: &RecordWishes| {
        Recorder::new(&recorder::Order {
            folder: &wishes.folder,
            names: &names,
            every: wishes.every,
            triggers: &wishes.triggers,
            before: wishes.around.0,
            after: wishes.around.1,
            epoch_ns,
            network: &toml,
            start: &start,
        })
    };
    let recorder = job.record.as_ref().map(open_recorder).transpose()?;
    let rows = (ROOM_S * 1_000_000 / u64::from(job.settings.step_us).max(1)).clamp(1_024, MOST_ROWS);
    let (giver, taker) = if recorder.is_some() {
        let (giver, taker) = ring(layout, rows as usize);
        (Some(giver), Some(taker))
    } else {
        (None, None)
    };
    let (link, keeper) = job
        .link
        .as_ref()
        .map(open)
        .transpose()
        .map_err(|error| Failure::BadInput(error.to_string()))?
        .unzip();
    let (events, events_out) = RingBuffer::new(EVENTS);
    let (orders_in, orders) = RingBuffer::new(EVENTS);
    let mut housekeeping = Housekeeping::new(out, job, recorder, taker, events_out, orders_in);
    let ends = Ends { giver, events, orders, link };
    let started = std::time::Instant::now();
    let outcome = std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("loop".into()).spawn_scoped(scope, || {
            loaded.process.with_image(|image| {
                let mut states = (
                    vec![InputState::new(0.0); image.inputs.len()],
                    vec![OutputState::new(0.0); image.outputs.len()],
                );
                let step_s = job.settings.step_us as f32 * 1e-6;
                let process = Process::new(image, step_s, &mut states.0, &mut states.1)
                    .map_err(|error| Failure::Failed(format!("the process image: {error:?}")))?;
                let (inputs, outputs) = link_counts(&image);
                let config = Config {
                    role: Role::Plant,
                    network_id: simulator.network_id(),
                    process_id: image.id(),
                    step_us: job.settings.step_us,
                    inputs,
                    outputs,
                    ..Config::default()
                };
                let session = ends.link.is_some().then(|| Session::new(config, epoch_ns as u32 | 1));
                let coupling = Coupling::new(process, step_s, session);
                let tap = Tap::new(columns, layout.inputs, ends.giver);
                let plant = HostPlant::new(simulator, &tap);
                let latched = image.order == OutputOrder::Latched;
                let armable = (image.is_bound() && ends.link.is_some(), latched);
                let board = Pc::new(&tap, ends.link, ends.orders, armable, job.stall);
                in_thread(job, board, plant, coupling, &tap, ends.events)
            })
        });
        let thread = thread.map_err(|error| Failure::Failed(format!("cannot start the loop: {error}")))?;
        while !thread.is_finished() {
            housekeeping.turn();
            std::thread::sleep(Duration::from_millis(5));
        }
        housekeeping.turn();
        thread.join().unwrap_or_else(|_| Err(Failure::Failed("the loop panicked".into())))
    })?;
    drop(keeper);
    let wall_s = started.elapsed().as_secs_f64();
    if let Some(path) = &job.checkpoint {
        std::fs::write(path, &outcome.checkpoint).map_err(|error| Failure::file("write", path, &error))?;
    }
    let seen = housekeeping.end(&outcome, job.settings)?;
    Ok(report(source, job, &outcome, seen, wall_s))
}

/// Everything is allocated: from here to the end of the loop nothing is.
fn in_thread(
    job: &Job,
    mut board: Pc<'_>,
    mut plant: HostPlant<'_>,
    mut coupling: Coupling<'_>,
    tap: &RefCell<Tap>,
    mut events: Producer<Event>,
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
        plant_ticks: simulator.tick(),
        dropped: tap.borrow().dropped(),
        link: coupling.link_report(),
        clock: clock.and_then(eclss_core::protocol::Clock::estimate),
        drift_ppb: clock.and_then(eclss_core::protocol::Clock::drift_ppb),
        link_counts,
        measured,
        checkpoint,
        events_lost,
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
        status_every: NonZeroU32::new(per_second.get() / 10).unwrap_or(NonZeroU32::MIN),
    };
    let looped = pin!(control::run(board, plant, coupling, &settings, tell));
    // The board blocks where it waits, so that one poll runs to the end; it is pending once the end was ordered.
    let _ = looped.poll(&mut Context::from_waker(Waker::noop()));
}

/// What the other thread saw of the loop.
struct Seen {
    account: Option<eclss_target::account::Account>,
    mode: Mode,
    cause: Option<Cause>,
    record: Option<RecordFigures>,
}

fn report(source: &Source, job: &Job, outcome: &Outcome, seen: Seen, wall_s: f64) -> Report {
    let loaded = &source.loaded;
    let measured = &outcome.measured;
    let step_us = job.settings.step_us;
    let step_s = f64::from(step_us) * 1e-6;
    let tick = measured.tick.summary();
    let account = seen.account;
    let link = job.link.as_ref().zip(outcome.link).map(|(address, link)| {
        let bytes = outcome.link_counts.unwrap_or_default();
        LinkFigures {
            round_trip_us: outcome.clock.map(|clock| clock.round_trip_us),
            peer_offset_us: outcome.clock.map(|clock| clock.offset_us),
            peer_drift_ppm: outcome.drift_ppb.map(|ppb| ppb as f64 / 1e3),
            ..LinkFigures::new(address.to_string(), bytes, link.connected, &link.counters)
        }
    });
    Report {
        format: FORMAT,
        network: source.name.clone(),
        network_id: format!("{:016x}", loaded.network().id()),
        process_id: format!("{:016x}", loaded.process.id()),
        method: job.settings.method.name(),
        step_s,
        order: if loaded.process.order == OutputOrder::Latched { "latched" } else { "immediate" },
        machine: Machine::this(),
        missing: outcome.missing.clone(),
        target_hz: 1.0 / step_s,
        actual_hz: account.map_or(0.0, |account| f64::from(account.actual_millihertz()) / 1e3),
        ticks: tick.count,
        headroom: 1.0 - tick.max_us / f64::from(step_us),
        tick,
        wake_up: measured.wake.summary(),
        wake_up_histogram: measured.wake.buckets(),
        overruns: Overruns {
            total: account.map_or(0, |account| account.overruns),
            consecutive: account.map_or(0, |account| account.worst_consecutive_overruns),
            start_up: account.map_or(0, |account| account.startup_overruns),
        },
        missed_ticks: account.map_or(0, |account| account.skipped),
        loop_s: tick.count as f64 * step_s,
        plant_s: outcome.plant_ticks as f64 * step_s,
        wall_s,
        lag_s: account.map_or(0.0, |account| account.lag_us() as f64 * 1e-6),
        in_out: measured.in_out.summary(),
        link,
        mode: seen.mode.name(),
        cause: seen.cause.map(cause),
        state_hash: format!("{:016x}", outcome.state_hash),
        record: seen.record,
        events_lost: outcome.events_lost,
    }
}

/// Why it is SAFE, in words.
fn cause(cause: Cause) -> String {
    match cause {
        Cause::Reset => "the last run did not end well".into(),
        Cause::Overruns { in_a_row } => format!("{in_a_row} overruns in a row"),
        Cause::Lag { lag_us } => format!("{lag_us} µs behind the wall"),
        Cause::Plant(fault) => {
            format!("the plant cannot be trusted: {:?} in step {}", fault.place, fault.tick)
        }
        Cause::Silence { ticks } => format!("the link was silent for {ticks} ticks"),
        Cause::Input { channel } => format!("input channel {channel} was lost"),
        Cause::Operator => "the operator's stop".into(),
    }
}
