//! Joins description, state and method, and counts time.

mod checkpoint;
mod live;
mod split;

pub use checkpoint::CheckpointError;
pub use live::{InputError, LiveInput};
pub use split::SplitSimulator;

use crate::climate::{self, ClimateError, ExchangerReadings, Ledger, Readings};
use crate::element::{Element, StdElement};
use crate::method::implicit::StageInputs;
use crate::method::observe::Observer;
use crate::method::{adaptive, implicit, relaxation};
use crate::schedule::Instant;
use crate::{Buffers, Fingerprint, Margin, Method, MethodError, Network, NetworkError, Proof};

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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

impl core::fmt::Display for BuildError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{self:?}")
    }
}

impl core::error::Error for BuildError {}

/// Where a value left its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Place {
    /// Pressure of this node.
    Node(u32),
    /// Flow of this line.
    Line(u32),
}

/// A value became NaN, infinite or larger than anything in a space station: the run is no longer trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fault {
    /// The tick that produced it, counted from 1.
    pub tick: u64,
    /// The first place that left its range.
    pub place: Place,
}

impl Fault {
    /// Largest mass flow of any line [kg/s].
    pub const FLOW_LIMIT_KG_S: f32 = 1e3;
    /// Largest deviation of any pressure from the reference [Pa]. An absolute pressure below zero is out of range
    /// as well.
    pub const GAUGE_LIMIT_PA: f32 = 1e7;

    /// Whether a gauge pressure over `reference_pa` is out of range; vacuum itself, with its rounding, is not.
    pub(crate) fn outside(gauge_pa: f32, reference_pa: f32) -> bool {
        crate::math::beyond(gauge_pa, Self::GAUGE_LIMIT_PA) || gauge_pa < -reference_pa
    }
}

/// Whether a run may be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Health {
    /// Every value is finite and in range.
    Trusted,
    /// A value left its range; the state stands still since then.
    Faulted(Fault),
}

/// A description and settings that the compiler knows, as generated from a network file.
pub trait Compiled {
    /// The element set.
    type Element: Element + 'static;
    /// The description.
    const NETWORK: Network<'static, Self::Element>;
    /// Method and step.
    const SETTINGS: Settings;
}

