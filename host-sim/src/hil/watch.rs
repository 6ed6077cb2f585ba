//! A board that runs the plant itself, with this computer as test bench, recorder and operator: the other end of its link.
//!
//! The bench answers every packet of the board with values for its inputs, which stand where the network has them until
//! somebody sets them, and are then reached no faster than their channels believe.

mod console;
mod desk;
mod report;

pub use report::{WatchReport, write_watch};

use std::collections::BTreeMap;
use std::io::Write;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use eclss_core::Settings;
use eclss_core::mode::Request;
use eclss_core::protocol::{Command, Config, Key, Link as Session, Role};
use eclss_target::coupling::{LinkReport, link_counts};
use eclss_target::wire::{Address, Link, open};

use super::arming::Arming;
use super::handover::{Head, Row};
use super::key::fresh_nonce;
use super::page::{self, Page};
use super::recorder::Recorder;
use super::report::{LinkFigures, RecordFigures};
use super::runner::{RecordWishes, open_recorder};
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
    /// The key that the board wants of those who command it.
    pub key: Option<Key>,
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
    let (link, _keeper) = open(&job.link).map_err(|error| Failure::BadInput(error.to_string()))?;
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let epoch_ns = since.map_or(0, |since| since.as_nanos() as u64);
    let desk = Desk::new(loaded, job.settings.step_us);
    let columns = desk.columns();
    let recorder =
        open_recorder(job.record.as_ref(), &columns, epoch_ns, &loaded.file.to_toml(), &[], &watched())?;
    let page = open_page(source, job, out)?;
    let row = Row { figures: vec![f32::NAN; columns.len()], ..Row::default() };
    let session = Session::new(config(source, job.settings.step_us), fresh_nonce()).with_key(job.key);
    let console = Console::new(loaded, job.shows);
    let begun = Instant::now();
    let arming = Arming::new(job.arm);
    let mut bench = Bench { link, session, desk, console, arming, recorder, page, row, begun, tick: 0 };
    bench.run(job, out)?;
    bench.end(source, job)
}

/// What both ends of the link agree on.
fn config(source: &Source, step_us: u32) -> Config {
    let loaded = &source.loaded;
    let (inputs, outputs) = loaded.process.with_image(|image| link_counts(&image));
    Config {
        role: Role::Controller,
        network_id: loaded.network().id(),
        process_id: loaded.process.id(),
        step_us,
        inputs,
        outputs,
        ..Config::default()
    }
}

/// A page, and where its values stand at the desk.
type Shown = (Page, Vec<Option<usize>>);

fn open_page(source: &Source, job: &Job, out: &mut dyn Write) -> Result<Option<Shown>, Failure> {
    let Some(address) = job.page else { return Ok(None) };
    let catalogue = page::catalogue(source, job.settings, "a board, watched")?;
    let places = desk::places(&source.loaded, &catalogue.values);
    let page = Page::new(source, catalogue, job.settings, address)?;
    if job.shows {
        // Who does not read our output does not stop the bench.
        let _ = writeln!(out, "page http://{}/", page.address());
    }
    Ok(Some((page, places)))
}

/// The bench at work.
struct Bench {
    link: Link,
    session: Session,
    desk: Desk,
    console: Console,
    arming: Arming,
    recorder: Option<Recorder>,
    page: Option<Shown>,
    row: Row,
    begun: Instant,
    tick: u64,
}

impl Bench {
    fn now_us(&self) -> u64 {
        self.begun.elapsed().as_micros() as u64
    }

