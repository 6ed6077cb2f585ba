//! A simulator whose step is taken in ranges, so that several processors can share it.

use super::{BuildError, Health, InputError, Settings, Simulator, cut_tail, follow_schedules};
use crate::element::Element;
use crate::method::adaptive::split::{self, Join, SplitBuffers};
use crate::method::responsive::Given;
use crate::{Buffers, Method, MethodError, Network, PlanError, StdElement, climate};

/// A simulator of `adaptive` that steps ranges of lines and of nodes side by side: the same bits as
/// [`Simulator::step`], whatever does the ranges and however many.
#[derive(Debug)]
pub struct SplitSimulator<'a, E = StdElement> {
    simulator: Simulator<'a, E>,
    buffers: SplitBuffers<'a>,
    /// Whether the simulator's own figures are those of the last step.
    shown: bool,
}

impl<'a, E: Element> SplitSimulator<'a, E> {
    /// Builds a simulator of `adaptive` with a step of `step_us` [µs]. Needs a network with lists of line ends, and
    /// `split` of just the right lengths.
    pub fn new(
        network: &'a Network<'a, E>,
        step_us: u32,
        buffers: Buffers<'a>,
        mut split: SplitBuffers<'a>,
    ) -> Result<Self, BuildError> {
        let settings = Settings { method: Method::Adaptive, step_us };
        let simulator = Simulator::new(network, settings, buffers)?;
        if network.plan.end_start.is_empty() {
            return Err(BuildError::Method(MethodError::Plan(PlanError::Missing)));
        }
        if let Some((name, needed, given)) = split::fits(network, &split) {
            return Err(BuildError::Buffer { name, needed, given });
        }
        split.fill(network, simulator.work);
        Ok(Self { simulator, buffers: split, shown: true })
    }

    /// Advances by one step. A faulted simulator stands still.
    pub fn step(&mut self, join: &impl Join) -> Health {
        let simulator = &mut self.simulator;
        if simulator.health != Health::Trusted {
            return simulator.health;
        }
        let (network, settings, tick) = (simulator.network, simulator.settings, simulator.tick);
        let (climate_state, climate_work) = climate::sizes(network);
        let (Some((state, climate_state)), Some((work, climate_work))) =
            (cut_tail(simulator.state, climate_state), cut_tail(simulator.work, climate_work))
        else {
            return simulator.health;
        };
        let inputs = &mut *simulator.inputs;
        follow_schedules::<E, false>(network, settings, simulator.time_us, inputs, simulator.cursors);
        let h = settings.step_us as f32 * 1e-6;
        let mut running = climate::Running::of(network, climate_state, climate_work);
        if let Some(running) = running.as_mut() {
            climate::control::<E, false>(network, h, tick, running, inputs);
        }
        let inputs = inputs.get(..network.inputs.len()).unwrap_or(&[]);
        let at = climate::Stepped { step_s: h, inputs };
        if let Some(running) = running.as_mut() {
            climate::supply::<E, false>(network, at, running);
        }
        let now = Given { inputs, virtual_k: running.as_ref().map_or(&[], climate::Running::virtual_k) };
        let (margin, mut place) = split::step(network, h, state, work, now, &mut self.buffers, join);
        if let Some(running) = running {
            let (first, stride) = settings.method.given_at(network.nodes.len());
            let given = climate::Given { sums: state.get(first..).unwrap_or(&[]), stride };
            // Puts φ where it is read.
            self.buffers.show(network, work);
            let stride = settings.method.node_stride();
            let flow = |node: usize, gauge_pa: Option<f32>| {
                if let (Some(gauge_pa), Some(pressure)) = (gauge_pa, self.buffers.pressures.get_mut(node)) {
                    *pressure = gauge_pa;
                }
                settings.method.meet(work.get_mut(node * stride..).unwrap_or(&mut []), gauge_pa)
            };
            place = place.or(climate::step::<E, false>(network, at, given, running, flow));
        }
        self.shown = false;
        simulator.count(settings, margin, place)
    }

    /// The simulator for its tick, health and margin: its pressures and φ are those of the last call of
    /// [`Self::simulator`].
    pub fn counters(&self) -> &Simulator<'a, E> {
        &self.simulator
    }

    /// Sets an input, see [`Simulator::set_input`].
    pub fn set_input(&mut self, slot: usize, value: f32) -> Result<(), InputError> {
        self.simulator.set_input(slot, value)
    }

    /// The simulator, to be read. After a step its pressures are gathered first.
    pub fn simulator(&mut self) -> &Simulator<'a, E> {
        if !self.shown {
            self.buffers.show(self.simulator.network, self.simulator.work);
            self.shown = true;
        }
        &self.simulator
    }
}
