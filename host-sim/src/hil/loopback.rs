//! In→out delay by loopback: a tester at the other end of the link sends samples through a channel that does nothing but
//! pass, and times their way.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::key::fresh_nonce;
use eclss_core::Output;
use eclss_core::mode::{Mode, Refusal, Request};
use eclss_core::process::{Hold, Image, InputChannel, OutputChannel, Port, Scaling};
use eclss_core::protocol::{Command, Config, Key, Link as Session, Outcome, Outgoing};
use eclss_network_file::ProcessTables;
use eclss_target::loopback::Loopback;
use eclss_target::wire::Link;
use serde::Serialize;

use super::pace::wall_ns;
use super::timing::{Summary, Times};

/// Part of the channel's range within which samples lie, so that the plant hardly notices.
const SWING: f32 = 0.01;
/// How often the tester looks.
const LOOK: Duration = Duration::from_micros(100);
/// Ticks without data after which the tester speaks unasked.
const UNASKED_TICKS: u64 = 5;

/// What the loopback leads through.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// The channel's name.
    pub name: String,
    /// Its number among the inputs.
    channel: usize,
    /// The same among those that come over the link.
    input: usize,
    /// The added output among those that go over the link.
    output: usize,
    low: f32,
    high: f32,
    /// Raw values of all inputs over the link.
    values: Vec<f32>,
}

/// What came out.
#[derive(Debug, Clone, Serialize)]
pub struct LoopbackFigures {
    /// The channel that the samples went through.
    pub channel: String,
    /// From reading a sample to giving out what it became, by the plant's clock.
    pub in_out: Summary,
    /// Largest minus smallest of them [µs].
    pub jitter_us: f64,
    /// The same in ticks: smallest and largest.
    pub ticks: [u32; 2],
    /// From the tester's sending to its receiving, with wire, waiting for the tick, and the tester's own delay.
    pub end_to_end: Summary,
    /// Samples given up because a frame was missing or the plant left RUN.
    pub discarded: u32,
}

impl Probe {
    /// Looks for an input over the link; `plant` are the values that the plant's inputs have.
    pub fn new(tables: &ProcessTables, plant: &[f32]) -> Result<Self, &'static str> {
        let inputs = tables.input_channels();
        let over_link = |port: Port| port == Port::Link;
        let channel = inputs.iter().position(|channel| over_link(channel.port));
        let channel = channel.ok_or("no input of this network comes over the link")?;
        if tables.outputs.len() >= eclss_core::process::CHANNELS {
            return Err("there is no room for another output");
        }
        let value = |channel: &InputChannel<'_>| {
            let value = plant.get(channel.slot as usize).copied().unwrap_or(channel.safe_value);
            value.clamp(channel.min, channel.max)
        };
        let Some(probed) = inputs.get(channel) else { return Err("no input") };
        let (low, swing) = (value(probed), SWING * (probed.max - probed.min));
        let high = if low > 0.5 * (probed.min + probed.max) { low - swing } else { low + swing };
        let linked = inputs.iter().filter(|channel| over_link(channel.port));
        Ok(Self {
            name: tables.inputs[channel].name.clone(),
            channel,
            input: inputs.iter().take(channel).filter(|channel| over_link(channel.port)).count(),
            output: tables.output_channels().iter().filter(|channel| over_link(channel.port)).count(),
            low,
            high,
            values: linked.map(|channel| channel.scaling.to_raw(value(channel))).collect(),
        })
    }

    /// Lends the process image with the channel that only passes on, and the output that brings it back.
    pub fn with_image<T>(&self, tables: &ProcessTables, take: impl FnOnce(Image<'_>) -> T) -> T {
        let (mut inputs, mut outputs) = (tables.input_channels(), tables.output_channels());
        if let Some(input) = inputs.get_mut(self.channel) {
            *input = InputChannel {
                scaling: Scaling::NONE,
                max_rate_per_s: f32::INFINITY,
                filter_s: 0.0,
                hold: Hold::Zero,
                safe_rate_per_s: f32::INFINITY,
                ..*input
            };
            outputs.push(OutputChannel {
                signal: Output::Input.of(input.slot as usize),
                port: Port::Link,
                scaling: Scaling::NONE,
                min: input.min,
                max: input.max,
                max_rate_per_s: f32::INFINITY,
                safe_value: input.safe_value,
                safe_rate_per_s: f32::INFINITY,
            });
        }
        let (order, safe_after_ticks, rest) = (tables.order, tables.safe_after_ticks, tables.rest);
        take(Image { inputs: &inputs, outputs: &outputs, order, safe_after_ticks, rest })
    }

    /// Tests over `link` until `ends`; arms the plant, and again after every SAFE.
    pub fn test(
        mut self,
        mut link: Link,
        config: Config,
        key: Option<Key>,
        ends: &AtomicBool,
    ) -> LoopbackFigures {
        let begun_ns = wall_ns();
        let mut session = Session::new(config, fresh_nonce()).with_key(key);
        let mut loopback = Loopback::new(self.output, self.low, self.high);
        let (mut in_out, mut end_to_end, mut ticks) = (Times::new(), Times::new(), [u32::MAX, 0]);
        let (mut mode, mut restart, mut sent_ns, mut tick, mut unasked_us) = (Mode::PowerUp, false, 0, 0, 0);
        let mut bytes = [0; 2_048];
        while !ends.load(Ordering::Acquire) {
            let now_us = (wall_ns() - begun_ns) / 1_000;
            let mut asked = false;
            loop {
                let length = link.read(&mut bytes);
                if length == 0 {
                    break;
                }
                // Frame by frame, because every packet counts.
                for frame in bytes[..length].split_inclusive(|byte| *byte == 0) {
                    session.feed(frame, now_us);
                    if session.take_data().is_none() {
                        continue;
                    }
                    asked = true;
                    mode = session.newest().data.mode;
                    if let Some(passed) = loopback.came(session.newest()) {
                        in_out.add(u64::from(passed.us) * 1_000);
                        end_to_end.add(wall_ns().saturating_sub(sent_ns));
                        ticks = [ticks[0].min(passed.ticks), ticks[1].max(passed.ticks)];
                    }
                }
            }
            if let Some(ack) = session.take_ack() {
                restart = ack.outcome == Outcome::Refused(Refusal::Plant);
            }
            if asked || now_us >= unasked_us {
                unasked_us = now_us + UNASKED_TICKS * u64::from(config.step_us);
                let request = match mode {
                    Mode::Ready => Some(Request::Arm),
                    Mode::Safe if restart => Some(Request::Restart),
                    Mode::Safe => Some(Request::Acknowledge),
                    _ => None,
                };
                if let Some(request) = request.filter(|_| !session.is_commanding()) {
                    session.command(Command::Mode(request));
                }
                if let Some(value) = self.values.get_mut(self.input) {
                    *value = loopback.sample();
                }
                let outgoing = Outgoing { mode: Mode::Run, values: &self.values, ..Outgoing::default() };
                session.send_tick(tick, now_us, &outgoing);
                tick += 1;
                if session.is_connected() && mode == Mode::Run && loopback.is_fresh() {
                    sent_ns = wall_ns();
                    loopback.sent(session.sent_packets());
                }
            }
            let taken = link.write(session.outgoing());
            session.sent(taken);
            std::thread::sleep(LOOK);
        }
        let in_out = in_out.summary();
        LoopbackFigures {
            channel: self.name,
            jitter_us: in_out.max_us - in_out.min_us,
            in_out,
            ticks: if in_out.count == 0 { [0; 2] } else { ticks },
            end_to_end: end_to_end.summary(),
            discarded: loopback.discarded(),
        }
    }
}
