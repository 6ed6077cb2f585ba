//! Replay: a recorded run is run again, from its start with its inputs, and must end in the same state to the bit.

use std::collections::BTreeMap;
use std::path::Path;

use eclss_core::{Health, LiveInput, Method, Settings, Simulator};
use mcap::McapError;
use mcap::read::{LinearReader, Options};
use mcap::records::Record;
use serde::{Deserialize, Serialize};

use super::recorder::{BEGIN, INPUTS, NETWORK, PLANT, RUN, START};
use crate::refusal::refused;
use crate::{Failure, HostBuffers, Source};

/// Check sum of a chunk.
static CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// What came out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Replayed {
    /// Steps that were run.
    pub steps: u64,
    /// Hash over the state at the end, hexadecimal.
    pub state_hash: String,
    /// The same as it was recorded; `None` where the record was not ended, as when its program was killed.
    pub recorded_hash: Option<String>,
}

impl Replayed {
    /// Whether both are the same.
    pub fn agrees(&self) -> bool {
        self.recorded_hash.as_ref() == Some(&self.state_hash)
    }
}

/// Inputs from one step on.
#[derive(Debug, Default, Deserialize)]
struct Inputs {
    step: u64,
    ended: Option<u64>,
    bits: Vec<[u32; 2]>,
}

/// Runs a simulator along recorded inputs.
struct Replay<'s> {
    simulator: Simulator<'s>,
    live: Vec<Option<LiveInput>>,
    inputs: Inputs,
    steps: u64,
    /// Steps that there can be at all.
    most: u64,
}

impl Replay<'_> {
    fn until(&mut self, tick: u64) -> Result<(), String> {
        while self.simulator.tick() < tick {
            if self.steps == self.most {
                return Err("more steps than ticks were recorded".into());
            }
            for (live, bits) in self.live.iter().zip(&self.inputs.bits) {
                let [value, slope] = bits.map(f32::from_bits);
                // NaN: left as it was.
                if let Some(live) = live.as_ref().filter(|_| !value.is_nan()) {
                    self.simulator.set_live(live, value, slope).map_err(|error| error.to_string())?;
                }
            }
            if self.simulator.step() != Health::Trusted {
                // It stands still from here on, as it did then.
                return Ok(());
            }
            self.steps += 1;
        }
        Ok(())
    }

    fn take(&mut self, inputs: Inputs) -> Result<(), String> {
        if let Some(last) = inputs.ended {
            self.until(last)?;
            self.simulator.restart();
        }
        self.until(inputs.step.saturating_sub(1))?;
        self.inputs = inputs;
        Ok(())
    }
}

/// Time that one row of a record stands for at most [s]: what bounds the steps of a replay by the record's size.
pub const ROW_S: u64 = 60;

/// Parts of a record that are not messages.
#[derive(Default)]
struct Tape {
    begin: Option<BTreeMap<String, String>>,
    run: Option<BTreeMap<String, String>>,
    network: Option<Vec<u8>>,
    start: Option<Vec<u8>>,
    topics: BTreeMap<u16, String>,
    rows: u64,
    /// Steps of the plant in the newest row.
    plant_tick: u64,
    /// Whether the record stops in the middle: whoever wrote it was killed, or its disk was full.
    torn: bool,
}

/// Part of a row that a replay reads.
#[derive(Debug, Deserialize)]
struct Rest {
    plant_tick: u64,
}

impl Tape {
    /// Goes through the records of a file, and hands over the messages of `topic`. Chunks are not compressed.
    fn read(
        bytes: &[u8],
        mut message: impl FnMut(&Self, &str, &[u8]) -> Result<(), String>,
    ) -> Result<Self, String> {
        let mut tape = Self::default();
        let reader = LinearReader::new_with_options(bytes, Options::IgnoreEndMagic.into());
        for record in reader.map_err(|error| error.to_string())? {
            match record {
                Ok(Record::Chunk { header, data }) => {
                    let sound =
                        header.compression.is_empty() && header.uncompressed_size == data.len() as u64;
                    let crc = header.uncompressed_crc;
                    if !sound || (crc != 0 && CRC.checksum(&data) != crc) {
                        return Err("a chunk of it is damaged".into());
                    }
                    for record in LinearReader::sans_magic(&data) {
                        tape.take(record.map_err(|error| error.to_string())?, &mut message)?;
                    }
                }
                Ok(Record::DataEnd(_)) => return Ok(tape),
                Ok(record) => tape.take(record, &mut message)?,
                // A record that is longer than what is left of the file.
                Err(
                    McapError::UnexpectedEof | McapError::UnexpectedEoc | McapError::RecordTooLarge { .. },
                ) => break,
                Err(error) => return Err(error.to_string()),
            }
        }
        tape.torn = true;
        Ok(tape)
    }

