//! What becomes of each packet that comes in, and how one goes out.

use super::super::clock::Clock;
use super::super::frame;
use super::super::message::{
    Ack, Body, CommandFrame, Hello, KeyedCommand, Outcome, Packet, Refused, RefusedReason, Role, TAG_BYTES,
    VERSION,
};
use super::super::window::{Arrival, Window};
use super::{Config, Link, Received};
use crate::mode::Refusal;

impl Link {
    pub(super) fn take(&mut self, packet: Packet, now_us: u64) {
        match packet.body {
            Body::Hello(hello) if packet.session == 0 => self.hello(hello),
            Body::Refused(refused) if packet.session == 0 => {
                self.counters.handshake = self.counters.handshake.saturating_add(1);
                if self.session.is_none() && refused.echo == self.nonce {
                    self.refused = Some(refused.reason);
                }
            }
            Body::Data(_) | Body::Command(_) | Body::Ack(_) | Body::Keyed(_)
                if self.belongs(packet.session) =>
            {
                match self.window.arrive(packet.sequence) {
                    Arrival::New { missing } => {
                        self.counters.lost = self.counters.lost.saturating_add(missing);
                        self.counters.accepted = self.counters.accepted.saturating_add(1);
                        self.quiet = 0;
                        self.accept(packet, now_us);
                    }
                    Arrival::Late => {
                        self.counters.lost = self.counters.lost.saturating_sub(1);
                        self.counters.late = self.counters.late.saturating_add(1);
                    }
                    Arrival::Ancient => self.counters.ancient = self.counters.ancient.saturating_add(1),
                    Arrival::Duplicate => self.counters.duplicate = self.counters.duplicate.saturating_add(1),
                }
            }
            _ => self.counters.foreign_session = self.counters.foreign_session.saturating_add(1),
        }
    }

    /// Whether a packet is of our session, which its arrival may begin.
    fn belongs(&mut self, session: u32) -> bool {
        if self.session.is_none() {
            let agreed = self.peer_nonce.map(|peer| self.session_with(peer));
            if agreed != Some(session) {
                return false;
            }
            self.begin_session(session);
        }
        self.session == Some(session)
    }

    fn session_with(&self, peer: u32) -> u32 {
        let (plant, controller) = match self.config.role {
            Role::Plant => (self.nonce, peer),
            Role::Controller => (peer, self.nonce),
        };
        let [a, b, c, d] = plant.to_le_bytes();
        let [e, f, g, h] = controller.to_le_bytes();
        frame::check_sum(&[a, b, c, d, e, f, g, h]).max(1)
    }

    fn hello(&mut self, hello: Hello) {
        let Config { role, network_id, process_id, step_us, inputs, outputs, .. } = self.config;
        let reason = if hello.role == role {
            Some(RefusedReason::Role)
        } else if hello.network_id != network_id {
            Some(RefusedReason::Network)
        } else if (hello.process_id, hello.inputs, hello.outputs) != (process_id, inputs, outputs) {
            Some(RefusedReason::Process)
        } else if hello.step_us != step_us {
            Some(RefusedReason::Step)
        } else {
            None
        };
        if let Some(reason) = reason {
            self.counters.foreign_id = self.counters.foreign_id.saturating_add(1);
            self.refuse = Some(Refused { reason, echo: hello.nonce });
            return;
        }
        self.counters.handshake = self.counters.handshake.saturating_add(1);
        if self.session.is_some() {
            // Until something of the session has come, the peer may not know our number: a hello is all that tells it,
            // where each end speaks only when spoken to. A peer that has spoken in the session knows our number: if
            // it greets again it has started anew with the same number of its own, and an answer would join it to
            // the old session, which must run dry first.
            self.answer = self.peer_nonce == Some(hello.nonce) && self.window == Window::default();
            return;
        }
        self.peer_nonce = Some(hello.nonce);
        if hello.echo == self.nonce {
            self.begin_session(self.session_with(hello.nonce));
        } else {
            self.answer = true;
        }
    }

    fn begin_session(&mut self, session: u32) {
        self.session = Some(session);
        self.counters.sessions = self.counters.sessions.saturating_add(1);
        self.refused = None;
        self.window = Window::default();
        self.clock = Clock::default();
        self.sequence = 0;
        self.quiet = 0;
        (self.heard, self.told) = ((0, 0, 0), 0);
        (self.last, self.todo, self.ack_out) = (None, None, None);
    }

    pub(super) fn end_session(&mut self) {
        (self.session, self.peer_nonce) = (None, None);
        self.nonce = self.nonce.wrapping_add(1).max(1);
        self.until_hello = 0;
        (self.pending, self.todo, self.ack_out) = (None, None, None);
    }

