//! A board that runs the plant itself, with this computer as test bench, recorder and operator: the other end of its link.
//!
//! The bench answers every packet of the board with values for its inputs, which stand where the network has them until
//! somebody sets them, and are then reached no faster than their channels believe.

mod console;
mod desk;
mod report;

pub use report::{WatchReport, write_watch};

use std::io::Write;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use eclss_core::Settings;
use eclss_core::mode::{Mode, Request};
use eclss_core::protocol::{Command, Config, Link as Session, Role};
use eclss_target::coupling::{LinkReport, link_counts};
use eclss_target::wire::{Address, open};

use super::handover::{Head, Row};
use super::page::{self, Page};
use super::recorder::{self, Recorder};
use super::report::{LinkFigures, RecordFigures};
use super::runner::RecordWishes;
use crate::{Failure, Source};
use console::Console;
use desk::Desk;

/// How often the bench looks.
const LOOK: Duration = Duration::from_micros(200);
/// Ticks without data after which it speaks unasked.
const UNASKED_TICKS: u64 = 5;
/// Time between two frames of the page, and between two attempts to arm.
const FRAME: Duration = Duration::from_millis(50);
/// Time between two lines of the display.
const LINE: Duration = Duration::from_secs(1);

/// What is to be watched.
#[derive(Debug)]
pub struct Job {
    /// Method and step that the board runs.
    pub settings: Settings,
    /// Where it is.
    pub link: Address,
    /// How long it is watched; until somebody ends it when absent.
    pub duration: Option<Duration>,
    /// Whether its hardware is armed as soon as it can be.
    pub arm: bool,
    /// The record.
    pub record: Option<RecordWishes>,
    /// Where the page is served.
    pub page: Option<SocketAddr>,
    /// Lines of the operator.
    pub orders: Option<Receiver<String>>,
    /// Whether events are shown.
    pub shows: bool,
    /// Set when the run shall end.
    pub ends: Arc<AtomicBool>,
}

/// Watches a board and returns what was seen; what happens meanwhile is written to `out`.
pub fn watch(source: &Source, job: &Job, out: &mut dyn Write) -> Result<WatchReport, Failure> {
    let loaded = &source.loaded;
    if loaded.process.inputs.is_empty() && loaded.process.outputs.is_empty() {
        return Err(Failure::BadInput(format!(
            "{}: no channel of this network leads to hardware",
            source.name
        )));
    }
    let broken = |error: std::io::Error| Failure::BadInput(error.to_string());
    let (mut link, _keeper) = open(&job.link).map_err(broken)?;
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let epoch_ns = since.map_or(0, |since| since.as_nanos() as u64);
    let (inputs, outputs) = loaded.process.with_image(|image| link_counts(&image));
    let config = Config {
        role: Role::Controller,
        network_id: loaded.network().id(),
        process_id: loaded.process.id(),
        step_us: job.settings.step_us,
        inputs,
        outputs,
        ..Config::default()
    };
    let mut session = Session::new(config, epoch_ns as u32 | 1);
    let mut desk = Desk::new(loaded, job.settings.step_us);
    let mut console = Console::new(loaded, job.shows);
    let mut recorder = recorder(job, &desk.columns(), epoch_ns, &loaded.file.to_toml())?;
    let mut page = page(source, job, out)?;
    let begun = Instant::now();
    let (mut unasked, mut framed, mut lined) = (begun, begun, begun);
    let mut bytes = [0; 2_048];
    let mut row = Row { figures: vec![f32::NAN; desk.columns().len()], ..Row::default() };
    let mut tick = 0;
    while job.duration.is_none_or(|duration| begun.elapsed() < duration) && !job.ends.load(Ordering::Relaxed)
    {
        let now_us = begun.elapsed().as_micros() as u64;
        let mut asked = false;
        loop {
            let length = link.read(&mut bytes);
            if length == 0 {
                break;
            }
            for frame in bytes[..length].split_inclusive(|byte| *byte == 0) {
                session.feed(frame, now_us);
                if session.take_data().is_none() {
                    continue;
                }
                asked = true;
                let received = session.newest();
                if let Some((from, text)) = desk.take(received) {
                    console.say(out, &format!("{from} → {text}"));
                    event(&mut recorder, now_us, received.tick, &text)?;
                }
                let head = Head {
                    tick: received.tick,
                    plant_tick: received.tick,
                    begun_us: now_us,
                    skipped: desk.missing(),
                    mode: received.data.mode as u8,
                    ..Head::default()
                };
                row.head = head;
                desk.figures(&mut row.figures);
                if let Some(recorder) = &mut recorder {
                    recorder.row(&row)?;
                }
            }
        }
        console.acknowledged(out, &mut session);
        if let Some(orders) = &job.orders
            && console.orders(out, orders, &mut desk)
        {
            break;
        }
        let now = Instant::now();
        if asked || now >= unasked {
            unasked = now + Duration::from_micros(UNASKED_TICKS * u64::from(job.settings.step_us));
            console.command(&mut session);
            tick += 1;
            desk.send(&mut session, tick, now_us);
        }
        let taken = link.write(session.outgoing());
        session.sent(taken);
        if now >= framed {
            framed = now + FRAME;
            if job.arm && desk.mode() == Mode::Ready && !session.is_commanding() {
                session.command(Command::Mode(Request::Arm));
            }
            if let Some((page, places)) = &mut page {
                let report = report_of(&session);
                let round_trip = session.clock().estimate().map(|clock| clock.round_trip_us);
                page.publish(|frame| desk.show(frame, places, page::wire(&report, round_trip)));
            }
        }
        if now >= lined {
            lined = now + LINE;
            console.line(out, &desk, &session);
        }
        std::thread::sleep(LOOK);
    }
    let wall_s = begun.elapsed().as_secs_f64();
    let record = recorder.map(|recorder| finish(recorder, &desk)).transpose()?;
    let clock = session.clock();
    let figures = LinkFigures {
        round_trip_us: clock.estimate().map(|clock| clock.round_trip_us),
        peer_offset_us: clock.estimate().map(|clock| clock.offset_us),
        peer_drift_ppm: clock.drift_ppb().map(|ppb| ppb as f64 / 1e3),
        ..LinkFigures::new(job.link.to_string(), link.counts(), session.is_connected(), session.counters())
    };
    Ok(desk.report(source, wall_s, figures, session.refused(), record))
}

