//! The plant of the loop: any network under any method.

use std::cell::RefCell;

use eclss_core::process::Applied;
use eclss_core::{Fingerprint, Health, LiveInput, Signal, Simulator};
use eclss_target::plant::{Plant, Untrusted};

use super::tap::Tap;

/// How many flows are shown.
const SHOWN: usize = eclss_target::control::SHOWN_OUTPUTS;

/// A network as the loop steps it.
#[derive(Debug)]
pub struct HostPlant<'s> {
    simulator: Simulator<'s>,
    /// Every slot that may be set from outside.
    live: Vec<Option<LiveInput>>,
    tap: &'s RefCell<Tap>,
    flows_kg_s: [f32; SHOWN],
}

impl<'s> HostPlant<'s> {
    /// Makes a plant of `simulator` that is listened to by `tap`.
    pub fn new(simulator: Simulator<'s>, tap: &'s RefCell<Tap>) -> Self {
        let live =
            (0..simulator.network().inputs.len()).map(|slot| simulator.live_input(slot).ok()).collect();
        // Makes room, and shows the start.
        tap.borrow_mut().read(&simulator, false);
        Self { simulator, live, tap, flows_kg_s: [0.0; SHOWN] }
    }

    /// The simulator.
    pub fn simulator(&self) -> &Simulator<'s> {
        &self.simulator
    }

    fn put(&mut self, slot: usize, value: f32, slope_per_s: f32) -> bool {
        let Some(live) = self.live.get(slot).copied().flatten() else { return false };
        let taken = self.simulator.set_live(&live, value, slope_per_s).is_ok();
        if taken {
            self.tap.borrow_mut().input(slot, value, slope_per_s);
        }
        taken
    }
}

impl Plant for HostPlant<'_> {
    fn restart(&mut self) {
        self.simulator.restart();
    }

    fn apply(&mut self, _channel: usize, slot: u32, applied: Applied) {
        // What is out of range leaves what there is.
        let _ = self.put(slot as usize, applied.value, applied.slope_per_s);
    }

    fn set(&mut self, slot: u32, value: f32) -> bool {
        self.put(slot as usize, value, 0.0)
    }

    fn input(&self, slot: u32) -> Option<f32> {
        self.simulator.inputs().get(slot as usize).copied()
    }

    fn signal(&self, signal: Signal) -> f32 {
        self.simulator.signal(signal)
    }

    fn step(&mut self) -> Result<(), Untrusted> {
        let health = self.simulator.step();
        for (line, flow) in self.flows_kg_s.iter_mut().enumerate() {
            *flow = self.simulator.line_flow_kg_s(line);
        }
        self.tap.borrow_mut().read(&self.simulator, true);
        match health {
            Health::Trusted => Ok(()),
            Health::Faulted(fault) => Err(fault),
        }
    }

    fn outputs(&self) -> &[f32] {
        let lines = self.simulator.network().lines.len();
        self.flows_kg_s.get(..lines).unwrap_or(&self.flows_kg_s)
    }

    fn state_hash(&self) -> u64 {
        self.simulator.state_hash()
    }

    fn values_hash(&self) -> u64 {
        let mut hash = Fingerprint::default();
        hash.values(self.simulator.state());
        hash.finish()
    }
}
