//! MCAP files: the record for viewers, and everything that a replay needs.
//!
//! | topic | what |
//! |---|---|
//! | `/plant` | decimated figures: last, `_min` and `_max` |
//! | `/inputs` | value and slope of every input slot where they change, as numbers and as bits |
//! | `/capture` | every tick around a trigger |
//! | `/events` | captures and what pulled them |
//!
//! Attached are the network file (`network.toml`) and the state at the start (`start.eckp`); the metadata record
//! `begin` says what is run, and `run` at the end how it ended. Messages are JSON with a schema, which every viewer of MCAP reads.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, McapResult, WriteOptions, Writer};
use serde_json::{Map, Value, json};

use super::super::handover::Row;
use super::decimate::Bucket;
use super::table::mode_name;

/// Size of a chunk, which is lost as a whole where it does not fit the disk [bytes].
const CHUNK: u64 = 65_536;

/// Name of the attached state at the start.
pub(in super::super) const START: &str = "start.eckp";
/// Name of the attached network.
pub(in super::super) const NETWORK: &str = "network.toml";
/// Topic of rows.
pub(in super::super) const PLANT: &str = "/plant";
/// Topic of inputs.
pub(in super::super) const INPUTS: &str = "/inputs";
/// Name of the metadata record at the begin: what is run.
pub(in super::super) const BEGIN: &str = "begin";
/// Name of that at the end: how the run ended.
pub(in super::super) const RUN: &str = "run";

/// A file that is being written.
pub(super) struct Container<W: Write + Seek> {
    writer: Writer<W>,
    names: Vec<String>,
    topics: [u16; 4],
    sequence: u32,
    /// Wall time of the start [ns since 1970].
    epoch_ns: u64,
    inputs: Vec<[u32; 2]>,
    plant_tick: Option<u64>,
}

/// The topics in the order of [`Container::topics`].
const TOPICS: [&str; 4] = [PLANT, INPUTS, "/capture", "/events"];

impl<W: Write + Seek> Container<W> {
    /// Begins a file with the network and the state at the start.
    pub(super) fn new(
        file: W,
        names: &[String],
        epoch_ns: u64,
        network: &str,
        start: &[u8],
        begin: &BTreeMap<String, String>,
    ) -> McapResult<Self> {
        // Chunks are written as a whole, so that what a run that was killed or a disk that is full leaves behind can be read.
        let options = WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .chunk_size(Some(CHUNK))
            .library("eclss-rt");
        let mut writer = options.create(file)?;
        let number = |name: &String| (name.clone(), json!({ "type": "number" }));
        let ends = |end: &'static str| names.iter().map(move |name| format!("{name}{end}"));
        let single: Map<String, Value> = names.iter().map(number).collect();
        let mut triple = single.clone();
        triple.extend(ends("_min").chain(ends("_max")).map(|name| number(&name)));
        let values = json!({ "type": "array", "items": { "type": "array", "items": { "type": "number" } } });
        let inputs = Map::from_iter([("values".to_owned(), values)]);
        let events = Map::from_iter([("event".to_owned(), json!({ "type": "string" }))]);
        let mut topics = [0; 4];
        for ((topic, id), properties) in TOPICS.iter().zip(&mut topics).zip([triple, inputs, single, events])
        {
            let schema = json!({ "type": "object", "properties": properties }).to_string();
            let schema = writer.add_schema(topic.trim_start_matches('/'), "jsonschema", schema.as_bytes())?;
            *id = writer.add_channel(schema, topic, "json", &BTreeMap::new())?;
        }
        for (name, media_type, data) in
            [(NETWORK, "application/toml", network.as_bytes()), (START, "application/octet-stream", start)]
        {
            if data.is_empty() {
                // The state of a board that is only watched is not known.
                continue;
            }
            writer.attach(&Attachment {
                log_time: epoch_ns,
                create_time: epoch_ns,
                name: name.to_owned(),
                media_type: media_type.to_owned(),
                data: Cow::Borrowed(data),
            })?;
        }
        writer.write_metadata(&Metadata { name: BEGIN.to_owned(), metadata: begin.clone() })?;
        writer.flush()?;
        let names = names.to_vec();
        Ok(Self { writer, names, topics, sequence: 0, epoch_ns, inputs: Vec::new(), plant_tick: None })
    }

