//! One end of the wire: handshake, sessions, newest data, commands and their answers.
//!
//! Each end sends hellos with a number of its own (*nonce*) and the number that it heard from the peer. An end that
//! hears its own number back, or a packet of the session that both numbers make, is connected. A session that is
//! silent for too long is over, and the next one has new numbers: no packet of an old session is ever taken.

mod packets;

use super::clock::Clock;
use super::counters::Counters;
use super::frame::{FRAME_BYTES, Framer, data_bytes};
#[cfg(feature = "keyed")]
use super::key::Key;
use super::message::{Ack, Body, Command, CommandFrame, Data, Echo, Outcome, Refused, RefusedReason, Role};
use super::window::Window;
use crate::mode::Mode;

/// Room for what has not been sent yet \[bytes\].
pub const OUTGOING_BYTES: usize = 2 * FRAME_BYTES;

/// What both ends must agree on, and this end's patience.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Config {
    /// Which end this is.
    pub role: Role,
    /// Id of the network.
    pub network_id: u64,
    /// Id of the process image.
    pub process_id: u64,
    /// The plant's step \[µs\].
    pub step_us: u32,
    /// Values from controller to plant, at most [`crate::process::CHANNELS`].
    pub inputs: u16,
    /// Values from plant to controller, at most [`crate::process::CHANNELS`].
    pub outputs: u16,
    /// Ticks between hellos.
    pub hello_ticks: u32,
    /// Ticks without a packet after which a session is over.
    pub silent_ticks: u32,
    /// Ticks after which a command that was not answered is sent again.
    pub resend_ticks: u32,
    /// Age beyond which data are not used: time since this end sent the newest packet that they echo \[µs\].
    pub stale_us: u64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            role: Role::Plant,
            network_id: 0,
            process_id: 0,
            step_us: 1_000,
            inputs: 0,
            outputs: 0,
            hello_ticks: 20,
            silent_ticks: 200,
            resend_ticks: 20,
            stale_us: u64::MAX,
        }
    }
}

/// What goes out in a tick.
#[derive(Debug, Clone, Copy)]
pub struct Outgoing<'a> {
    /// Mode of this end.
    pub mode: Mode,
    /// Why it is SAFE, as a number.
    pub cause: u8,
    /// Values for the peer; those beyond [`crate::process::CHANNELS`] are not sent.
    pub values: &'a [f32],
    /// Quality of each value; empty where all are good.
    pub quality: &'a [u8],
    /// Quality of each of the peer's values.
    pub seen: &'a [u8],
}

impl Default for Outgoing<'_> {
    fn default() -> Self {
        Self { mode: Mode::PowerUp, cause: 0, values: &[], quality: &[], seen: &[] }
    }
}

/// The newest process data of the peer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Received {
    /// The data.
    pub data: Data,
    /// The peer's tick.
    pub tick: u64,
    /// Sequence number of its packet.
    pub sequence: u32,
    /// The peer's clock when it was sent \[µs\].
    pub time_us: u64,
    /// Our clock when it came \[µs\].
    pub arrived_us: u64,
}

/// A command of ours on its way.
#[derive(Debug, Clone, Copy)]
struct Pending {
    frame: CommandFrame,
    /// Ticks until it is sent (again).
    wait: u32,
}

/// One end of the wire.
#[derive(Debug, Clone)]
pub struct Link {
    config: Config,
    nonce: u32,
    peer_nonce: Option<u32>,
    session: Option<u32>,
    refused: Option<RefusedReason>,
    framer: Framer,
    window: Window,
    counters: Counters,
    clock: Clock,
    received: Received,
    fresh: bool,
    /// Newest packet of the session, of whatever kind: sequence number, the peer's clock and ours \[µs\].
    heard: (u32, u64, u64),
    /// The newest packet of ours of which the peer has told.
    told: u32,
    /// Ticks since the newest data.
    silence: u32,
    /// Ticks since the newest packet of the session.
    quiet: u32,
    until_hello: u32,
    answer: bool,
    refuse: Option<Refused>,
    sequence: u32,
    /// The command that the peer gave last, and what became of it.
    last: Option<(u32, Option<Outcome>)>,
    todo: Option<CommandFrame>,
    ack_out: Option<Ack>,
    next_command: u32,
    pending: Option<Pending>,
    ack_in: Option<Ack>,
    #[cfg(feature = "keyed")]
    key: Option<Key>,
    out: [u8; OUTGOING_BYTES],
    out_start: usize,
    out_end: usize,
}

impl Link {
    /// Makes an end that knows of no peer. `nonce` should be another one at every start, as from a clock or a noise
    /// source, so that packets from before are told apart.
    pub fn new(config: Config, nonce: u32) -> Self {
        Self {
            config,
            nonce: nonce.max(1),
            peer_nonce: None,
            session: None,
            refused: None,
            framer: Framer::new(),
            window: Window::default(),
            counters: Counters::default(),
            clock: Clock::default(),
            received: Received::default(),
            fresh: false,
            heard: (0, 0, 0),
            told: 0,
            silence: u32::MAX,
            quiet: 0,
            until_hello: 0,
            answer: false,
            refuse: None,
            sequence: 0,
            last: None,
            todo: None,
            ack_out: None,
            next_command: 0,
            pending: None,
            ack_in: None,
            #[cfg(feature = "keyed")]
            key: None,
            out: [0; OUTGOING_BYTES],
            out_start: 0,
            out_end: 0,
        }
    }

    /// Signs its commands with `key` from now on, and does no command of the peer that is not signed with it.
    #[cfg(feature = "keyed")]
    #[must_use]
    pub fn with_key(self, key: Option<Key>) -> Self {
        Self { key, ..self }
    }

