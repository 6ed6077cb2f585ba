//! What a run with hardware was like, in figures.

use std::io::{self, Write};

use eclss_core::protocol::Counters;
use serde::Serialize;

use super::loopback::LoopbackFigures;
use super::timing::{Bucket, Summary};
use eclss_target::wire::LinkCounts;

/// Version of the report's format.
pub const FORMAT: u32 = 1;

/// The whole report.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// [`FORMAT`].
    pub format: u32,
    /// Where the network came from.
    pub network: String,
    /// Its id, hexadecimal.
    pub network_id: String,
    /// Id of the process image, hexadecimal.
    pub process_id: String,
    /// Method.
    pub method: &'static str,
    /// Step [s].
    pub step_s: f64,
    /// When outputs go out: `latched` or `immediate`.
    pub order: &'static str,
    /// The computer, as far as it tells.
    pub machine: Machine,
    /// What the loop had to do without.
    pub missing: Vec<String>,
    /// Rate asked for [Hz].
    pub target_hz: f64,
    /// Rate reached [Hz].
    pub actual_hz: f64,
    /// Ticks that ran.
    pub ticks: u64,
    /// From a tick's begin to its end, handing over included (TET).
    pub tick: Summary,
    /// Part of the period that the longest tick left [1]; negative where it ran over.
    pub headroom: f64,
    /// From a tick's release to its begin.
    pub wake_up: Summary,
    /// The same as a histogram.
    pub wake_up_histogram: Vec<Bucket>,
    /// Ticks that ended after the next release.
    pub overruns: Overruns,
    /// Releases at which no tick ran.
    pub missed_ticks: u64,
    /// Time that the loop ticked through [s].
    pub loop_s: f64,
    /// Steps of the plant times step [s].
    pub plant_s: f64,
    /// Time on the wall [s].
    pub wall_s: f64,
    /// How far the loop's ticks are behind the wall [s].
    pub lag_s: f64,
    /// From reading inputs to giving out what follows from them, measured in the loop; largest minus smallest is its
    /// jitter.
    pub in_out: Summary,
    /// The link, where there is one.
    pub link: Option<LinkFigures>,
    /// Channels of the process image, inputs first.
    pub channels: Vec<ChannelFigures>,
    /// In→out delay by loopback, where it was measured.
    pub loopback: Option<LoopbackFigures>,
    /// Mode at the end.
    pub mode: &'static str,
    /// Why it is SAFE, if it is.
    pub cause: Option<String>,
    /// Hash over the plant's state at the end, hexadecimal.
    pub state_hash: String,
    /// The record, where there is one.
    pub record: Option<RecordFigures>,
    /// Events that found no room.
    pub events_lost: u64,
}

/// The computer.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Machine {
    /// Processor, as the kernel calls it.
    pub processor: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Kernel.
    pub kernel: String,
    /// Whether the processor says that it is a virtual one: then latencies are those of a guest.
    pub virtual_machine: bool,
}

/// Ticks that were too long.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Overruns {
    /// All of them.
    pub total: u32,
    /// The most in a row.
    pub consecutive: u32,
    /// Those in the first second.
    pub start_up: u32,
}

/// Figures of the link.
#[derive(Debug, Clone, Serialize)]
pub struct LinkFigures {
    /// Where it leads.
    pub address: String,
    /// Bytes.
    #[serde(flatten)]
    pub bytes: LinkCounts,
    /// Whether there was a session at the end.
    pub connected: bool,
    /// Sessions that began.
    pub sessions: u32,
    /// Frames that were taken.
    pub accepted: u32,
    /// Frames that never came.
    pub lost: u32,
    /// Frames that came late or out of order.
    pub late: u32,
    /// Frames that had come before.
    pub duplicate: u32,
    /// Frames with a wrong check sum.
    pub bad_crc: u32,
    /// Frames that were damaged otherwise.
    pub damaged: u32,
    /// Frames of another version, network, process image or session.
    pub foreign: u32,
    /// Frames of our own that found no room.
    pub unsent: u32,
    /// Time that a frame takes to the peer and back [µs], of the fastest exchange.
    pub round_trip_us: Option<u64>,
    /// The peer's clock minus ours [µs].
    pub peer_offset_us: Option<i64>,
    /// By how much the peer's clock runs faster [ppm].
    pub peer_drift_ppm: Option<f64>,
}

