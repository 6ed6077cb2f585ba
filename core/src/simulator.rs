//! Joins description, state and method, and counts time.

mod checkpoint;
mod compiled;
mod excursion;
mod health;
mod live;
mod read;
mod refusal;

pub use checkpoint::CheckpointError;
pub use compiled::{Compiled, CompiledSimulator};
pub use excursion::{Excursion, Strayed};
pub use health::{Fault, Health, Place};
pub use live::{InputError, LiveInput};

use crate::climate::{self, ClimateError};
use crate::component::{AnyComponent, Element};
use crate::method::implicit::StageInputs;
use crate::method::responsive::Given;
use crate::method::{adaptive, implicit, relaxation};
use crate::schedule::Instant;
use crate::unroll::every;
use crate::{Buffers, Margin, Method, MethodError, Network, NetworkError, Proof};

/// How a network is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// Step h [µs]; ≥ 1, and at most what the method allows.
    pub step_us: u32,
}

/// Why a simulator was not built.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BuildError {
    /// The description is wrong.
    Network(NetworkError),
    /// The method does not take this description with this step.
    Method(MethodError),
    /// Heat, moisture, composition or control are wrong.
    Climate(ClimateError),
    /// A buffer is too short.
    Buffer {
        /// Which buffer.
        name: &'static str,
        /// Length that is needed.
        needed: usize,
        /// Length that was given.
        given: usize,
    },
}

impl core::error::Error for BuildError {}

/// Samples every schedule at the method's stage times.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn follow_schedules<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    settings: Settings,
    time_us: u64,
    inputs: &mut [f32],
    cursors: &mut [u32],
) {
    let step_us = settings.step_us;
    let implicit = matches!(settings.method, Method::ImplicitEuler | Method::TrBdf2);
    let inner = implicit::INNER_STAGE * step_us as f32;
    let whole = inner as u32;
    let now = Instant { time_us, part_us: 0.0, before: false };
    let inside =
        Instant { time_us: time_us + u64::from(whole), part_us: inner - whole as f32, before: false };
    let end = Instant { time_us: time_us + u64::from(step_us), part_us: 0.0, before: true };
    let slots = network.inputs.len();
    every!(UNROLL, network.schedules.iter().zip(cursors), (schedule, cursor) => {
        let first = schedule.first_point as usize;
        let points = network.points.get(first..first + schedule.points as usize).unwrap_or(&[]);
        let mut set = |stage: usize, at| {
            if let Some(input) = inputs.get_mut(stage * slots + schedule.input as usize) {
                *input = schedule.value(points, cursor, at);
            }
        };
        set(0, now);
        // One cursor serves all stages: they are asked in the order of time.
        if settings.method == Method::TrBdf2 {
            set(1, inside);
        }
        if implicit {
            set(2, end);
        }
    });
}

/// Cuts the last `length` numbers off.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn cut_tail(buffer: &mut [f32], length: usize) -> Option<(&mut [f32], &mut [f32])> {
    let first = buffer.len().checked_sub(length)?;
    buffer.split_at_mut_checked(first)
}

/// One network under one method: steps, counts and answers for the state.
#[derive(Debug)]
pub struct Simulator<'a, E = AnyComponent> {
    network: &'a Network<'a, E>,
    settings: Settings,
    network_id: u64,
    tick: u64,
    time_us: u64,
    state: &'a mut [f32],
    work: &'a mut [f32],
    inputs: &'a mut [f32],
    cursors: &'a mut [u32],
    margin: Margin,
    worst_margin: Margin,
    unproven_ticks: u64,
    health: Health,
}

impl<'a, E: Element> Simulator<'a, E> {
    /// Checks everything that can be wrong and sets the start state.
    pub fn new(
        network: &'a Network<'a, E>,
        settings: Settings,
        buffers: Buffers<'a>,
    ) -> Result<Self, BuildError> {
        network.check().map_err(BuildError::Network)?;
        settings.method.check(network, settings.step_us).map_err(BuildError::Method)?;
        network.climate.check(network, settings.step_us).map_err(BuildError::Climate)?;
        let sizes = settings.method.sizes(network);
        let short = |name, needed, given| BuildError::Buffer { name, needed, given };
        let Buffers { state, work, inputs, cursors } = buffers;
        let (given_state, given_work) = (state.len(), work.len());
        let (given_inputs, given_cursors) = (inputs.len(), cursors.len());
        let state = state.get_mut(..sizes.state).ok_or(short("state", sizes.state, given_state))?;
        let work = work.get_mut(..sizes.work).ok_or(short("work", sizes.work, given_work))?;
        let inputs = inputs.get_mut(..sizes.inputs).ok_or(short("inputs", sizes.inputs, given_inputs))?;
        let cursors =
            cursors.get_mut(..sizes.cursors).ok_or(short("cursors", sizes.cursors, given_cursors))?;
        let mut simulator = Self {
            network,
            settings,
            network_id: network.id(),
            tick: 0,
            time_us: 0,
            state,
            work,
            inputs,
            cursors,
            margin: Margin::FREE,
            worst_margin: Margin::FREE,
            unproven_ticks: 0,
            health: Health::Trusted,
        };
        simulator.restart();
        Ok(simulator)
    }

