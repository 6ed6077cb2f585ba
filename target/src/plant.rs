//! What the loop steps.

/// A simulated plant: inputs in, one fixed step, outputs out.
pub trait Plant {
    /// Values that the board's inputs are read into, one per channel, in the channel's unit.
    fn inputs(&mut self) -> &mut [f32];
    /// Advances by one tick. The number of operations does not depend on the values.
    fn step(&mut self) -> Result<(), Untrusted>;
    /// Values for the board's outputs, one per channel, in the channel's unit.
    fn outputs(&self) -> &[f32];
    /// A hash over the whole state. Too slow for a tick: asked for when a run has ended.
    fn state_hash(&self) -> u64;
    /// The same over the integrated values alone, without what identifies network and run.
    fn values_hash(&self) -> u64;
}

/// A value turned non-finite or left its range: nothing the plant says can be trusted any more.
pub type Untrusted = eclss_core::Fault;
