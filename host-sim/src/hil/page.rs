//! The live page of a loop with hardware: the one of `eclss-rt serve`, with mode, channels and link.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use eclss_core::mode::{Cause, Mode};
use eclss_core::{Health, Place, Settings};
use eclss_target::account::Account;
use eclss_target::coupling::LinkReport;

use super::shot::{Album, Camera, Moment, Shot, camera};
use crate::schematic::{Drawing, Dress, Graph};
use crate::serve::feed::{Catalogue, ChannelInfo, Figures, Frame, Hardware, Wire};
use crate::serve::pace::Costs;
use crate::serve::reading::signals;
use crate::serve::{Plant, Publisher, Server, feed};
use crate::{Failure, Source};

/// Time between two frames [µs].
const FRAME_US: u64 = 50_000;

/// A page that is being served.
#[derive(Debug)]
pub struct Page {
    server: Server,
    publisher: Publisher,
    costs: Costs,
    period_us: u32,
}

/// What the page is told once of a plant that is `run` by somebody, with the channels of the process image.
pub fn catalogue(source: &Source, settings: Settings, run: &str) -> Result<Catalogue, Failure> {
    let process = &source.loaded.process;
    let info = |id: &String, input| ChannelInfo { id: id.clone(), input };
    let inputs = process.inputs.iter().map(|entry| info(&entry.name, true));
    let outputs = process.outputs.iter().map(|entry| info(&entry.name, false));
    Ok(Catalogue {
        plant: run.to_owned(),
        scenarios: Vec::new(),
        channels: inputs.chain(outputs).collect(),
        ..Plant::new(source.clone(), settings)?.catalogue(false)
    })
}

impl Page {
    /// Serves `catalogue` at `address`.
    pub fn new(
        source: &Source,
        catalogue: Catalogue,
        settings: Settings,
        address: SocketAddr,
    ) -> Result<Self, Failure> {
        let graph = Graph::of(&source.loaded.file);
        let drawing = Drawing::new(&graph).map(|drawing| drawing.svg(&graph, Dress::Page)).ok();
        let (publisher, feed) = feed(catalogue);
        let server = Server::start(address, feed, drawing)
            .map_err(|error| Failure::Failed(format!("cannot listen at {address}: {error}")))?;
        let costs = Costs::new();
        let costs = costs.ok_or_else(|| Failure::Failed("the histogram of costs cannot be made".into()))?;
        Ok(Self { server, publisher, costs, period_us: settings.step_us })
    }

    /// The loop's camera for this page and the album that [`Self::show`] takes.
    pub fn camera(&self, source: &Source, settings: Settings) -> (Camera, Album) {
        let process = &source.loaded.process;
        let channels = process.inputs.len() + process.outputs.len();
        let every = FRAME_US / u64::from(self.period_us).max(1);
        camera(&source.loaded, signals(&source.loaded, settings.method), channels, every)
    }

    /// Where it is served.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Publishes a frame.
    pub fn publish(&mut self, fill: impl FnOnce(&mut Frame)) {
        self.publisher.publish(fill);
    }

    /// Publishes a shot.
    pub fn show(&mut self, shot: &Shot) {
        for ns in &shot.tick_ns {
            self.costs.note(Duration::from_nanos((*ns).into()));
        }
        self.costs.close(Instant::now());
        let longest = shot.tick_ns.iter().max().copied().unwrap_or(0);
        let headroom = 1.0 - f64::from(longest) * 1e-3 / f64::from(self.period_us);
        let costs = &self.costs;
        self.publisher.publish(|frame| {
            frame.values.copy_from_slice(&shot.values);
            frame.figures = Figures {
                headroom,
                mean_us: costs.mean_us,
                p99_us: costs.p99_us,
                worst_us: costs.worst_us,
                ..figures(&shot.moment)
            };
            let hardware = frame.hardware.get_or_insert_default();
            fill(hardware, &shot.moment);
            hardware.quality.clear();
            hardware.quality.extend(shot.quality.iter().map(|quality| quality.name()));
            hardware.rejected.clone_from(&shot.rejected);
        });
    }
}

fn figures(moment: &Moment) -> Figures {
    let (fault_node, fault_line) = match moment.health {
        Health::Trusted => (None, None),
        Health::Faulted(fault) => match fault.place {
            Place::Node(node) => (Some(node), None),
            Place::Line(line) => (None, Some(line)),
        },
    };
    let mut figures = Figures {
        tick: moment.steps,
        t_s: moment.t_s,
        paused: moment.mode == Mode::Hold,
        speed: 1.0,
        overruns: moment.account.map(|account| account.overruns.into()),
        lag_s: moment.account.map_or(0.0, |account| account.lag_us() as f64 * 1e-6),
        phi: moment.phi[0],
        phi_worst: moment.phi[1],
        closure: moment.closure,
        trusted: moment.health == Health::Trusted,
        fault_node,
        fault_line,
        fault: moment.excursion,
        ..Figures::default()
    };
    figures.warn(moment.warning);
    figures
}

fn fill(hardware: &mut Hardware, moment: &Moment) {
    hardware.mode = moment.mode.name();
    hardware.cause = moment.cause.map(cause);
    if let Some(account) = &moment.account {
        loop_figures(hardware, account);
    }
    hardware.link = moment.link.map(|link| wire(&link, moment.clock.map(|clock| clock.round_trip_us)));
}

fn loop_figures(hardware: &mut Hardware, account: &Account) {
    hardware.rate_hz = f64::from(account.actual_millihertz()) / 1e3;
    hardware.overruns = Some(account.overruns);
    hardware.overruns_in_a_row = Some(account.worst_consecutive_overruns);
    hardware.missed = Some(account.skipped);
    hardware.late_us = Some(account.lateness_us.max());
}

/// Figures of a link.
pub fn wire(link: &LinkReport, round_trip_us: Option<u64>) -> Wire {
    let counters = link.counters;
    Wire {
        connected: link.connected,
        sessions: counters.sessions,
        accepted: counters.accepted,
        lost: counters.lost,
        late: counters.late.saturating_add(counters.ancient).saturating_add(counters.duplicate),
        damaged: counters.damaged(),
        foreign: counters.foreign(),
        silence: link.silence,
        round_trip_us,
    }
}

fn cause(cause: Cause) -> &'static str {
    match cause {
        Cause::Reset => "the last run did not end well",
        Cause::Overruns { .. } => "overruns in a row",
        Cause::Lag { .. } => "too far behind the clock",
        Cause::Plant(_) => "the plant left its range",
        Cause::Silence { .. } => "the link was silent",
        Cause::Input { .. } => "an input was lost",
        Cause::Operator => "somebody asked for it",
    }
}