fn report_of(session: &Session) -> LinkReport {
    LinkReport {
        connected: session.is_connected(),
        counters: *session.counters(),
        sent: session.sent_packets(),
        silence: session.silence_ticks(),
    }
}

fn recorder(job: &Job, names: &[String], epoch_ns: u64, network: &str) -> Result<Option<Recorder>, Failure> {
    let open = |wishes: &RecordWishes| {
        Recorder::new(&recorder::Order {
            folder: &wishes.folder,
            names,
            every: wishes.every,
            triggers: &wishes.triggers,
            before: wishes.around.0,
            after: wishes.around.1,
            epoch_ns,
            network,
            start: &[],
        })
    };
    job.record.as_ref().map(open).transpose()
}

/// The page, and where its values stand at the desk.
fn page(
    source: &Source,
    job: &Job,
    out: &mut dyn Write,
) -> Result<Option<(Page, Vec<Option<usize>>)>, Failure> {
    let Some(address) = job.page else { return Ok(None) };
    let catalogue = page::catalogue(source, job.settings, "a board, watched")?;
    let places = desk::places(&source.loaded, &catalogue.values);
    let page = Page::new(source, catalogue, job.settings, address)?;
    if job.shows {
        let _ = writeln!(out, "page http://{}/", page.address());
    }
    Ok(Some((page, places)))
}

fn event(recorder: &mut Option<Recorder>, now_us: u64, tick: u64, text: &str) -> Result<(), Failure> {
    recorder.as_mut().map_or(Ok(()), |recorder| recorder.event(now_us, tick, text))
}

fn finish(recorder: Recorder, desk: &Desk) -> Result<RecordFigures, Failure> {
    let (rows, captures) = (recorder.taken(), recorder.captures());
    let run =
        [("watched".to_owned(), "a board".to_owned()), ("mode".to_owned(), desk.mode().name().to_owned())];
    let files = recorder.finish(run.into(), 0)?;
    let files = files.iter().map(|file| file.display().to_string()).collect();
    Ok(RecordFigures { files, rows, dropped: 0, captures })
}