/// Samples every schedule at the method's stage times.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn follow_schedules<E: Element>(
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
    for (schedule, cursor) in network.schedules.iter().zip(cursors) {
        let first = schedule.first_point as usize;
        let Some(points) = network.points.get(first..first + schedule.points as usize) else { continue };
        let mut set = |stage: usize, at| {
            if let Some(input) = inputs.get_mut(stage * slots + schedule.input as usize) {
                *input = schedule.value(points, cursor, at);
            }
        };
        set(0, now);
        if implicit {
            set(1, inside);
            set(2, end);
        }
    }
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
pub struct Simulator<'a, E = StdElement> {
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
        match settings.method {
            Method::Euler | Method::Relaxation => relaxation::start(network, state, work, inputs),
            Method::Adaptive => adaptive::start(network, step_s, state, work, inputs),
            Method::ImplicitEuler | Method::TrBdf2 => {
                implicit::start(network, settings.method, step_s, state, work, inputs);
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
        follow_schedules(network, settings, self.time_us, inputs, cursors);
        let h = settings.step_us as f32 * 1e-6;
        if !network.climate.loops.is_empty() {
            climate::control(network, h, self.tick, climate_state, climate_work, inputs);
        }
        let (start, rest) = inputs.split_at_checked(network.inputs.len()).unwrap_or((&[], &[]));
        let (middle, end) = rest.split_at_checked(start.len()).unwrap_or((&[], &[]));
        let (margin, mut place) = match settings.method {
            Method::Euler => relaxation::step::<E, UNROLL>(network, h, false, state, work, start),
            Method::Relaxation => relaxation::step::<E, UNROLL>(network, h, true, state, work, start),
            Method::Adaptive => adaptive::step::<E, UNROLL>(network, h, state, work, start),
            Method::ImplicitEuler | Method::TrBdf2 => implicit::step::<E, UNROLL>(
                network,
                settings.method,
                h,
                state,
                work,
                StageInputs { start, middle, end },
            ),
        };
        if !network.climate.is_none() {
            let (first, stride) = settings.method.given_at(network.nodes.len());
            let given = climate::Given { sums: state.get(first..).unwrap_or(&[]), stride };
            let at = climate::Stepped { step_s: h, inputs: start, given };
            let stride = settings.method.node_stride();
            let gauge = |node: usize, gauge_pa: f32| {
                if let Some(pressure) = work.get_mut(node * stride) {
                    *pressure = gauge_pa;
                }
            };
            place = place.or(climate::step(network, at, climate_state, climate_work, gauge));
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

    fn observer(&self) -> Observer<'_, 'a, E> {
        let implicit = matches!(self.settings.method, Method::ImplicitEuler | Method::TrBdf2);
        let slots = self.network.inputs.len();
        let last_stage = if implicit { 2 * slots } else { 0 };
        Observer {
            network: self.network,
            method: self.settings.method,
            state: self.state,
            work: self.work,
            inputs: self.inputs.get(last_stage..).unwrap_or(&[]),
        }
    }

    /// The description.
    pub fn network(&self) -> &'a Network<'a, E> {
        self.network
    }

    /// Method and step.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The description's id.
    pub fn network_id(&self) -> u64 {
        self.network_id
    }

    /// Steps taken.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Plant time [µs]: tick times step.
    pub fn time_us(&self) -> u64 {
        self.time_us
    }

    /// Whether the run may be trusted.
    pub fn health(&self) -> Health {
        self.health
    }

    /// Margin of the last step.
    pub fn margin(&self) -> Margin {
        self.margin
    }

    /// Worst margin of all steps so far, figure by figure.
    pub fn worst_margin(&self) -> Margin {
        self.worst_margin
    }

    /// Steps in which neither the proof nor the guard held.
    pub fn unproven_ticks(&self) -> u64 {
        self.unproven_ticks
    }

    /// Value of every input slot in the last step.
    pub fn inputs(&self) -> &[f32] {
        self.observer().inputs
    }

    /// The integrated states and their carries.
    pub fn state(&self) -> &[f32] {
        self.state
    }

    /// Gauge pressure of node `node` [Pa]; NaN for a node that does not exist.
    pub fn node_gauge_pa(&self, node: usize) -> f32 {
        self.observer().node_gauge_pa(node)
    }

    /// φ of node `node` in the last step [1]: below 1 it stores as if its volume were V/φ. NaN for a node that does
    /// not exist.
    pub fn node_phi(&self, node: usize) -> f32 {
        self.observer().node_phi(node)
    }

    /// Mass flow of line `line` at its flow segment [kg/s]; NaN for a line that does not exist.
    pub fn line_flow_kg_s(&self, line: usize) -> f32 {
        self.observer().line_flow_kg_s(line)
    }

    /// Reads line `line` in one pass, last segment first: calls `each` with the segment (counted over all lines),
    /// the mass flow at its inlet [kg/s] and the gauge pressure at its outlet [Pa].
    pub fn read_line(&self, line: usize, each: impl FnMut(usize, f32, f32)) {
        self.observer().read_line(line, each);
    }

    /// Mass flow at the inlet of segment `segment` (counted over all lines) of line `line` [kg/s]. Walks the line;
    /// [`Self::read_line`] gives all of it at once.
    pub fn segment_flow_kg_s(&self, line: usize, segment: usize) -> f32 {
        self.observer().segment_flow_kg_s(line, segment)
    }

    /// Gauge pressure at the outlet of segment `segment` (counted over all lines) of line `line` [Pa].
    pub fn outlet_gauge_pa(&self, line: usize, segment: usize) -> f32 {
        self.observer().outlet_gauge_pa(line, segment)
    }

    /// Mass of node `node` as deviation from the start [kg].
    pub fn node_mass_kg(&self, node: usize) -> f64 {
        self.climate().mass_kg(node).unwrap_or_else(|| self.observer().node_mass_kg(node))
    }

    /// Mass that the operator kept node `node` from storing [kg]; 0 wherever φ was 1 throughout.
    pub fn fictitious_kg(&self, node: usize) -> f64 {
        self.observer().fictitious_kg(node)
    }

    /// What line `line` took from its inlet node, gave to its outlet node and drained since the start [kg].
    pub fn line_sums_kg(&self, line: usize) -> [f64; 3] {
        self.observer().line_sums_kg(line)
    }

    /// Mass that the volumes inside line `line` hold beyond the start [kg].
    pub fn held_kg(&self, line: usize) -> f64 {
        self.observer().held_kg(line)
    }

    fn climate(&self) -> climate::Observed<'_, 'a> {
        let (state, work) = climate::sizes(self.network);
        let tail = |buffer: &'_ [f32], length: usize| buffer.len().saturating_sub(length);
        climate::Observed::of(
            &self.network.climate,
            self.state.get(tail(self.state, state)..).unwrap_or(&[]),
            self.work.get(tail(self.work, work)..).unwrap_or(&[]),
            self.settings.step_us as f32 * 1e-6,
        )
    }

    /// What node `node` shows as a volume of air; `None` without a climate, and for coolant.
    pub fn air(&self, node: usize) -> Option<Readings> {
        self.climate().air(node)
    }

    /// Temperature of node `node` [K]: its present one with a climate, else the fixed one of the description.
    pub fn node_temperature_k(&self, node: usize) -> f32 {
        let fixed = || self.network.nodes.get(node).map(|node| node.temperature_k);
        self.climate().temperature_k(node).or_else(fixed).unwrap_or(f32::NAN)
    }

    /// What exchanger `index` of the climate shows.
    pub fn exchanger(&self, index: usize) -> Option<ExchangerReadings> {
        self.climate().exchanger(index)
    }

    /// Share of what arrived at node `node` that its volume stored in the last step [1]; below 1 where more passes than
    /// it holds.
    pub fn storage_phi(&self, node: usize) -> Option<f32> {
        self.climate().phi(node)
    }

    /// Ledgers of gases, water, coolant and energy; all zero without a climate.
    pub fn ledgers(&self) -> [Ledger; 7] {
        self.climate().ledgers()
    }

    /// Returns the hash over network id, method, step, tick and every state and carry, the same on every
    /// machine that took the same steps.
    pub fn state_hash(&self) -> u64 {
        let mut hash = Fingerprint::default();
        hash.long(self.network_id);
        hash.word(self.settings.method as u32);
        hash.word(self.settings.step_us);
        hash.long(self.tick);
        hash.values(self.state);
        hash.finish()
    }
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
