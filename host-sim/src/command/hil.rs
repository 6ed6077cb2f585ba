//! `eclss-rt hil` and `eclss-rt replay`: the real-time loop with hardware, and a recorded run once more.

use std::io::Write;
use std::path::PathBuf;

use eclss_core::Settings;
use eclss_target::wire::Address;

use crate::args::{HilArgs, ReplayArgs, WatchArgs};
use crate::coupling;
use crate::hil::key::read_key;
use crate::hil::operator;
use crate::hil::pace::Pace;
use crate::hil::recorder::Trigger;
use crate::hil::replay::{ROW_S, replay};
use crate::hil::report::write_report;
use crate::hil::runner::{self, Job, Loopback, RecordWishes};
use crate::hil::watch;
use crate::run::{Plan, Wishes};
use crate::{Duration, Failure, Source};

/// Runs the loop and reports. A run that ends in SAFE is reported like any other and then fails.
pub(super) fn run(args: &HilArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::file(&args.network)?;
    let job = job(args, &source)?;
    if job.link.is_some() {
        judge_coupling(args, &source, job.settings, out)?;
    }
    if job.shows {
        let link = job.link.as_ref().map_or("none".to_owned(), ToString::to_string);
        writeln!(out, "network {}, link {link}", source.name)?;
    }
    let report = runner::run(&source, &job, out)?;
    if args.json {
        let text = serde_json::to_string_pretty(&report)
            .map_err(|error| Failure::Failed(format!("cannot write the report: {error}")))?;
        writeln!(out, "{text}")?;
    } else {
        writeln!(out)?;
        write_report(out, &report)?;
    }
    if report.cause.is_some() { Err(Failure::Reported) } else { Ok(()) }
}

/// Says what `check --hil` says of the coupling, and refuses what it refuses unless that was accepted.
fn judge_coupling(
    args: &HilArgs,
    source: &Source,
    settings: Settings,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let coupling = coupling::examine(&source.loaded, settings, args.extra_delay);
    if !args.json {
        for warning in &coupling.warnings {
            writeln!(out, "warning: {warning}")?;
        }
    }
    if coupling.refusals.is_empty() {
        return Ok(());
    }
    let refusals = coupling.refusals.join("\n");
    if args.accept_margin {
        if !args.json {
            writeln!(out, "accepted: {refusals}")?;
        }
        return Ok(());
    }
    Err(Failure::BadInput(format!("{}: {refusals}\nrun it all the same with --accept-margin", source.name)))
}

fn job(args: &HilArgs, source: &Source) -> Result<Job, Failure> {
    let bad = |what: &str, why: &str| Failure::BadInput(format!("{what}: {why}"));
    let step = match args.rate {
        None => None,
        Some(rate) => {
            let step_us = 1_000_000 / u64::from(rate);
            if step_us * u64::from(rate) != 1_000_000 {
                return Err(bad("--rate", "the period must be a whole number of microseconds"));
            }
            Some(Duration::from_us(step_us))
        }
    };
    let wishes = Wishes { method: args.method, step, until: args.duration, ..Wishes::default() };
    let plan = Plan::new(source, &wishes)?;
    let Settings { step_us, .. } = plan.settings;
    let link = args.link.as_deref().map(|text| Address::read(text, args.peer.as_deref())).transpose();
    let link = link.map_err(|error| bad("--link", &error.to_string()))?;
    let in_ticks = |time: Duration| time.us() / u64::from(step_us).max(1);
    let record = record_wishes(args.record.as_ref(), &args.capture, args.every, args.around, step_us)?;
    let loopback = match args.loopback.as_deref() {
        None => None,
        Some("") if link.is_some() => {
            return Err(bad("--loopback", "says nothing about where its wire to --link is"));
        }
        Some("") => Some(Loopback::Inside),
        Some(_) if link.is_none() => return Err(bad("--loopback", "needs --link, where its wire leads to")),
        Some(text) => {
            let peer = match &link {
                Some(Address::Udp { local, .. }) => Some(local.to_string()),
                _ => None,
            };
            let address = Address::read(text, peer.as_deref());
            Some(Loopback::Over(address.map_err(|error| bad("--loopback", &error.to_string()))?))
        }
    };
    let start = args.start.as_ref().map(|path| {
        std::fs::read(path)
            .map_err(|error| Failure::BadInput(format!("{}: cannot be read: {error}", path.display())))
    });
    let stall = args.stall.as_deref().map(stall).transpose().map_err(|why| bad("--stall", &why))?;
    Ok(Job {
        settings: plan.settings,
        link,
        key: args.key.as_deref().map(read_key).transpose()?,
        ticks: args.duration.map(in_ticks),
        pace: match args.speed {
            None => Pace::Real,
            Some(speed) => Pace::Scaled(speed),
        },
        core: args.core,
        arm: args.arm,
        record,
        start: start.transpose()?,
        resume: args.resume,
        checkpoint: args.checkpoint.clone(),
        stall,
        operator: args.operator,
        shows: !args.json,
        interrupts: true,
        loopback,
        page: args.page,
    })
}

