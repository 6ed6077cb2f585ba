//! CSV files: decimated rows, and every tick of a capture.

use std::io::{self, Write};

use super::super::handover::Row;
use super::decimate::Bucket;
use eclss_core::mode::Mode;

/// What both kinds of tables begin with.
const HEAD: &str = "t_s,tick,plant_tick,mode,late_us,tick_us,skipped";

/// Writes the names of a decimated table: of each figure the last value and, where there is more than one, the
/// smallest and the largest.
pub(super) fn write_names(out: &mut dyn Write, names: &[String], every: u64) -> io::Result<()> {
    write!(out, "{HEAD}")?;
    for name in names {
        write!(out, ",{name}")?;
        if every > 1 {
            write!(out, ",{name}_min,{name}_max")?;
        }
    }
    writeln!(out)
}

/// Writes one bucket.
pub(super) fn write_bucket(out: &mut dyn Write, bucket: &Bucket, every: u64) -> io::Result<()> {
    write_head(out, &bucket.last, bucket.late_ns, bucket.tick_ns, bucket.skipped)?;
    for ((last, min), max) in bucket.last.figures.iter().zip(&bucket.min).zip(&bucket.max) {
        write_value(out, *last)?;
        if every > 1 {
            write_value(out, *min)?;
            write_value(out, *max)?;
        }
    }
    writeln!(out)
}

/// Writes one tick of a capture.
pub(super) fn write_row(out: &mut dyn Write, row: &Row) -> io::Result<()> {
    write_head(out, row, row.head.late_ns, row.head.tick_ns, u64::from(row.head.skipped))?;
    for value in &row.figures {
        write_value(out, *value)?;
    }
    writeln!(out)
}

fn write_head(out: &mut dyn Write, row: &Row, late_ns: u32, tick_ns: u32, skipped: u64) -> io::Result<()> {
    let head = &row.head;
    let (s, us) = (head.begun_us / 1_000_000, head.begun_us % 1_000_000);
    let (late, tick) = (f64::from(late_ns) / 1e3, f64::from(tick_ns) / 1e3);
    let mode = mode_name(head.mode);
    write!(out, "{s}.{us:06},{},{},{mode},{late:.3},{tick:.3},{skipped}", head.tick, head.plant_tick)
}

/// An empty cell for what is not a number; else digits that give the same `f32` back.
fn write_value(out: &mut dyn Write, value: f32) -> io::Result<()> {
    if value.is_finite() { write!(out, ",{value}") } else { write!(out, ",") }
}

/// The mode's name.
pub(super) fn mode_name(mode: u8) -> &'static str {
    Mode::ALL.get(usize::from(mode)).map_or("?", |mode| mode.name())
}