impl LinkFigures {
    /// Takes the counters over.
    pub fn new(address: String, bytes: LinkCounts, connected: bool, counters: &Counters) -> Self {
        Self {
            address,
            bytes,
            connected,
            sessions: counters.sessions,
            accepted: counters.accepted,
            lost: counters.lost,
            late: counters.late.saturating_add(counters.ancient),
            duplicate: counters.duplicate,
            bad_crc: counters.bad_crc,
            damaged: counters.damaged() - counters.bad_crc,
            foreign: counters.foreign(),
            unsent: counters.unsent,
            round_trip_us: None,
            peer_offset_us: None,
            peer_drift_ppm: None,
        }
    }
}

/// What a channel was worth.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ChannelFigures {
    /// Its slot or point.
    pub name: String,
    /// `in` to the plant or `out` of it.
    pub direction: &'static str,
    /// What its value was worth at the end.
    pub quality: &'static str,
    /// Values that were NaN or infinite.
    pub not_finite: u32,
    /// Values rejected because they were out of range.
    pub out_of_range: u32,
    /// Values rejected because they had changed faster than the channel can.
    pub too_fast: u32,
    /// Values rejected because no sound wire carries them.
    pub open_wire: u32,
    /// Values limited to the range.
    pub limited: u32,
}

/// Figures of the record.
#[derive(Debug, Clone, Default, Serialize)]
pub struct RecordFigures {
    /// Files.
    pub files: Vec<String>,
    /// Ticks that were handed over.
    pub rows: u64,
    /// Ticks that were not: the recorder did not keep up.
    pub dropped: u32,
    /// Captures.
    pub captures: u32,
}

