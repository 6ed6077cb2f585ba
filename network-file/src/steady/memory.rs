//! What elements with a memory stand at when nothing changes any more.
//!
//! Flows and pressures are solved with every memory held, and then each is asked where it would go. One that switches
//! does so; one that follows a pressure (an opening between 0 and 1 that the pressure it causes brings back) is
//! bracketed: where it would open it is too small, where it would close too large.

use eclss_core::{Element, Operating};
use eclss_core::{Line, Network, Responsive};

use super::SteadyError;

/// Most times that anything switches.
const SWITCHES: u32 = 12;
/// Most rounds of the search.
const ROUNDS: u32 = 400;
/// How closely an opening is what it would go to [1].
const CLOSE: f32 = 1e-6;
/// Width at which a bracket is an answer, as part of its upper end: two units in the last place.
const NARROW: f32 = 2.0 * f32::EPSILON;
/// By how much a bracket is widened at first when the answer has left it [1].
const REACH: f32 = 1e-5;
/// Rounds for which an end of a bracket counts as seen: what else moved since then may have moved the answer.
const SEEN: u32 = 3;

/// Where an opening's rest lies: ends, and the rounds in which they were seen.
#[derive(Debug, Clone, Copy)]
struct Bracket {
    low: f32,
    high: f32,
    low_seen: u32,
    high_seen: u32,
    /// By how much it is widened when the answer has left it.
    reach: f32,
}

impl Bracket {
    const WHOLE: Self = Self { low: 0.0, high: 1.0, low_seen: 0, high_seen: 0, reach: REACH };

    /// Takes in that `value` would go to `wanted`; returns the next value to look at, `None` where it may stay.
    fn next(&mut self, round: u32, value: f32, wanted: f32) -> Option<f32> {
        if (wanted - value).abs() <= CLOSE {
            return None;
        }
        if wanted > value {
            (self.low, self.low_seen) = (value, round);
            if value >= self.high {
                (self.high, self.reach) = (f32::min(value + self.reach, 1.0), 2.0 * self.reach);
                return Some(self.high);
            }
        } else {
            (self.high, self.high_seen) = (value, round);
            if value <= self.low {
                (self.low, self.reach) = (f32::max(value - self.reach, 0.0), 2.0 * self.reach);
                return Some(self.low);
            }
        }
        if self.high - self.low > NARROW * self.high {
            return Some(f32::midpoint(self.low, self.high));
        }
        let seen = |end: u32| round - end <= SEEN;
        match (seen(self.low_seen), seen(self.high_seen)) {
            (true, true) => None,
            (false, _) => Some(self.low),
            (_, false) => Some(self.high),
        }
    }
}

/// All memories, and the brackets of those that follow a pressure.
#[derive(Debug)]
pub(super) struct Memories {
    pub(super) values: Vec<f32>,
    brackets: Vec<Bracket>,
    switches: u32,
    rounds: u32,
}

impl Memories {
    /// Everything closed.
    pub(super) fn new<E: Element>(network: &Network<'_, E>) -> Self {
        let slots = network.memory_slots();
        Self { values: vec![0.0; slots], brackets: vec![Bracket::WHOLE; slots], switches: 0, rounds: 0 }
    }

    /// Lets every memory look at the solution that `at` gives for a line: its flow and the pressures at both ends of
    /// its elements. Returns whether all stand where they would go, else moves them.
    pub(super) fn agree<E: Element>(
        &mut self,
        network: &Network<'_, E>,
        inputs: &[f32],
        at: impl Fn(&Responsive, &Line) -> (f64, Vec<[f64; 2]>),
    ) -> Result<bool, SteadyError> {
        let (mut switched, mut off) = (Vec::new(), Vec::new());
        for entry in network.responsive {
            let Some(line) = network.lines.get(entry.line as usize) else { continue };
            let segments = network.segments_of(line);
            if segments.iter().all(|segment| segment.element.memory() == 0) {
                continue;
            }
            let (w, ends) = at(entry, line);
            let mut slot = entry.first_memory as usize;
            for ((segment, index), [inlet_pa, outlet_pa]) in
                segments.iter().zip(line.first_segment..).zip(ends)
            {
                let slots = slot..slot + segment.element.memory();
                slot = slots.end;
                let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
                let at = Operating {
                    inlet_pa: inlet_pa as f32,
                    outlet_pa: outlet_pa as f32,
                    ..Operating::plain(inputs, w as f32)
                };
                let mut wanted = self.values[slots.clone()].to_vec();
                segment.element.advance(&at, f32::INFINITY, &mut wanted);
                if segment.element.settles() {
                    let followed = slots.zip(&wanted).filter(|(slot, wanted)| self.follow(*slot, **wanted));
                    off.extend(followed.map(|_| index));
                } else if self.values[slots.clone()] != wanted[..] {
                    self.values[slots].copy_from_slice(&wanted);
                    switched.push(index);
                }
            }
        }
        self.switches += u32::from(!switched.is_empty());
        self.rounds += 1;
        if self.switches > SWITCHES {
            return Err(SteadyError::Switching { segments: switched });
        }
        if self.rounds > ROUNDS && !off.is_empty() {
            return Err(SteadyError::Switching { segments: off });
        }
        Ok(switched.is_empty() && off.is_empty())
    }

    /// Moves one opening towards what it would go to; false where it stays.
    fn follow(&mut self, slot: usize, wanted: f32) -> bool {
        let next = self.brackets[slot].next(self.rounds, self.values[slot], wanted);
        if let Some(next) = next {
            self.values[slot] = next;
        }
        next.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_opening_is_bracketed_to_its_rest() {
        // Stiff loops: each would go where a hundred or a million times its own opening is not.
        for (gain, rest) in [(100.0, 0.37), (1e6, 0.37), (1e6, 0.5), (3.0, 0.999), (1e6, 1.0), (1e6, 0.0)] {
            let mut memories =
                Memories { values: vec![0.0], brackets: vec![Bracket::WHOLE], switches: 0, rounds: 0 };
            let wanted = |value: f32| (rest + gain * (rest - value)).clamp(0.0, 1.0);
            while memories.follow(0, wanted(memories.values[0])) {
                memories.rounds += 1;
                assert!(memories.rounds < 120, "{gain}, {rest}: {memories:?}");
            }
            assert!((memories.values[0] - rest).abs() <= 1e-6, "{gain}, {rest}: {memories:?}");
        }
    }

    #[test]
    fn an_answer_that_moves_is_followed() {
        let mut memories =
            Memories { values: vec![0.0], brackets: vec![Bracket::WHOLE], switches: 0, rounds: 0 };
        let wanted = |value: f32, rest: f32| (rest + 1e4 * (rest - value)).clamp(0.0, 1.0);
        for rest in [0.2, 0.7, 0.1] {
            for _ in 0..120 {
                memories.follow(0, wanted(memories.values[0], rest));
                memories.rounds += 1;
            }
            assert!((memories.values[0] - rest).abs() <= 1e-6, "{rest}: {memories:?}");
        }
    }
}
