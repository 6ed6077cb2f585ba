//! How long a plant takes from reading an input to giving out what follows from it, measured from the other end of its
//! link.
//!
//! Samples that differ go to an input channel, and an output channel of the same slot brings them back. A data packet
//! says which of our packets had come when it was written and how long before (its echo), and when it was written. A
//! sample was read at the stamp less the age of the first packet that echoes it, and given out at the stamp of the first
//! that carries it: both on the plant's clock, so that neither the wire nor our own punctuality is part of it.

use eclss_core::mode::Mode;
use eclss_core::protocol::Received;

/// Steps from one end to the other: samples go up and down, so that none is a jump.
const CODES: u16 = 97;

/// How long one sample took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passed {
    /// From reading to giving out \[µs of the plant's clock\].
    pub us: u32,
    /// The same in the plant's ticks: 0 when it was given out in the tick that read it.
    pub ticks: u32,
}

/// Where the present sample is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Not sent yet.
    Fresh,
    /// In this packet and in all later ones.
    Sent { sequence: u32 },
    /// Read by the plant at this time of its clock, in this tick.
    Read { at_us: u64, tick: u64 },
}

/// Sends one sample after the other and times each.
#[derive(Clone, Copy, Debug)]
pub struct Loopback {
    output: usize,
    low: f32,
    high: f32,
    code: u16,
    stage: Stage,
    /// The newest packet that was looked at.
    newest: u32,
    /// Whether the plant was in RUN in the newest packet.
    runs: bool,
    discarded: u32,
}

impl Loopback {
    /// Times samples from `low` to `high` that come back as value `output` of the plant's data.
    pub fn new(output: usize, low: f32, high: f32) -> Self {
        // Not `low`, which the plant may have from before.
        Self { output, low, high, code: 1, stage: Stage::Fresh, newest: 0, runs: false, discarded: 0 }
    }

    /// The sample that belongs into every packet now.
    pub fn sample(&self) -> f32 {
        let step = if self.code > CODES { 2 * CODES - self.code } else { self.code };
        self.low + (self.high - self.low) * (f32::from(step) / f32::from(CODES))
    }

    /// Whether the sample has not been sent yet.
    pub fn is_fresh(&self) -> bool {
        self.stage == Stage::Fresh
    }

    /// Takes note that packet `sequence` carries the sample.
    pub fn sent(&mut self, sequence: u32) {
        if self.stage == Stage::Fresh {
            self.stage = Stage::Sent { sequence };
        }
    }

    /// Takes the plant's data, every packet once and in order; returns what the sample took when it has come back.
    pub fn came(&mut self, received: &Received) -> Option<Passed> {
        let gap = self.newest != 0 && received.sequence != self.newest.wrapping_add(1);
        self.newest = received.sequence;
        if received.data.mode != Mode::Run {
            // The plant does not see its inputs.
            self.stage = Stage::Fresh;
            self.runs = false;
            return None;
        }
        if !core::mem::replace(&mut self.runs, true) {
            // What was sent before must not be taken for what is sent from now on.
            self.next();
            return None;
        }
        if gap && self.stage != Stage::Fresh {
            // What was in the packet between is not known: not this sample.
            self.discarded = self.discarded.saturating_add(1);
            self.next();
            return None;
        }
        let echo = received.data.echo;
        if let Stage::Sent { sequence } = self.stage
            && echo.sequence.wrapping_sub(sequence) < 1 << 31
        {
            let at_us = received.time_us.saturating_sub(echo.age_us.into());
            self.stage = Stage::Read { at_us, tick: received.tick };
        }
        let is_here = received
            .data
            .values
            .get(self.output)
            .is_some_and(|value| value.to_bits() == self.sample().to_bits());
        let Stage::Read { at_us, tick } = self.stage else {
            if is_here {
                // The plant has had it from before: it would tell nothing.
                self.next();
            }
            return None;
        };
        if !is_here {
            return None;
        }
        self.next();
        let short = |long: u64| u32::try_from(long).unwrap_or(u32::MAX);
        Some(Passed {
            us: short(received.time_us.saturating_sub(at_us)),
            ticks: short(received.tick.saturating_sub(tick)),
        })
    }

    /// Samples that were given up because a packet was lost or carried something else.
    pub fn discarded(&self) -> u32 {
        self.discarded
    }

    fn next(&mut self) {
        self.code = (self.code + 1) % (2 * CODES);
        self.stage = Stage::Fresh;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::protocol::{Data, Echo};

    fn packet(sequence: u32, tick: u64, time_us: u64, echo: Echo, value: f32) -> Received {
        let mut data = Data { mode: Mode::Run, echo, ..Data::default() };
        data.values.push(value).expect("there is room");
        Received { data, tick, sequence, time_us, arrived_us: 0 }
    }

    /// In RUN, with nothing sent yet.
    fn running() -> Loopback {
        let mut loopback = Loopback::new(0, 0.5, 0.6);
        assert_eq!(loopback.came(&packet(1, 0, 0, Echo::default(), 0.0)), None);
        loopback
    }

    #[test]
    fn a_sample_is_timed_from_its_echo_to_its_return() {
        let mut loopback = running();
        let sample = loopback.sample();
        loopback.sent(7);
        loopback.sent(8);
        let echo = |sequence, age_us| Echo { sequence, time_us: 0, age_us };
        assert_eq!(loopback.came(&packet(2, 10, 10_000, echo(6, 0), 0.0)), None);
        assert_eq!(loopback.came(&packet(3, 11, 11_030, echo(8, 30), 0.0)), None);
        let back = loopback.came(&packet(4, 12, 12_000, echo(8, 1_000), sample));
        assert_eq!(back, Some(Passed { us: 1_000, ticks: 1 }));
        let next = loopback.sample();
        assert!(next.to_bits() != sample.to_bits());
        loopback.sent(9);
        let back = loopback.came(&packet(5, 13, 13_400, echo(9, 390), next));
        assert_eq!(back, Some(Passed { us: 390, ticks: 0 }));
    }

    #[test]
    fn a_sample_that_the_plant_has_already_is_not_timed() {
        let mut loopback = running();
        let sample = loopback.sample();
        loopback.sent(1);
        assert_eq!(loopback.came(&packet(2, 1, 1_000, Echo::default(), sample)), None);
        assert!(loopback.is_fresh() && loopback.sample().to_bits() != sample.to_bits());
    }

    #[test]
    fn a_lost_packet_gives_the_sample_up() {
        let mut loopback = running();
        loopback.sent(1);
        let echo = Echo { sequence: 1, time_us: 0, age_us: 0 };
        assert_eq!(loopback.came(&packet(2, 1, 1_000, Echo::default(), 0.0)), None);
        assert_eq!(loopback.came(&packet(4, 3, 3_000, echo, loopback.sample())), None);
        assert_eq!(loopback.discarded(), 1);
    }

    #[test]
    fn samples_lie_within_their_ends_and_differ() {
        let mut loopback = Loopback::new(0, 1.0, 0.99);
        let mut last = f32::NAN;
        for _ in 0..5 * CODES {
            let sample = loopback.sample();
            assert!((0.99..=1.0).contains(&sample) && sample.to_bits() != last.to_bits());
            last = sample;
            loopback.next();
        }
    }
}
