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
    fn state_hash(&self) -> u32;
}

/// A value turned non-finite or left its range: nothing the plant says can be trusted any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Untrusted {
    /// Index of the element in the network's description.
    pub element: u16,
}

/// Two volumes joined by a leak: stands in for the network until that is compiled in.
pub struct StandIn {
    /// Supply pressure \[Pa gauge\].
    inputs: [f32; 1],
    /// Pressures \[Pa gauge\].
    pressures_pa: [f32; 2],
}

impl StandIn {
    /// Starts at rest.
    pub const fn new() -> Self {
        Self { inputs: [1_000.0], pressures_pa: [0.0; 2] }
    }
}

impl Default for StandIn {
    fn default() -> Self {
        Self::new()
    }
}

impl Plant for StandIn {
    fn inputs(&mut self) -> &mut [f32] {
        &mut self.inputs
    }
    fn step(&mut self) -> Result<(), Untrusted> {
        let [first, second] = self.pressures_pa;
        self.pressures_pa =
            [first + 0.01 * (self.inputs[0] + second - 2.0 * first), second + 0.005 * (first - second)];
        if self.pressures_pa[0].is_finite() { Ok(()) } else { Err(Untrusted { element: 0 }) }
    }
    fn outputs(&self) -> &[f32] {
        &self.pressures_pa
    }
    fn state_hash(&self) -> u32 {
        self.pressures_pa.iter().fold(0x811c_9dc5, |hash, p| (hash ^ p.to_bits()).wrapping_mul(0x0100_0193))
    }
}