impl Machine {
    /// Asks the kernel.
    pub fn this() -> Self {
        let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let field = |name: &str| {
            let line = cpu.lines().find(|line| line.starts_with(name));
            line.and_then(|line| line.split_once(':')).map(|(_, value)| value.trim().to_owned())
        };
        let kernel = std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
        Self {
            processor: field("model name").unwrap_or_else(|| "unknown".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            kernel: kernel.trim().to_owned(),
            virtual_machine: field("flags")
                .is_some_and(|flags| flags.split(' ').any(|flag| flag == "hypervisor")),
        }
    }
}

/// Writes the report for people.
pub fn write_report(out: &mut dyn Write, report: &Report) -> io::Result<()> {
    let machine = &report.machine;
    let guest = if machine.virtual_machine { ", a virtual machine" } else { "" };
    writeln!(out, "network         {}, id {}", report.network, report.network_id)?;
    writeln!(out, "process image   id {}, outputs {}", report.process_id, report.order)?;
    writeln!(out, "method          {}, step {} ms", report.method, report.step_s * 1e3)?;
    writeln!(
        out,
        "machine         {}, {} cores, Linux {}{guest}",
        machine.processor, machine.cores, machine.kernel
    )?;
    if machine.virtual_machine {
        writeln!(
            out,
            "                a guest's latencies say nothing about a computer with hardware on it"
        )?;
    }
    for missing in &report.missing {
        writeln!(out, "missing         {missing}")?;
    }
    writeln!(out, "rate            {:.3} Hz of {:.3} Hz", report.actual_hz, report.target_hz)?;
    writeln!(out, "ticks           {}, missed {}", report.ticks, report.missed_ticks)?;
    let overruns = report.overruns;
    writeln!(
        out,
        "overruns        {}, {} in a row at most, {} in the first second",
        overruns.total, overruns.consecutive, overruns.start_up
    )?;
    writeln!(out, "                    min      avg      p50      p99    p99.9      max   µs")?;
    times(out, "tick (TET)", &report.tick)?;
    times(out, "wake-up", &report.wake_up)?;
    times(out, "in to out", &report.in_out)?;
    let most = report.wake_up_histogram.iter().map(|bucket| bucket.count).max().unwrap_or(1).max(1);
    for bucket in &report.wake_up_histogram {
        let length = (bucket.count * 40).div_ceil(most) as usize;
        writeln!(
            out,
            "  wake-up up to {:>8} µs {:>9}  {}",
            bucket.up_to_us,
            bucket.count,
            "#".repeat(length)
        )?;
    }
    writeln!(out, "headroom        {:.1} % of the period in the longest tick", report.headroom * 100.0)?;
    writeln!(
        out,
        "time            plant {:.3} s, loop {:.3} s, wall {:.3} s, lag {:.6} s",
        report.plant_s, report.loop_s, report.wall_s, report.lag_s
    )?;
    if let Some(link) = &report.link {
        write_link(out, link)?;
    }
    write_channels(out, &report.channels)?;
    if let Some(loopback) = &report.loopback {
        write_loopback(out, loopback)?;
    }
    if let Some(record) = &report.record {
        write_record(out, record)?;
    }
    if report.events_lost > 0 {
        writeln!(out, "events lost     {}", report.events_lost)?;
    }
    let cause = report.cause.as_ref().map_or(String::new(), |cause| format!(": {cause}"));
    writeln!(out, "mode            {}{cause}", report.mode)?;
    writeln!(out, "state hash      {}", report.state_hash)
}

fn times(out: &mut dyn Write, name: &str, times: &Summary) -> io::Result<()> {
    let Summary { min_us, avg_us, p50_us, p99_us, p999_us, max_us, .. } = times;
    writeln!(
        out,
        "{name:<14} {min_us:>8.1} {avg_us:>8.1} {p50_us:>8.1} {p99_us:>8.1} {p999_us:>8.1} {max_us:>8.1}"
    )
}

/// Writes the figures of a record.
pub(super) fn write_record(out: &mut dyn Write, record: &RecordFigures) -> io::Result<()> {
    writeln!(
        out,
        "record          {} ticks, {} dropped, {} captures",
        record.rows, record.dropped, record.captures
    )?;
    for file in &record.files {
        writeln!(out, "                {file}")?;
    }
    Ok(())
}

fn write_channels(out: &mut dyn Write, channels: &[ChannelFigures]) -> io::Result<()> {
    if channels.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "channels                                    at the end   not finite  range  too fast  wire  limited"
    )?;
    for channel in channels {
        let ChannelFigures {
            name,
            direction,
            quality,
            not_finite,
            out_of_range,
            too_fast,
            open_wire,
            limited,
        } = channel;
        writeln!(
            out,
            "  {direction:<3} {name:<37} {quality:<12} {not_finite:>10} {out_of_range:>6} {too_fast:>9} \
             {open_wire:>5} {limited:>8}"
        )?;
    }
    Ok(())
}

fn write_loopback(out: &mut dyn Write, loopback: &LoopbackFigures) -> io::Result<()> {
    let LoopbackFigures { channel, in_out, jitter_us, ticks: [least, most], end_to_end, discarded } =
        loopback;
    writeln!(
        out,
        "loopback        {} samples through {channel}: {least} to {most} ticks, jitter {jitter_us:.1} µs; {discarded} \
         given up",
        in_out.count
    )?;
    times(out, "  in to out", in_out)?;
    times(out, "  end to end", end_to_end)
}

/// Writes the figures of a link.
pub(super) fn write_link(out: &mut dyn Write, link: &LinkFigures) -> io::Result<()> {
    let state = if link.connected { "connected" } else { "not connected" };
    writeln!(out, "link            {}, {state}, {} sessions", link.address, link.sessions)?;
    writeln!(
        out,
        "frames          {} taken, {} lost, {} late or out of order, {} twice, {} bad CRC, {} otherwise damaged, \
         {} foreign; {} of ours unsent",
        link.accepted,
        link.lost,
        link.late,
        link.duplicate,
        link.bad_crc,
        link.damaged,
        link.foreign,
        link.unsent
    )?;
    if let (Some(round_trip), Some(offset)) = (link.round_trip_us, link.peer_offset_us) {
        let drift = link.peer_drift_ppm.map_or(String::new(), |ppm| format!(", drifts by {ppm:.1} ppm"));
        writeln!(out, "peer's clock    {offset} µs ahead{drift}; round trip {round_trip} µs")?;
    }
    Ok(())
}