/// Reads a stall, as in `2000:5ms`.
fn stall(text: &str) -> Result<crate::hil::board::Stall, String> {
    let parts = text.split_once(':').and_then(|(tick, by)| Some((tick.parse().ok()?, by.parse().ok()?)));
    let (tick, by): (u64, Duration) = parts.ok_or("a tick and how much longer it takes, as in 2000:5ms")?;
    Ok(crate::hil::board::Stall { tick, by: std::time::Duration::from_micros(by.us()) })
}

/// Watches a board and reports. One that is in SAFE at the end, or with which there never was a session, is reported like
/// any other and then fails.
pub(super) fn run_watch(args: &WatchArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::file(&args.network)?;
    let Settings { step_us, .. } = Plan::new(&source, &Wishes::default())?.settings;
    let link = Address::read(&args.link, args.peer.as_deref());
    let link = link.map_err(|error| Failure::BadInput(format!("--link: {error}")))?;
    let record = record_wishes(args.record.as_ref(), &args.capture, args.every, args.around, step_us)?;
    let job = watch::Job {
        settings: Settings { method: source.loaded.run.method, step_us },
        link,
        key: args.key.as_deref().map(read_key).transpose()?,
        duration: args.duration.map(|time| std::time::Duration::from_micros(time.us())),
        arm: args.arm,
        record,
        page: args.page,
        orders: args.operator.then(operator::type_along),
        shows: !args.json,
        ends: operator::interrupts(),
    };
    let report = watch::watch(&source, &job, out)?;
    if args.json {
        let text = serde_json::to_string_pretty(&report)
            .map_err(|error| Failure::Failed(format!("cannot write the report: {error}")))?;
        writeln!(out, "{text}")?;
    } else {
        writeln!(out)?;
        watch::write_watch(out, &report)?;
    }
    if report.cause.is_some() || report.packets == 0 { Err(Failure::Reported) } else { Ok(()) }
}

/// Reads what is to be recorded.
fn record_wishes(
    folder: Option<&PathBuf>,
    capture: &[String],
    every: Duration,
    around: Duration,
    step_us: u32,
) -> Result<Option<RecordWishes>, Failure> {
    let refused = |why: &str| Failure::BadInput(format!("--capture: {why}"));
    let read = |text: &String| text.parse().map_err(|why: String| refused(&why));
    let triggers = capture.iter().map(read).collect::<Result<Vec<Trigger>, _>>()?;
    if folder.is_none() && !triggers.is_empty() {
        return Err(refused("needs --record"));
    }
    if every.us() > ROW_S * 1_000_000 {
        return Err(Failure::BadInput(format!("--every: a row stands for {ROW_S} s at most")));
    }
    let in_ticks = |time: Duration| time.us() / u64::from(step_us).max(1);
    Ok(folder.map(|folder| RecordWishes {
        folder: folder.clone(),
        every: in_ticks(every).max(1),
        triggers,
        around: (in_ticks(around) as usize, in_ticks(around)),
    }))
}

/// Replays a record.
pub(super) fn run_replay(args: &ReplayArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let replayed = replay(&args.record)?;
    if args.json {
        let text = serde_json::to_string_pretty(&replayed)
            .map_err(|error| Failure::Failed(format!("cannot write the report: {error}")))?;
        writeln!(out, "{text}")?;
    } else {
        writeln!(out, "{} steps", replayed.steps)?;
        writeln!(out, "state hash  {}", replayed.state_hash)?;
        if let Some(recorded) = &replayed.recorded_hash {
            writeln!(out, "recorded    {recorded}")?;
            writeln!(out, "{}", if replayed.agrees() { "the same" } else { "NOT the same" })?;
        } else {
            writeln!(out, "the record was not ended: this is as far as it goes, with nothing to compare")?;
        }
    }
    if replayed.agrees() { Ok(()) } else { Err(Failure::Reported) }
}
