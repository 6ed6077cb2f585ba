//! The network that is compiled in, as a plant.

use crate::control::SHOWN_OUTPUTS;
use crate::plant::{Plant, Untrusted};
use core::num::NonZeroU32;
use eclss_core::{Health, Method, Network, Settings, Simulator, Storage, example};
use static_cell::StaticCell;

/// The simulator and its process image.
pub struct NetworkPlant {
    simulator: Simulator<'static>,
    /// Mass flows of the first lines \[kg/s\].
    flows_kg_s: [f32; SHOWN_OUTPUTS],
}

/// Builds the plant with one step per tick of `period_us` \[µs\]. To be called once.
///
/// # Panics
/// When the network does not fit the method or the storage: then there is nothing to run.
pub fn plant(period_us: NonZeroU32) -> NetworkPlant {
    static NETWORK: StaticCell<Network<'static>> = StaticCell::new();
    static STORAGE: StaticCell<Storage<128, 128, 16, 8>> = StaticCell::new();
    let network = NETWORK.init(example::paper_loop());
    let storage = STORAGE.init(Storage::new());
    let settings = Settings { method: Method::Relaxation, step_us: period_us.get() };
    let simulator = Simulator::new(network, settings, storage.buffers()).expect("the network fits the board");
    NetworkPlant { simulator, flows_kg_s: [0.0; SHOWN_OUTPUTS] }
}

impl NetworkPlant {
    /// Id of the network's description.
    pub fn network_id(&self) -> u64 {
        self.simulator.network_id()
    }
}

impl Plant for NetworkPlant {
    fn inputs(&mut self) -> &mut [f32] {
        &mut []
    }
    #[cfg_attr(feature = "nucleo-h743zi2", unsafe(link_section = ".itcm.step"))]
    #[allow(unsafe_code, reason = "on the board with tightly coupled memory, the step runs from it")]
    #[inline(never)]
    fn step(&mut self) -> Result<(), Untrusted> {
        let health = self.simulator.step();
        let lines = self.simulator.network().lines.len();
        for (line, flow) in self.flows_kg_s.iter_mut().enumerate().take(lines) {
            *flow = self.simulator.line_flow_kg_s(line);
        }
        match health {
            Health::Trusted => Ok(()),
            Health::Faulted(fault) => Err(fault),
        }
    }
    fn outputs(&self) -> &[f32] {
        &self.flows_kg_s
    }
    fn state_hash(&self) -> u64 {
        self.simulator.state_hash()
    }
}
