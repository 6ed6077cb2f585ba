//! Reads `[process]` and `[[channel]]`: keys, types, ranges.

use toml::de::DeValue;

use crate::document::{ChannelEntry, InputKeys, ProcessEntry};
use crate::limits::{self, Range};
use crate::number::number;
use crate::table::Table;

pub(crate) fn read_process(process: &mut Table<'_, '_>) -> ProcessEntry {
    ProcessEntry {
        order: process.word("order", &["latched", "immediate"]),
        safe_after_ticks: whole(process, "safe_after_ticks", &limits::TICKS),
        settled_part: process.number("settled_part", &limits::SETTLED_PART),
        settled_s: process.number("settled_s", &limits::SETTLED_S),
    }
}

pub(crate) fn read_channel(channel: &mut Table<'_, '_>) -> Option<ChannelEntry> {
    let bind = channel.need_text("bind");
    let direction = channel.need_word("direction", &["in", "out"])?;
    let input = if direction == "in" { read_input(channel) } else { InputKeys::default() };
    Some(ChannelEntry {
        bind,
        direction,
        analog: whole(channel, "analog", &limits::CONVERTER),
        electrical: pairs(channel, "electrical"),
        scale: pairs(channel, "scale"),
        wire: wire(channel),
        calibration_id: calibration_id(channel),
        calibration_date: channel.text("calibration_date"),
        min: channel.number("min", &limits::ANY),
        max: channel.number("max", &limits::ANY),
        max_rate_per_s: channel.number("max_rate_per_s", &limits::RATE),
        safe_value: channel.need_number("safe_value", &limits::ANY),
        safe_rate_per_s: channel.number("safe_rate_per_s", &limits::RATE),
        input,
    })
}

fn read_input(channel: &mut Table<'_, '_>) -> InputKeys {
    InputKeys {
        beyond: channel.word("beyond", &["reject", "limit"]),
        filter_s: channel.number("filter_s", &limits::FILTER),
        hold: channel.word("hold", &["zero", "linear"]),
        extrapolate_ticks: whole(channel, "extrapolate_ticks", &limits::SOME_TICKS),
        event_step: channel.number("event_step", &limits::RATE),
        stale_ticks: whole(channel, "stale_ticks", &limits::TICKS),
        loss: channel.word("loss", &["safe", "go_on"]),
    }
}

/// A whole number of a key that may be absent.
fn whole(table: &mut Table<'_, '_>, key: &'static str, range: &Range) -> Option<f64> {
    let value = table.number(key, range)?;
    if value.fract() == 0.0 {
        return Some(value);
    }
    table.refuse(key, format!("`{key}` must be a whole number, not {value}"));
    None
}

fn calibration_id(channel: &mut Table<'_, '_>) -> Option<String> {
    let id = channel.text("calibration_id")?;
    let plain = id.chars().all(|character| character.is_ascii_graphic() || character == ' ');
    if !plain || id.len() > limits::CALIBRATION_BYTES {
        let most = limits::CALIBRATION_BYTES;
        channel
            .refuse("calibration_id", format!("`calibration_id` is plain text of at most {most} characters"));
    }
    Some(id)
}

fn wire(channel: &mut Table<'_, '_>) -> Option<(f64, f64)> {
    let array = channel.array("wire")?;
    if let [least, most] = array {
        let least = number(channel.notes, "wire", least, &limits::ANY)?;
        return Some((least, number(channel.notes, "wire", most, &limits::ANY)?));
    }
    channel.refuse("wire", "`wire` is the smallest and the largest value of a sound wire, as in [3.6, 21.0]");
    None
}

/// A curve: at least two pairs.
fn pairs(channel: &mut Table<'_, '_>, key: &'static str) -> Vec<(f64, f64)> {
    let Some(array) = channel.array(key) else { return Vec::new() };
    if !(2..=limits::TABLE_POINTS).contains(&array.len()) {
        let most = limits::TABLE_POINTS;
        channel.refuse(key, format!("`{key}` needs 2 … {most} pairs, as in [[4.0, 0.0], [20.0, 0.1]]"));
        return Vec::new();
    }
    let mut pairs = Vec::with_capacity(array.len());
    for value in array {
        if let DeValue::Array(pair) = value.get_ref()
            && let [from, to] = pair.as_ref()
        {
            let from = number(channel.notes, key, from, &limits::ANY);
            let to = number(channel.notes, key, to, &limits::ANY);
            pairs.push((from.unwrap_or(0.0), to.unwrap_or(0.0)));
        } else {
            channel.notes.refuse(value.span(), format!("`{key}` is a list of pairs"));
        }
    }
    pairs
}
