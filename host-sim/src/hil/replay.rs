//! Replay: a recorded run is run again, from its start with its inputs, and must end in the same state to the bit.

use std::path::Path;

use eclss_core::{Health, LiveInput, Method, Settings, Simulator};
use mcap::{MessageStream, Summary};
use serde::{Deserialize, Serialize};

use super::recorder::{INPUTS, NETWORK, RUN, START};
use crate::refusal::refused;
use crate::{Failure, HostBuffers, Source};

/// What came out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Replayed {
    /// Steps that were run.
    pub steps: u64,
    /// Hash over the state at the end, hexadecimal.
    pub state_hash: String,
    /// The same as it was recorded.
    pub recorded_hash: String,
}

impl Replayed {
    /// Whether both are the same.
    pub fn agrees(&self) -> bool {
        self.state_hash == self.recorded_hash
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

/// Replays the record at `path`.
pub fn replay(path: &Path) -> Result<Replayed, Failure> {
    let bad = |why: &str| Failure::BadInput(format!("{}: {why}", path.display()));
    let broken = |error: mcap::McapError| bad(&error.to_string());
    let bytes = std::fs::read(path).map_err(|error| bad(&format!("cannot be read: {error}")))?;
    let summary = Summary::read(&bytes).map_err(broken)?;
    let summary = summary.ok_or_else(|| bad("the record was not ended; nothing says how the run did"))?;
    let run = summary.metadata_indexes.iter().find(|index| index.name == RUN);
    let run = mcap::read::metadata(&bytes, run.ok_or_else(|| bad("not a record of eclss-rt"))?);
    let run = run.map_err(broken)?.metadata;
    if run.contains_key("watched") {
        return Err(bad(
            "a board was watched: what its plant started from is not in the record, so that there is nothing to replay",
        ));
    }
    let told = |key: &str| run.get(key).ok_or_else(|| bad(&format!("its metadata lack `{key}`")));
    let count = |key: &str| told(key)?.parse::<u64>().map_err(|_| bad(&format!("`{key}` is no number")));
    let attached = |name: &str| {
        let index = summary.attachment_indexes.iter().find(|index| index.name == name);
        let index = index.ok_or_else(|| bad(&format!("`{name}` is not attached")))?;
        mcap::read::attachment(&bytes, index).map(|part| part.data).map_err(broken)
    };
    let dropped = count("rows_dropped")?;
    if dropped > 0 {
        let text = format!("{dropped} ticks are missing from it, so that it cannot be replayed");
        return Err(bad(&text));
    }
    let source = Source::text(&attached(NETWORK)?, NETWORK, format!("{NETWORK} in {}", path.display()))?;
    let method = Method::from_name(told("method")?).ok_or_else(|| bad("no such method"))?;
    let step_us = u32::try_from(count("step_us")?).map_err(|_| bad("`step_us` is too large"))?;
    let settings = Settings { method, step_us };
    let network = source.loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator =
        buffers.simulator(&network, settings).map_err(|error| refused(&source, settings, &error))?;
    simulator.restore(&attached(START)?).map_err(|error| bad(&format!("{START}: {error}")))?;
    let live = (0..network.inputs.len()).map(|slot| simulator.live_input(slot).ok()).collect();
    let mut replay = Replay { simulator, live, inputs: Inputs::default(), steps: 0, most: count("rows")? };
    for message in MessageStream::new(&bytes).map_err(broken)? {
        let message = message.map_err(broken)?;
        if message.channel.topic == INPUTS {
            let inputs = serde_json::from_slice(&message.data).map_err(|error| bad(&error.to_string()))?;
            replay.take(inputs).map_err(|why| bad(&why))?;
        }
    }
    replay.until(count("steps")?).map_err(|why| bad(&why))?;
    Ok(Replayed {
        steps: replay.steps,
        state_hash: format!("{:016x}", replay.simulator.state_hash()),
        recorded_hash: told("state_hash")?.clone(),
    })
}