    fn run(&mut self, job: &Job, out: &mut dyn Write) -> Result<(), Failure> {
        let (mut unasked, mut framed, mut lined) = (self.begun, self.begun, self.begun);
        let patience = Duration::from_micros(UNASKED_TICKS * u64::from(job.settings.step_us));
        let goes_on = |begun: Instant| job.duration.is_none_or(|duration| begun.elapsed() < duration);
        while goes_on(self.begun) && !job.ends.load(Ordering::Relaxed) {
            let asked = self.read(out)?;
            self.console.acknowledged(out, &mut self.session);
            if let Some(orders) = &job.orders
                && self.console.orders(out, orders, &mut self.desk, &mut self.arming)
            {
                break;
            }
            let now = Instant::now();
            if asked || now >= unasked {
                unasked = now + patience;
                self.console.command(&mut self.session);
                self.tick += 1;
                let now_us = self.now_us();
                self.desk.send(&mut self.session, self.tick, now_us);
            }
            let taken = self.link.write(self.session.outgoing());
            self.session.sent(taken);
            if now >= framed {
                framed = now + FRAME;
                if self.arming.is_due(self.desk.mode()) && !self.session.is_commanding() {
                    self.session.command(Command::Mode(Request::Arm));
                }
                self.show();
            }
            if now >= lined {
                lined = now + LINE;
                self.console.line(out, &self.desk, &self.session);
            }
            std::thread::sleep(LOOK);
        }
        Ok(())
    }

    /// Takes what has come, packet by packet; returns whether data were among it.
    fn read(&mut self, out: &mut dyn Write) -> Result<bool, Failure> {
        let mut bytes = [0; 2_048];
        let mut asked = false;
        loop {
            let length = self.link.read(&mut bytes);
            if length == 0 {
                return Ok(asked);
            }
            for frame in bytes[..length].split_inclusive(|byte| *byte == 0) {
                let now_us = self.now_us();
                self.session.feed(frame, now_us);
                if self.session.take_data().is_some() {
                    asked = true;
                    self.packet(now_us, out)?;
                }
            }
        }
    }

    fn packet(&mut self, now_us: u64, out: &mut dyn Write) -> Result<(), Failure> {
        let received = self.session.newest();
        self.arming.observe(received.data.mode);
        if let Some((from, to)) = self.desk.take(received) {
            let text = format!("{from} → {to}");
            self.console.say(out, &text);
            if let Some(recorder) = &mut self.recorder {
                recorder.event(now_us, received.tick, &text)?;
            }
        }
        self.row.head = Head {
            tick: received.tick,
            plant_tick: received.tick,
            begun_us: now_us,
            skipped: self.desk.missing(),
            mode: received.data.mode as u8,
            ..Head::default()
        };
        self.desk.figures(&mut self.row.figures);
        self.recorder.as_mut().map_or(Ok(()), |recorder| recorder.row(&self.row))
    }

    fn show(&mut self) {
        let Some((page, places)) = &mut self.page else { return };
        let report = LinkReport {
            connected: self.session.is_connected(),
            counters: *self.session.counters(),
            sent: self.session.sent_packets(),
            silence: self.session.silence_ticks(),
        };
        let round_trip = self.session.clock().estimate().map(|clock| clock.round_trip_us);
        page.publish(|frame| self.desk.show(frame, places, page::wire(&report, round_trip)));
    }

    fn end(self, source: &Source, job: &Job) -> Result<WatchReport, Failure> {
        let wall_s = self.begun.elapsed().as_secs_f64();
        let record = self.recorder.map(|recorder| finish(recorder, &self.desk)).transpose()?;
        let (clock, session) = (self.session.clock(), &self.session);
        let counts = self.link.counts();
        let figures = LinkFigures {
            round_trip_us: clock.estimate().map(|clock| clock.round_trip_us),
            peer_offset_us: clock.estimate().map(|clock| clock.offset_us),
            ..LinkFigures::new(job.link.to_string(), counts, session.is_connected(), session.counters())
                .with_drift(clock.drift())
        };
        Ok(self.desk.report(source, wall_s, figures, session.refused(), record))
    }
}

/// Data that a record states of such a run.
fn watched() -> BTreeMap<String, String> {
    BTreeMap::from([("watched".to_owned(), "a board".to_owned())])
}

fn finish(recorder: Recorder, desk: &Desk) -> Result<RecordFigures, Failure> {
    let (rows, captures) = (recorder.taken(), recorder.captures());
    let run = watched().into_iter().chain([("mode".to_owned(), desk.mode().name().to_owned())]).collect();
    let files = recorder.finish(run, 0)?;
    let files = files.iter().map(|file| file.display().to_string()).collect();
    Ok(RecordFigures { files, rows, dropped: 0, captures })
}
