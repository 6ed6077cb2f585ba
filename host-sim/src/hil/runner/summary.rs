//! From what loop and housekeeping leave behind to the report.

use eclss_core::Place;
use eclss_core::mode::{Cause, Mode};
use eclss_core::process::{Order as OutputOrder, Process};
use eclss_target::account::Account;

use super::{Job, Outcome};
use crate::Source;
use crate::hil::report::{ChannelFigures, FORMAT, LinkFigures, Machine, Overruns, RecordFigures, Report};

/// What channels of a process image were worth, by name; inputs first.
pub(super) fn channels(names: &[String], process: &Process<'_>) -> Vec<ChannelFigures> {
    let inputs = process.inputs().iter().map(|state| {
        let rejected = state.rejected();
        ChannelFigures {
            name: String::new(),
            direction: "in",
            quality: state.quality().name(),
            not_finite: rejected.not_finite,
            out_of_range: rejected.out_of_range,
            too_fast: rejected.too_fast,
            open_wire: rejected.open_wire,
            limited: state.saturated(),
        }
    });
    let outputs = process.outputs().iter().map(|state| ChannelFigures {
        name: String::new(),
        direction: "out",
        quality: state.quality().name(),
        not_finite: state.not_finite(),
        out_of_range: 0,
        too_fast: 0,
        open_wire: 0,
        limited: state.saturated(),
    });
    let all = inputs.chain(outputs).zip(names);
    all.map(|(figures, name)| ChannelFigures { name: name.clone(), ..figures }).collect()
}

/// What the other thread saw of the loop.
pub(super) struct Seen {
    pub(super) account: Option<Account>,
    pub(super) mode: Mode,
    pub(super) cause: Option<Cause>,
    pub(super) record: Option<RecordFigures>,
}

/// Makes the report.
pub(super) fn report(source: &Source, job: &Job, outcome: &Outcome, seen: Seen, wall_s: f64) -> Report {
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
            ..LinkFigures::new(address.to_string(), bytes, link.connected, &link.counters)
                .with_drift(outcome.drift)
        }
    });
    Report {
        format: FORMAT,
        network: source.name.clone(),
        network_id: format!("{:016x}", loaded.network().id()),
        process_id: format!("{:016x}", outcome.process_id),
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
        channels: outcome.channels.clone(),
        loopback: outcome.loopback.clone(),
        mode: seen.mode.name(),
        cause: seen.cause.map(|why| match (why, outcome.strayed) {
            (Cause::Plant(fault), Some((place, what))) => {
                let id = match place {
                    Place::Node(node) => loaded.names.nodes.get(node as usize),
                    Place::Line(line) => loaded.names.lines.get(line as usize),
                };
                let id = id.map_or("?", String::as_str);
                format!("the plant left its range in step {}: `{id}`: {what}", fault.tick)
            }
            _ => cause(why),
        }),
        state_hash: format!("{:016x}", outcome.state_hash),
        record: seen.record,
        events_lost: outcome.events_lost,
    }
}

/// Why it is SAFE, in words.
pub(super) fn cause(cause: Cause) -> String {
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
