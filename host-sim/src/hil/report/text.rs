//! The report for people.

use std::io::{self, Write};

use super::{ChannelFigures, LinkFigures, RecordFigures, Report};
use crate::hil::loopback::LoopbackFigures;
use crate::hil::timing::Summary;

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
pub(in crate::hil) fn write_record(out: &mut dyn Write, record: &RecordFigures) -> io::Result<()> {
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
pub(in crate::hil) fn write_link(out: &mut dyn Write, link: &LinkFigures) -> io::Result<()> {
    let state = if link.connected { "connected" } else { "not connected" };
    writeln!(out, "link            {}, {state}, {} sessions", link.address, link.sessions)?;
    writeln!(
        out,
        "frames          {} taken, {} of them too old, {} bytes left out for newer ones, {} lost, {} late or out of order, {} twice, {} bad CRC, {} otherwise damaged, \
         {} foreign; {} of ours unsent",
        link.accepted,
        link.stale,
        link.bytes.bytes_skipped,
        link.lost,
        link.late,
        link.duplicate,
        link.bad_crc,
        link.damaged,
        link.foreign,
        link.unsent
    )?;
    if link.unproven > 0 {
        writeln!(out, "commands        {} refused without proof of the key", link.unproven)?;
    }
    if let (Some(round_trip), Some(offset)) = (link.round_trip_us, link.peer_offset_us) {
        let drift = link.peer_drift_ppm.zip(link.peer_drift_error_ppm);
        let drift =
            drift.map_or(String::new(), |(ppm, error)| format!(", drifts by {ppm:.1} ± {error:.1} ppm"));
        writeln!(out, "peer's clock    {offset} µs ahead{drift}; round trip {round_trip} µs")?;
    }
    Ok(())
}