    /// Takes bytes that came in, at `now_us` on this end's clock.
    pub fn feed(&mut self, bytes: &[u8], now_us: u64) {
        for byte in bytes {
            match self.framer.push(*byte) {
                Some(Ok(packet)) => self.take(packet, now_us),
                Some(Err(bad)) => self.counters.bad(bad),
                None => {}
            }
        }
    }

    /// Whether there is a session.
    pub fn is_connected(&self) -> bool {
        self.session.is_some()
    }

    /// Bytes of the peer that this end must be able to take in a tick so as to keep step with it: two of its longest
    /// frames of process data. Who takes fewer falls behind, and finds ever older values.
    pub fn bytes_a_tick(&self) -> usize {
        let Config { role, inputs, outputs, .. } = self.config;
        let (inputs, outputs) = (usize::from(inputs), usize::from(outputs));
        2 * match role {
            Role::Plant => data_bytes(inputs, outputs),
            Role::Controller => data_bytes(outputs, inputs),
        }
    }

    /// Why the peer refused the latest hello, if it did.
    pub fn refused(&self) -> Option<RefusedReason> {
        self.refused
    }

    /// Ticks since data came, seen after this tick's bytes were fed: 0 where some came in this tick.
    pub fn silence_ticks(&self) -> u32 {
        self.silence
    }

    /// The newest data that came since the last call; `None` where none did.
    pub fn take_data(&mut self) -> Option<&Data> {
        core::mem::take(&mut self.fresh).then_some(&self.received.data)
    }

    /// The newest data that ever came, with their stamps.
    pub fn newest(&self) -> &Received {
        &self.received
    }

    /// The next command of the peer, to be answered by [`Self::acknowledge`].
    pub fn take_command(&mut self) -> Option<CommandFrame> {
        self.todo.take()
    }

    /// Answers a command.
    pub fn acknowledge(&mut self, id: u32, outcome: Outcome) {
        if self.last.is_some_and(|(last, _)| last == id) {
            self.last = Some((id, Some(outcome)));
            self.ack_out = Some(Ack { id, outcome });
        }
    }

    /// Gives the peer a command. Returns its number; `None` without a session, or while one is still on its way.
    pub fn command(&mut self, command: Command) -> Option<u32> {
        if self.session.is_none() || self.pending.is_some() {
            return None;
        }
        self.next_command = self.next_command.wrapping_add(1);
        let id = self.next_command;
        self.pending = Some(Pending { frame: CommandFrame { id, command }, wait: 0 });
        Some(id)
    }

    /// The answer to a command, once. A session that ends takes its command with it, done or not.
    pub fn take_ack(&mut self) -> Option<Ack> {
        self.ack_in.take()
    }

    /// Whether a command is on its way.
    pub fn is_commanding(&self) -> bool {
        self.pending.is_some()
    }

    /// Frames by what became of them.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The peer's clock, as far as this session knows it: a peer that started anew has another one.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Packets sent in this session.
    pub fn sent_packets(&self) -> u32 {
        self.sequence
    }

    /// Packets of this session that the peer has not said to have got. What is sent faster than it is taken only grows
    /// old in a queue: where this is more than a few, [`Self::send_quiet_tick`] is better.
    pub fn under_way(&self) -> u32 {
        self.sequence.wrapping_sub(self.told)
    }

    /// Ends a tick: whatever has to be said in it goes to [`Self::outgoing`].
    pub fn send_tick(&mut self, tick: u64, now_us: u64, outgoing: &Outgoing<'_>) {
        self.send_quiet_tick(tick, now_us);
        if self.session.is_some() {
            self.send_data(tick, now_us, outgoing);
        }
    }

    /// Ends a tick without process data.
    pub fn send_quiet_tick(&mut self, tick: u64, now_us: u64) {
        self.silence = self.silence.saturating_add(1);
        self.quiet = self.quiet.saturating_add(1);
        if self.session.is_some() && self.quiet > self.config.silent_ticks {
            self.end_session();
        }
        self.greet(tick, now_us);
        if self.session.is_none() {
            return;
        }
        if let Some(ack) = self.ack_out.take() {
            self.send(tick, now_us, Body::Ack(ack));
        }
        if let Some(pending) = &mut self.pending {
            let due = pending.wait == 0;
            pending.wait = if due { self.config.resend_ticks } else { pending.wait }.saturating_sub(1);
            let frame = pending.frame;
            if due {
                let body = self.command_body(frame);
                self.send(tick, now_us, body);
            }
        }
    }

    fn send_data(&mut self, tick: u64, now_us: u64, outgoing: &Outgoing<'_>) {
        let (sequence, time_us, arrived_us) = self.heard;
        let age_us = u32::try_from(now_us.saturating_sub(arrived_us)).unwrap_or(u32::MAX);
        let mut data = Data {
            mode: outgoing.mode,
            cause: outgoing.cause,
            echo: Echo { sequence, time_us, age_us },
            ..Data::default()
        };
        data.values.extend(outgoing.values.iter().copied().take(data.values.capacity()));
        data.quality.extend(outgoing.quality.iter().copied().take(data.quality.capacity()));
        data.seen.extend(outgoing.seen.iter().copied().take(data.seen.capacity()));
        self.send(tick, now_us, Body::Data(data));
    }

    /// Whole frames that have to be sent.
    pub fn outgoing(&self) -> &[u8] {
        self.out.get(self.out_start..self.out_end).unwrap_or(&[])
    }

    /// Takes note that the first `bytes` of [`Self::outgoing`] are on their way.
    pub fn sent(&mut self, bytes: usize) {
        self.out_start = self.out_start.saturating_add(bytes).min(self.out_end);
        if self.out_start == self.out_end {
            (self.out_start, self.out_end) = (0, 0);
        }
    }
}

#[cfg(test)]
mod tests;