    fn write(&mut self, topic: usize, begun_us: u64, message: &Value) -> McapResult<()> {
        let log_time = self.epoch_ns + begun_us * 1_000;
        let channel_id = self.topics[topic];
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time, publish_time: log_time };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, message.to_string().as_bytes())
    }

    /// Writes a bucket.
    pub(super) fn bucket(&mut self, bucket: &Bucket, every: u64) -> McapResult<()> {
        let mut message = head(&bucket.last);
        for (index, name) in self.names.iter().enumerate() {
            message.insert(name.clone(), number(bucket.last.figures.get(index)));
            if every > 1 {
                message.insert(format!("{name}_min"), number(bucket.min.get(index)));
                message.insert(format!("{name}_max"), number(bucket.max.get(index)));
            }
        }
        self.write(0, bucket.last.head.begun_us, &Value::Object(message))
    }

    /// Writes the inputs that were set for a step, where they are not those of the step before; null for one that was
    /// left as it is. `ended` is the last step before a restart of the plant. A replay reads the bits.
    pub(super) fn inputs(&mut self, row: &Row) -> McapResult<()> {
        let last = self.plant_tick.replace(row.head.plant_tick);
        let restarted = last.filter(|last| *last >= row.head.plant_tick);
        let bits = |pair: &[f32; 2]| pair.map(f32::to_bits);
        if last.is_some()
            && restarted.is_none()
            && self.inputs.iter().copied().eq(row.inputs.iter().map(bits))
        {
            return Ok(());
        }
        self.inputs = row.inputs.iter().map(bits).collect();
        let values: Vec<[Value; 2]> =
            row.inputs.iter().map(|[value, slope]| [number(Some(value)), number(Some(slope))]).collect();
        let message = json!({
            "step": row.head.plant_tick, "ended": restarted, "values": values, "bits": self.inputs,
        });
        self.write(1, row.head.begun_us, &message)
    }

    /// Writes one tick of a capture.
    pub(super) fn captured(&mut self, row: &Row) -> McapResult<()> {
        let mut message = head(row);
        for (index, name) in self.names.iter().enumerate() {
            message.insert(name.clone(), number(row.figures.get(index)));
        }
        self.write(2, row.head.begun_us, &Value::Object(message))
    }

    /// Writes an event.
    pub(super) fn event(&mut self, begun_us: u64, tick: u64, event: &str) -> McapResult<()> {
        self.write(3, begun_us, &json!({ "tick": tick, "event": event }))
    }

    /// Closes the present chunk and hands everything to the system.
    pub(super) fn flush(&mut self) -> McapResult<()> {
        self.writer.flush()
    }

    /// Ends the file with what is known of the run.
    pub(super) fn finish(mut self, run: BTreeMap<String, String>) -> McapResult<()> {
        self.writer.write_metadata(&Metadata { name: RUN.to_owned(), metadata: run })?;
        self.writer.finish()?;
        self.writer.into_inner().flush()?;
        Ok(())
    }
}

fn head(row: &Row) -> Map<String, Value> {
    let head = &row.head;
    let late = f64::from(head.late_ns) / 1e3;
    let tick = f64::from(head.tick_ns) / 1e3;
    let Value::Object(map) = json!({
        "tick": head.tick, "plant_tick": head.plant_tick, "mode": mode_name(head.mode),
        "late_us": late, "tick_us": tick, "skipped": head.skipped,
    }) else {
        return Map::new();
    };
    map
}

/// In the shortest digits that give the same `f32` back; null for what is not a number.
fn number(value: Option<&f32>) -> Value {
    // Through text, because as an `f64` it would get nine more digits that mean nothing.
    value
        .filter(|value| value.is_finite())
        .and_then(|value| serde_json::from_str(&value.to_string()).ok())
        .unwrap_or(Value::Null)
}