    fn take(
        &mut self,
        record: Record<'_>,
        message: &mut impl FnMut(&Self, &str, &[u8]) -> Result<(), String>,
    ) -> Result<(), String> {
        match record {
            Record::Channel(channel) => {
                self.topics.insert(channel.id, channel.topic);
            }
            Record::Metadata(metadata) if metadata.name == BEGIN => self.begin = Some(metadata.metadata),
            Record::Metadata(metadata) if metadata.name == RUN => self.run = Some(metadata.metadata),
            Record::Attachment { header, data, .. } if header.name == NETWORK => {
                self.network = Some(data.into_owned());
            }
            Record::Attachment { header, data, .. } if header.name == START => {
                self.start = Some(data.into_owned());
            }
            Record::Message { header, data } => {
                let topic = self.topics.get(&header.channel_id).cloned().unwrap_or_default();
                if topic == PLANT {
                    let Rest { plant_tick } =
                        serde_json::from_slice(&data).map_err(|error| error.to_string())?;
                    self.rows += 1;
                    self.plant_tick = plant_tick;
                }
                message(self, &topic, &data)?;
            }
            _ => {}
        }
        Ok(())
    }
}

/// Replays the record at `path`: all of it, or as far as it goes where it was not ended.
pub fn replay(path: &Path) -> Result<Replayed, Failure> {
    let bad = |why: &str| Failure::BadInput(format!("{}: {why}", path.display()));
    let bytes = std::fs::read(path).map_err(|error| bad(&format!("cannot be read: {error}")))?;
    let tape = Tape::read(&bytes, |_, _, _| Ok(())).map_err(|why| bad(&why))?;
    let run = tape.run.as_ref().filter(|_| !tape.torn);
    let begin =
        run.or(tape.begin.as_ref()).ok_or_else(|| bad("not a record of eclss-rt, or nothing of one"))?;
    if begin.contains_key("watched") {
        return Err(bad(
            "a board was watched: what its plant started from is not in the record, so that there is nothing to replay",
        ));
    }
    let told = |map: &BTreeMap<String, String>, key: &str| {
        map.get(key).cloned().ok_or_else(|| bad(&format!("its metadata lack `{key}`")))
    };
    let count = |map: &BTreeMap<String, String>, key: &str| {
        told(map, key)?.parse::<u64>().map_err(|_| bad(&format!("`{key}` is no number")))
    };
    let attached = |part: &Option<Vec<u8>>, name: &str| {
        part.clone().ok_or_else(|| bad(&format!("`{name}` is not attached")))
    };
    let dropped = run.map(|run| count(run, "rows_dropped")).transpose()?.unwrap_or(0);
    if dropped > 0 {
        let text = format!("{dropped} ticks are missing from it, so that it cannot be replayed");
        return Err(bad(&text));
    }
    let network = attached(&tape.network, NETWORK)?;
    let source = Source::text(&network, NETWORK, format!("{NETWORK} in {}", path.display()))?;
    let method = Method::from_name(&told(begin, "method")?).ok_or_else(|| bad("no such method"))?;
    let step_us = u32::try_from(count(begin, "step_us")?).map_err(|_| bad("`step_us` is too large"))?;
    let settings = Settings { method, step_us };
    let network = source.loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator =
        buffers.simulator(&network, settings).map_err(|error| refused(&source, settings, &error))?;
    let start = attached(&tape.start, START)?;
    simulator.restore(&start).map_err(|error| bad(&format!("{START}: {error}")))?;
    // As many steps as the rows can stand for, whatever the metadata say: no record is replayed for ever.
    let most = (tape.rows + 1).saturating_mul(ROW_S * 1_000_000 / u64::from(step_us).max(1));
    let most = run.map(|run| count(run, "rows")).transpose()?.unwrap_or(most).min(most);
    let live = (0..network.inputs.len()).map(|slot| simulator.live_input(slot).ok()).collect();
    let mut replay = Replay { simulator, live, inputs: Inputs::default(), steps: 0, most };
    let play = |_: &Tape, topic: &str, data: &[u8]| {
        if topic != INPUTS {
            return Ok(());
        }
        replay.take(serde_json::from_slice(data).map_err(|error| error.to_string())?)
    };
    Tape::read(&bytes, play).map_err(|why| bad(&why))?;
    let last = run.map(|run| count(run, "steps")).transpose()?.unwrap_or(tape.plant_tick);
    replay.until(last).map_err(|why| bad(&why))?;
    Ok(Replayed {
        steps: replay.steps,
        state_hash: format!("{:016x}", replay.simulator.state_hash()),
        recorded_hash: run.map(|run| told(run, "state_hash")).transpose()?,
    })
}
