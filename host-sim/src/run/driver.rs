//! Who takes the steps of a run: one thread, several that share each step, or one with a step that was compiled for the
//! network.

use eclss_core::{Method, Network, Simulator, SplitSimulator};
use eclss_parallel::{ParallelBuffers, Threads};

use super::Plan;
#[cfg(feature = "compiled")]
use super::compiled;
use crate::refusal::refused;
use crate::{Failure, HostBuffers, Source};

/// Numbers of a run, whoever takes its steps.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    alone: HostBuffers,
    shared: ParallelBuffers,
}

/// A simulator and who steps it.
pub(super) enum Driver<'a> {
    Alone(Simulator<'a>),
    #[cfg(feature = "compiled")]
    Compiled(compiled::Compiled<'a>),
    Shared(SplitSimulator<'a>, Threads),
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
        if plan.threads == 1 {
            let simulator = numbers.alone.simulator(network, plan.settings).map_err(refused)?;
            #[cfg(feature = "compiled")]
            if compiled::fits(&simulator) {
                let compiled = compiled::Compiled::new(simulator).map(Self::Compiled);
                return compiled.ok_or_else(|| Failure::Failed("another network is compiled in".to_owned()));
            }
            return Ok(Self::Alone(simulator));
        }
        if plan.settings.method != Method::Adaptive {
            let name = plan.settings.method.name();
            return Err(Failure::BadInput(format!(
                "--threads {}: threads can share a step of method `adaptive`, not one of `{name}`",
                plan.threads
            )));
        }
        let threads = Threads::new(plan.threads)
            .map_err(|error| Failure::Failed(format!("--threads {}: {error}", plan.threads)))?;
        numbers.shared = ParallelBuffers::new(network);
        let simulator = numbers.shared.simulator(network, plan.settings.step_us).map_err(refused)?;
        Ok(Self::Shared(simulator, threads))
    }

    /// Whether the step was compiled for this network.
    pub(super) fn is_compiled(&self) -> bool {
        !matches!(self, Self::Alone(_) | Self::Shared(..))
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
            Self::Shared(simulator, threads) => {
                threads.step(simulator);
            }
        }
    }

    /// The simulator for its tick, health and margin.
    pub(super) fn counters(&self) -> &Simulator<'a> {
        match self {
            Self::Alone(simulator) => simulator,
            #[cfg(feature = "compiled")]
            Self::Compiled(simulator) => simulator,
            Self::Shared(simulator, _) => simulator.counters(),
        }
    }

    /// The simulator with all its figures.
    pub(super) fn simulator(&mut self) -> &Simulator<'a> {
        match self {
            Self::Alone(simulator) => simulator,
            #[cfg(feature = "compiled")]
            Self::Compiled(simulator) => simulator,
            Self::Shared(simulator, _) => simulator.simulator(),
        }
    }
}
