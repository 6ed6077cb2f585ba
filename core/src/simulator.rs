//! Joins description, state and method, and counts time.

use crate::element::{Element, StdElement};
use crate::method::relaxation;
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
    /// Largest deviation of any pressure from the reference [Pa].
    pub const GAUGE_LIMIT_PA: f32 = 1e7;
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

/// One network under one method: steps, counts and answers for the state.
#[derive(Debug)]
pub struct Simulator<'a, E = StdElement> {
    network: &'a Network<'a, E>,
    settings: Settings,
    network_id: u64,
    step_s: f32,
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
        inputs.copy_from_slice(network.inputs);
        cursors.fill(0);
        relaxation::start(network, state, work, inputs);
        Ok(Self {
            network,
            settings,
            network_id: network.id(),
            step_s: settings.step_us as f32 * 1e-6,
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
        })
    }

    /// Advances by one step. A faulted simulator stands still.
    pub fn step(&mut self) -> Health {
        if self.health != Health::Trusted {
            return self.health;
        }
        self.follow_schedules();
        let stabilised = self.settings.method == Method::Relaxation;
        let (margin, place) =
            relaxation::step(self.network, self.step_s, stabilised, self.state, self.work, self.inputs);
        self.margin = margin;
        self.worst_margin = self.worst_margin.with(margin);
        self.unproven_ticks += u64::from(margin.proof == Proof::None);
        self.tick += 1;
        self.time_us += u64::from(self.settings.step_us);
        if let Some(place) = place {
            self.health = Health::Faulted(Fault { tick: self.tick, place });
        }
        self.health
    }

    fn follow_schedules(&mut self) {
        for (schedule, cursor) in self.network.schedules.iter().zip(self.cursors.iter_mut()) {
            let first = schedule.first_point as usize;
            let points = self.network.points.get(first..first + schedule.points as usize);
            if let (Some(points), Some(input)) = (points, self.inputs.get_mut(schedule.input as usize)) {
                *input = schedule.value(points, cursor, self.time_us);
            }
        }
    }

    /// Sets an input from outside, as hardware or an operator does. Returns false where the slot does not
    /// exist, follows a schedule, or the value is not finite. The range is the caller's to check against the
    /// element's [`crate::InputSpec`].
    pub fn set_input(&mut self, slot: usize, value: f32) -> bool {
        let scheduled = self.network.schedules.iter().any(|schedule| schedule.input as usize == slot);
        match self.inputs.get_mut(slot) {
            Some(input) if !scheduled && value.is_finite() => {
                *input = value;
                true
            }
            _ => false,
        }
    }

    fn view(&self) -> relaxation::View<'_, 'a, E> {
        relaxation::View::new(self.network, self.state, self.work)
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

    /// Present value of every input slot.
    pub fn inputs(&self) -> &[f32] {
        self.inputs
    }

    /// The integrated states and their carries.
    pub fn state(&self) -> &[f32] {
        self.state
    }

    /// Gauge pressure of node `node` [Pa]; NaN for a node that does not exist.
    pub fn node_gauge_pa(&self, node: usize) -> f32 {
        self.view().node_gauge_pa(node)
    }

    /// Mass flow of line `line` at its flow segment [kg/s]; NaN for a line that does not exist.
    pub fn line_flow_kg_s(&self, line: usize) -> f32 {
        self.view().line_flow_kg_s(line)
    }

    /// Mass flow at the inlet of segment `segment` of line `line` [kg/s].
    pub fn segment_flow_kg_s(&self, line: usize, segment: usize) -> f32 {
        self.view().segment_flow_kg_s(line, segment)
    }

    /// Gauge pressure at the outlet of segment `segment` of line `line` [Pa].
    pub fn outlet_gauge_pa(&self, line: usize, segment: usize) -> f32 {
        self.view().outlet_gauge_pa(line, segment, self.inputs)
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