    pub(super) fn accept(&mut self, packet: Packet, now_us: u64) {
        self.heard = (packet.sequence, packet.time_us, now_us);
        match packet.body {
            Body::Data(data) => {
                self.told = data.echo.sequence;
                if data.echo.sequence != 0 {
                    self.clock.exchange(data.echo.time_us, packet.time_us, data.echo.age_us, now_us);
                }
                // A frame without an echo was made without any knowledge of this end, so that its age is not known.
                let answers = data.echo.sequence != 0 || self.config.stale_us == u64::MAX;
                if !answers || now_us.saturating_sub(data.echo.time_us) > self.config.stale_us {
                    self.counters.stale = self.counters.stale.saturating_add(1);
                    return;
                }
                let Packet { tick, sequence, time_us, .. } = packet;
                self.received = Received { data, tick, sequence, time_us, arrived_us: now_us };
                self.fresh = true;
                self.silence = 0;
            }
            Body::Command(frame) => self.commanded(frame, None, packet.sequence),
            Body::Keyed(KeyedCommand { frame, tag }) => self.commanded(frame, Some(&tag), packet.sequence),
            Body::Ack(ack) => {
                if self.pending.is_some_and(|pending| pending.frame.id == ack.id) {
                    self.pending = None;
                    self.ack_in = Some(ack);
                }
            }
            // Told apart before.
            Body::Hello(_) | Body::Refused(_) => {}
        }
    }

    /// Takes a command, unless this end has a key and the tag does not prove that the sender has it.
    fn commanded(&mut self, frame: CommandFrame, tag: Option<&[u8; TAG_BYTES]>, sequence: u32) {
        if self.is_proven(&frame, tag, sequence) {
            match self.last {
                Some((id, done)) if id == frame.id => {
                    self.ack_out = done.map(|outcome| Ack { id, outcome }).or(self.ack_out);
                }
                Some((_, None)) => self.ack_out = Some(Ack { id: frame.id, outcome: Outcome::Busy }),
                _ => {
                    self.last = Some((frame.id, None));
                    self.todo = Some(frame);
                }
            }
        } else {
            self.counters.unproven = self.counters.unproven.saturating_add(1);
            self.ack_out = Some(Ack { id: frame.id, outcome: Outcome::Refused(Refusal::Key) });
        }
    }

    #[cfg(feature = "keyed")]
    fn is_proven(&self, frame: &CommandFrame, tag: Option<&[u8; TAG_BYTES]>, sequence: u32) -> bool {
        let Some(key) = self.key else { return true };
        tag.is_some_and(|tag| key.verifies(self.nonces(), sequence, frame, tag))
    }

    #[cfg(not(feature = "keyed"))]
    fn is_proven(&self, _frame: &CommandFrame, _tag: Option<&[u8; TAG_BYTES]>, _sequence: u32) -> bool {
        true
    }

    /// A command as the next packet carries it.
    pub(super) fn command_body(&self, frame: CommandFrame) -> Body {
        #[cfg(feature = "keyed")]
        if let Some(key) = self.key {
            let tag = key.sign(self.nonces(), self.sequence.wrapping_add(1), &frame);
            return Body::Keyed(KeyedCommand { frame, tag });
        }
        Body::Command(frame)
    }

    /// Both nonces of the session, the plant's first.
    #[cfg(feature = "keyed")]
    fn nonces(&self) -> [u32; 2] {
        let peer = self.peer_nonce.unwrap_or(0);
        match self.config.role {
            Role::Plant => [self.nonce, peer],
            Role::Controller => [peer, self.nonce],
        }
    }

    /// Sends what belongs to the handshake.
    pub(super) fn greet(&mut self, tick: u64, now_us: u64) {
        if let Some(refused) = self.refuse.take() {
            self.send_as(0, 0, tick, now_us, Body::Refused(refused));
        }
        let due = self.session.is_none() && self.until_hello == 0;
        self.until_hello = if due { self.config.hello_ticks } else { self.until_hello.saturating_sub(1) };
        if core::mem::take(&mut self.answer) || due {
            let Config { role, network_id, process_id, step_us, inputs, outputs, .. } = self.config;
            let (nonce, echo) = (self.nonce, self.peer_nonce.unwrap_or(0));
            let hello = Hello { role, network_id, process_id, step_us, inputs, outputs, nonce, echo };
            self.send_as(0, 0, tick, now_us, Body::Hello(hello));
        }
    }

    pub(super) fn send(&mut self, tick: u64, now_us: u64, body: Body) {
        let Some(session) = self.session else { return };
        let sequence = self.sequence.wrapping_add(1);
        if self.send_as(session, sequence, tick, now_us, body) {
            self.sequence = sequence;
        }
    }

    fn send_as(&mut self, session: u32, sequence: u32, tick: u64, now_us: u64, body: Body) -> bool {
        let packet = Packet { version: VERSION, session, sequence, tick, time_us: now_us, body };
        if self.out_start > 0 {
            self.out.copy_within(self.out_start..self.out_end, 0);
            self.out_end -= self.out_start;
            self.out_start = 0;
        }
        let length = self.out.get_mut(self.out_end..).and_then(|room| frame::encode(&packet, room));
        match length {
            Some(length) => self.out_end += length,
            None => self.counters.unsent = self.counters.unsent.saturating_add(1),
        }
        length.is_some()
    }
}