    /// Goes back to the start, to the bit: what happened since is forgotten, a fault included.
    pub fn restart(&mut self) {
        let Self { network, settings, state, work, inputs, cursors, .. } = self;
        for stage in inputs.chunks_exact_mut(network.inputs.len().max(1)) {
            stage.copy_from_slice(network.inputs);
        }
        cursors.fill(0);
        let step_s = settings.step_us as f32 * 1e-6;
        let (climate_state, climate_work) = climate::sizes(network);
        let (state, climate_state) = state.split_at_mut(state.len().saturating_sub(climate_state));
        let (work, climate_work) = work.split_at_mut(work.len().saturating_sub(climate_work));
        climate::start(network, climate_state, climate_work, inputs);
        let given = Given { inputs, virtual_k: climate::virtual_k(network, climate_work) };
        match settings.method {
            Method::Euler | Method::Relaxation => relaxation::start(network, state, work, inputs),
            Method::Adaptive => adaptive::start(network, step_s, state, work, given),
            Method::ImplicitEuler | Method::TrBdf2 => {
                implicit::start(network, settings.method, step_s, state, work, given);
            }
        }
        (self.tick, self.time_us, self.unproven_ticks) = (0, 0, 0);
        (self.margin, self.worst_margin) = (Margin::FREE, Margin::FREE);
        self.health = Health::Trusted;
    }

    /// Advances by one step. A faulted simulator stands still.
    pub fn step(&mut self) -> Health {
        let (network, settings) = (self.network, self.settings);
        self.advance::<false>(network, settings)
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "specialised for a compiled description")]
    fn advance<const UNROLL: bool>(&mut self, network: &Network<'_, E>, settings: Settings) -> Health {
        if self.health != Health::Trusted {
            return self.health;
        }
        // The lengths are what they were when the simulator was built; said again they are known here.
        let (climate_state, climate_work) = climate::sizes(network);
        let (Some((state, climate_state)), Some((work, climate_work))) =
            (cut_tail(self.state, climate_state), cut_tail(self.work, climate_work))
        else {
            return self.health;
        };
        let sizes = settings.method.step_sizes::<E, UNROLL>(network, state.len(), work.len());
        let (Some(state), Some(work), Some(inputs), Some(cursors)) = (
            state.get_mut(..sizes.state),
            work.get_mut(..sizes.work),
            self.inputs.get_mut(..sizes.inputs),
            self.cursors.get_mut(..sizes.cursors),
        ) else {
            return self.health;
        };
        follow_schedules::<E, UNROLL>(network, settings, self.time_us, inputs, cursors);
        let h = settings.step_us as f32 * 1e-6;
        let mut running = climate::Running::of(network, climate_state, climate_work);
        if let Some(running) = running.as_mut() {
            climate::control::<E, UNROLL>(network, h, self.tick, running, inputs);
        }
        let (start, rest) = inputs.split_at_checked(network.inputs.len()).unwrap_or((&[], &[]));
        let at = climate::Stepped { step_s: h, inputs: start };
        if let Some(running) = running.as_mut() {
            climate::supply(network, at, running);
        }
        let virtual_k = running.as_ref().map_or(&[][..], climate::Running::virtual_k);
        let supplied = running.as_ref().map(climate::Supplied::of).unwrap_or_default();
        let (middle, end) = rest.split_at_checked(start.len()).unwrap_or((&[], &[]));
        let (margin, mut place) = match settings.method {
            Method::Euler => relaxation::step::<E, UNROLL>(network, h, false, state, work, start),
            Method::Relaxation => relaxation::step::<E, UNROLL>(network, h, true, state, work, start),
            Method::Adaptive => {
                adaptive::step::<E, UNROLL>(network, h, state, work, Given { inputs: start, virtual_k })
            }
            Method::ImplicitEuler | Method::TrBdf2 => implicit::step::<E, UNROLL>(
                network,
                settings.method,
                h,
                state,
                work,
                StageInputs { start, middle, end, virtual_k, supplied },
            ),
        };
        if let Some(running) = running {
            let (first, stride) = settings.method.given_at(network.nodes.len());
            let given = climate::Given { sums: state.get(first..).unwrap_or(&[]), stride };
            let stride = settings.method.node_stride();
            let flow = |node: usize, gauge_pa: Option<f32>| {
                let figures = work.get_mut(node * stride..).unwrap_or(&mut []);
                settings.method.meet(figures, gauge_pa)
            };
            place = place.or(climate::step::<E, UNROLL>(network, at, given, running, flow));
        }
        self.count(settings, margin, place)
    }

    /// Notes what a step found and counts it.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    fn count(&mut self, settings: Settings, margin: Margin, place: Option<Place>) -> Health {
        self.margin = margin;
        self.worst_margin = if self.tick == 0 { margin } else { self.worst_margin.with(margin) };
        self.unproven_ticks += u64::from(margin.proof == Proof::None);
        self.tick += 1;
        self.time_us += u64::from(settings.step_us);
        if let Some(place) = place {
            self.health = Health::Faulted(Fault { tick: self.tick, place });
        }
        self.health
    }

    /// Advances by `steps` steps, or until the run is no longer trusted.
    pub fn step_times(&mut self, steps: u64) -> Health {
        for _ in 0..steps {
            if self.step() != Health::Trusted {
                break;
            }
        }
        self.health
    }
}
