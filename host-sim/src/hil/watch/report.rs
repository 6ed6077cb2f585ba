//! What was seen of a board.

use std::io::{self, Write};

use serde::Serialize;

use super::super::report::{LinkFigures, RecordFigures, write_link, write_record};

/// The whole report.
#[derive(Debug, Clone, Serialize)]
pub struct WatchReport {
    /// Version of the format.
    pub format: u32,
    /// Where the network came from.
    pub network: String,
    /// Its id, hexadecimal.
    pub network_id: String,
    /// Id of the process image, hexadecimal.
    pub process_id: String,
    /// Time on the wall [s].
    pub wall_s: f64,
    /// Rate of the board's ticks by its own clock [Hz].
    pub rate_hz: Option<f64>,
    /// Its newest tick.
    pub tick: u64,
    /// Packets of process data.
    pub packets: u64,
    /// Ticks between them of which none came.
    pub missing: u64,
    /// Mode at the end; `unknown` where no packet came.
    pub mode: &'static str,
    /// Why it is SAFE, where it is.
    pub cause: Option<&'static str>,
    /// What the board refused the session for, where it did.
    pub refused: Option<String>,
    /// Channels over the link, inputs of the plant first.
    pub channels: Vec<WatchedChannel>,
    /// The link.
    pub link: LinkFigures,
    /// The record, where there is one.
    pub record: Option<RecordFigures>,
}

/// A channel as it was seen.
#[derive(Debug, Clone, Serialize)]
pub struct WatchedChannel {
    /// Its slot or point.
    pub name: String,
    /// `in` to the plant or `out` of it.
    pub direction: &'static str,
    /// Its value at the end.
    pub value: f32,
    /// What it was worth: an input by the board's judgement.
    pub quality: &'static str,
    /// Packets in which it was not good.
    pub not_good: u32,
}

/// Writes the report for people.
pub fn write_watch(out: &mut dyn Write, report: &WatchReport) -> io::Result<()> {
    writeln!(out, "network         {}, id {}", report.network, report.network_id)?;
    writeln!(out, "process image   id {}", report.process_id)?;
    let rate = report.rate_hz.map_or("unknown".to_owned(), |rate| format!("{rate:.3} Hz by its own clock"));
    writeln!(out, "board           tick {}, {rate}", report.tick)?;
    writeln!(
        out,
        "process data    {} packets in {:.3} s; of {} ticks between none came",
        report.packets, report.wall_s, report.missing
    )?;
    if let Some(reason) = &report.refused {
        writeln!(out, "refused         the board runs another {reason}")?;
    }
    writeln!(out, "channels                                           value  at the end   packets not good")?;
    for WatchedChannel { name, direction, value, quality, not_good } in &report.channels {
        writeln!(out, "  {direction:<3} {name:<37} {value:>11.5}  {quality:<12} {not_good}")?;
    }
    write_link(out, &report.link)?;
    if let Some(record) = &report.record {
        write_record(out, record)?;
    }
    let cause = report.cause.map_or(String::new(), |cause| format!(": {cause}"));
    writeln!(out, "mode            {}{cause}", report.mode)
}
