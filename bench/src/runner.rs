//! A network under a method, with buffers of just the size that it asks for.

use eclss_core::{Buffers, Health, Method, Network, Settings, Simulator};

use crate::Failure;

/// Buffers for one simulator.
#[derive(Debug, Clone, Default)]
pub struct Runner {
    state: Vec<f32>,
    work: Vec<f32>,
    inputs: Vec<f32>,
    cursors: Vec<u32>,
}

impl Runner {
    /// Allocates what `network` needs with `method`.
    pub fn new(network: &Network<'_>, method: Method) -> Self {
        let sizes = method.sizes(network);
        Self {
            state: vec![0.0; sizes.state],
            work: vec![0.0; sizes.work],
            inputs: vec![0.0; sizes.inputs],
            cursors: vec![0; sizes.cursors],
        }
    }

    /// Builds the simulator at its start state with a step of `step_us` [µs].
    pub fn simulator<'s>(
        &'s mut self,
        network: &'s Network<'s>,
        method: Method,
        step_us: u32,
    ) -> Result<Simulator<'s>, Failure> {
        let buffers = Buffers {
            state: &mut self.state,
            work: &mut self.work,
            inputs: &mut self.inputs,
            cursors: &mut self.cursors,
        };
        Ok(Simulator::new(network, Settings { method, step_us }, buffers)?)
    }
}

/// Refuses a run that stopped: a step that does nothing must not be counted.
pub(crate) fn still_trusted(simulator: &Simulator<'_>) -> Result<(), Failure> {
    match simulator.health() {
        Health::Trusted => Ok(()),
        Health::Faulted(_) => Err(Failure::Faulted(simulator.settings().method.name())),
    }
}
