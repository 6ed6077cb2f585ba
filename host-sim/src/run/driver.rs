//! Who takes the steps of a run: the core's simulator, or one whose step was compiled for the network.

use eclss_core::{Network, Simulator};

use super::Plan;
#[cfg(feature = "compiled")]
use super::compiled;
use crate::refusal::refused;
use crate::{Failure, HostBuffers, Source};

/// Numbers of a run, whoever takes its steps.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    alone: HostBuffers,
}

/// A simulator and who steps it.
pub(super) enum Driver<'a> {
    Alone(Simulator<'a>),
    #[cfg(feature = "compiled")]
    Compiled(compiled::Compiled<'a>),
}

impl<'a> Driver<'a> {
    /// Builds the simulator of `plan`.
    pub(super) fn new(
        source: &Source,
        plan: &Plan,
        network: &'a Network<'a>,
        numbers: &'a mut Numbers,
    ) -> Result<Self, Failure> {
        let refused = |error| refused(source, plan.settings, &error);
        let simulator = numbers.alone.simulator(network, plan.settings).map_err(refused)?;
        #[cfg(feature = "compiled")]
        if compiled::fits(&simulator) {
            let compiled = compiled::Compiled::new(simulator).map(Self::Compiled);
            return compiled.ok_or_else(|| Failure::Failed("another network is compiled in".to_owned()));
        }
        return Ok(Self::Alone(simulator));
    }

    /// Whether the step was compiled for this network.
    pub(super) fn is_compiled(&self) -> bool {
        !matches!(self, Self::Alone(_))
    }

    pub(super) fn step(&mut self) {
        match self {
            Self::Alone(simulator) => {
                simulator.step();
            }
            #[cfg(feature = "compiled")]
            Self::Compiled(simulator) => {
                simulator.step();
            }
        }
    }

    /// The simulator for its tick, health and margin.
    pub(super) fn counters(&self) -> &Simulator<'a> {
        match self {
            Self::Alone(simulator) => simulator,
            #[cfg(feature = "compiled")]
            Self::Compiled(simulator) => simulator,
        }
    }

    /// The simulator with all its figures.
    pub(super) fn simulator(&mut self) -> &Simulator<'a> {
        match self {
            Self::Alone(simulator) => simulator,
            #[cfg(feature = "compiled")]
            Self::Compiled(simulator) => simulator,
        }
    }
}
