//! Who takes the steps of a run: one thread, or several that share each step.

use eclss_core::{Method, Network, Simulator, SplitSimulator};
use eclss_parallel::{ParallelBuffers, Threads};

use super::Plan;
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
            return numbers.alone.simulator(network, plan.settings).map(Self::Alone).map_err(refused);
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

    pub(super) fn step(&mut self) {
        match self {
            Self::Alone(simulator) => {
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
            Self::Shared(simulator, _) => simulator.counters(),
        }
    }

    /// The simulator with all its figures.
    pub(super) fn simulator(&mut self) -> &Simulator<'a> {
        match self {
            Self::Alone(simulator) => simulator,
            Self::Shared(simulator, _) => simulator.simulator(),
        }
    }
}
