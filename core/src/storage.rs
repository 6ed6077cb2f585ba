//! Where a simulator keeps its numbers: statically sized arrays on a board, vectors on a host.

/// Lengths of the four buffers that a network needs with a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sizes {
    /// Integrated states and their carries.
    pub state: usize,
    /// What a step derives anew.
    pub work: usize,
    /// Input slots.
    pub inputs: usize,
    /// Schedules.
    pub cursors: usize,
}

/// The buffers of one simulator, borrowed from wherever they live; each may be longer than needed.
#[derive(Debug)]
pub struct Buffers<'b> {
    /// Integrated states and their carries.
    pub state: &'b mut [f32],
    /// What a step derives anew.
    pub work: &'b mut [f32],
    /// Present value of every input slot.
    pub inputs: &'b mut [f32],
    /// Position in every schedule.
    pub cursors: &'b mut [u32],
}

/// Buffers as arrays of fixed length, for a `static` on a board.
#[derive(Debug, Clone)]
pub struct Storage<const STATE: usize, const WORK: usize, const INPUTS: usize, const CURSORS: usize> {
    state: [f32; STATE],
    work: [f32; WORK],
    inputs: [f32; INPUTS],
    cursors: [u32; CURSORS],
}

impl<const STATE: usize, const WORK: usize, const INPUTS: usize, const CURSORS: usize>
    Storage<STATE, WORK, INPUTS, CURSORS>
{
    /// Returns buffers of zeros; the simulator sets the start state.
    pub const fn new() -> Self {
        Self { state: [0.0; STATE], work: [0.0; WORK], inputs: [0.0; INPUTS], cursors: [0; CURSORS] }
    }

    /// Lends the buffers to a simulator.
    pub fn buffers(&mut self) -> Buffers<'_> {
        Buffers {
            state: &mut self.state,
            work: &mut self.work,
            inputs: &mut self.inputs,
            cursors: &mut self.cursors,
        }
    }
}

impl<const STATE: usize, const WORK: usize, const INPUTS: usize, const CURSORS: usize> Default
    for Storage<STATE, WORK, INPUTS, CURSORS>
{
    fn default() -> Self {
        Self::new()
    }
}
