//! What the loop steps.

use eclss_core::Signal;
use eclss_core::process::Applied;

/// A simulated plant: inputs in, one fixed step, signals out.
pub trait Plant {
    /// Goes back to the start.
    fn restart(&mut self);
    /// Hands over what an input gets in the coming step. `channel` is the input channel's number, always with the same
    /// `slot`. A value that the plant cannot take leaves what it has.
    fn apply(&mut self, channel: usize, slot: u32, applied: Applied);
    /// Sets an input for good, as an operator does; false where the slot takes no value or not this one.
    fn set(&mut self, slot: u32, value: f32) -> bool;
    /// What the input has; `None` where there is no such slot.
    fn input(&self, slot: u32) -> Option<f32>;
    /// Value of a signal, in its unit.
    fn signal(&self, signal: Signal) -> f32;
    /// Advances by one tick. The number of operations does not depend on the values.
    fn step(&mut self) -> Result<(), Untrusted>;
    /// The first flows, for who watches.
    fn outputs(&self) -> &[f32];
    /// A hash over the whole state. Too slow for a tick: asked for when a run has ended.
    fn state_hash(&self) -> u64;
    /// The same over the integrated values alone, without what identifies network and run.
    fn values_hash(&self) -> u64;
}

/// A value turned non-finite or left its range: nothing the plant says can be trusted any more.
pub type Untrusted = eclss_core::Fault;
