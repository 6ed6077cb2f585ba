//! A simulator's buffers as vectors, sized for whatever network comes.

use eclss_core::{Buffers, BuildError, Element, Network, Settings, Simulator};

/// Owns the numbers of one simulator.
#[derive(Debug, Default)]
pub struct HostBuffers {
    state: Vec<f32>,
    work: Vec<f32>,
    inputs: Vec<f32>,
    cursors: Vec<u32>,
}

impl HostBuffers {
    /// Sizes the buffers for `network` and builds the simulator on them.
    pub fn simulator<'a, E: Element>(
        &'a mut self,
        network: &'a Network<'a, E>,
        settings: Settings,
    ) -> Result<Simulator<'a, E>, BuildError> {
        let sizes = settings.method.sizes(network);
        self.state = vec![0.0; sizes.state];
        self.work = vec![0.0; sizes.work];
        self.inputs = vec![0.0; sizes.inputs];
        self.cursors = vec![0; sizes.cursors];
        let buffers = Buffers {
            state: &mut self.state,
            work: &mut self.work,
            inputs: &mut self.inputs,
            cursors: &mut self.cursors,
        };
        Simulator::new(network, settings, buffers)
    }
}
