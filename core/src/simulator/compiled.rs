//! A step specialised for a description that the compiler knows.

use super::{CheckpointError, Health, InputError, LiveInput, Settings, Simulator};
use crate::Network;
use crate::component::Element;

/// A description and settings that the compiler knows, as generated from a network file.
pub trait Compiled {
    /// The element set.
    type Element: Element + 'static;
    /// The description.
    const NETWORK: Network<'static, Self::Element>;
    /// Method and step.
    const SETTINGS: Settings;
}

/// A simulator of a description that the compiler knows: same bits as [`Simulator::step`], but every table is
/// read, every branch on it taken and every bound checked at compile time.
#[derive(Debug)]
pub struct CompiledSimulator<'a, N: Compiled> {
    simulator: Simulator<'a, N::Element>,
    description: core::marker::PhantomData<N>,
}

impl<'a, N: Compiled> CompiledSimulator<'a, N> {
    /// Returns `simulator` with a specialised step, or `None` where it runs another description or settings.
    pub fn new(simulator: Simulator<'a, N::Element>) -> Option<Self> {
        let same = simulator.network_id == N::NETWORK.id() && simulator.settings == N::SETTINGS;
        same.then_some(Self { simulator, description: core::marker::PhantomData })
    }

    /// Advances by one step. A faulted simulator stands still.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "to be specialised where it is called")]
    pub fn step(&mut self) -> Health {
        self.simulator.advance::<true>(&N::NETWORK, N::SETTINGS)
    }

    /// Sets an input, see [`Simulator::set_input`].
    pub fn set_input(&mut self, slot: usize, value: f32) -> Result<(), InputError> {
        self.simulator.set_input(slot, value)
    }

    /// Sets a live input, see [`Simulator::set_live`].
    pub fn set_live(&mut self, input: &LiveInput, value: f32, slope_per_s: f32) -> Result<(), InputError> {
        self.simulator.set_live(input, value, slope_per_s)
    }

    /// Goes back to the start, see [`Simulator::restart`].
    pub fn restart(&mut self) {
        self.simulator.restart();
    }

    /// Goes back to a checkpoint, see [`Simulator::restore`].
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), CheckpointError> {
        self.simulator.restore(bytes)
    }
}

impl<'a, N: Compiled> core::ops::Deref for CompiledSimulator<'a, N> {
    type Target = Simulator<'a, N::Element>;

    fn deref(&self) -> &Self::Target {
        &self.simulator
    }
}
