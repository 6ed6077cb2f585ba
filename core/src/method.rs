//! Methods: each advances the state of one description by one fixed step.

pub(crate) mod adaptive;
pub(crate) mod common;
pub(crate) mod implicit;
pub(crate) mod observe;
pub(crate) mod relaxation;
pub(crate) mod responsive;

use crate::component::Element;
use crate::{Network, NodeKind, PlanError, Sizes, climate};

/// The methods that exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Method {
    /// Explicit Euler on the relaxation system, without the operator: for comparison, diverges when stiff.
    Euler,
    /// The paper's method: explicit Euler on the relaxation system with the adaptive operator.
    Relaxation,
    /// Explicit Euler with the operator on quasi-steady lines and real volumes: no matrix, any topology.
    Adaptive,
    /// Linearly implicit Euler with inertance and duct storage.
    ImplicitEuler,
    /// TR-BDF2 with inertance and duct storage: second order, L-stable.
    TrBdf2,
}

/// Why a method does not take a network with a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MethodError {
    /// The step is zero or longer than the method allows, in microseconds.
    Step {
        /// Longest step [µs].
        longest_us: u32,
    },
    /// A node is too small for this step: `h²·Σ_lines Rg·T/V > 1` makes the unit-rate flow row diverge.
    NodeTooSmall(u32),
    /// The method needs a volume or a boundary, this node is a junction.
    Junction(u32),
    /// The method moves gas only, this node is liquid.
    Liquid(u32),
    /// Heat, moisture and composition need the flows of a physical method; this one's are pseudo-time.
    Climate,
    /// The connection tables are missing or wrong.
    Plan(PlanError),
    /// A line drains more than 11.8 % of its flow, for which the method's bound is not proven.
    TooMuchRemoved(u32),
    /// The nodes of a line start further apart than 10 kPa, where pseudo-time would move real mass.
    PressureDifference(u32),
    /// The method takes no line whose laws respond to pressure, direction, memory or density.
    Responsive(u32),
    /// More than one element of a line has a law that depends on the pressures at both its ends, which the method
    /// does not know inside a line.
    SeveralBetweenNodes(u32),
    /// A segment has neither inertance nor a loss at rest, so nothing decides its flow.
    NothingResists(u32),
}

impl Method {
    /// All methods, in the order in which tables show them.
    pub const ALL: [Self; 5] =
        [Self::Euler, Self::Relaxation, Self::Adaptive, Self::ImplicitEuler, Self::TrBdf2];

    /// Returns the method's name in files, commands and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Euler => "euler",
            Self::Relaxation => "relaxation",
            Self::Adaptive => "adaptive",
            Self::ImplicitEuler => "implicit-euler",
            Self::TrBdf2 => "tr-bdf2",
        }
    }

    /// Returns the method of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }

    /// Returns the lengths of the buffers that `network` needs with this method.
    pub fn sizes<E: Element>(self, network: &Network<'_, E>) -> Sizes {
        let (state, work) = self.own_sizes(network);
        let (climate_state, climate_work) = climate::sizes(network);
        let (state, work) = (state + climate_state, work + climate_work);
        Sizes { state, work, inputs: 3 * network.inputs.len(), cursors: network.schedules.len() }
    }

    /// Lengths of the method's own part of state and work.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler may know")]
    fn own_sizes<E: Element>(self, network: &Network<'_, E>) -> (usize, usize) {
        match self {
            Self::Euler | Self::Relaxation => relaxation::sizes(network),
            Self::Adaptive => adaptive::sizes(network),
            Self::ImplicitEuler | Self::TrBdf2 => implicit::sizes(network),
        }
    }

    /// The same without the climate's parts for buffers of these lengths that were cut by it, without a look at every line of a
    /// large network. `KNOWN` says that the compiler knows the description.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "lengths that the compiler may know")]
    pub(crate) fn step_sizes<E: Element, const KNOWN: bool>(
        self,
        network: &Network<'_, E>,
        state: usize,
        work: usize,
    ) -> Sizes {
        let (state, work) = match self {
            Self::Adaptive if KNOWN && network.segments.len() <= adaptive::FEW => {
                adaptive::sizes_known(network)
            }
            Self::Adaptive => (state, work),
            _ => self.own_sizes(network),
        };
        Sizes { state, work, inputs: 3 * network.inputs.len(), cursors: network.schedules.len() }
    }

    /// Places between the gauge pressures of two nodes, which stand at the beginning of the work buffer.
    pub(crate) const fn node_stride(self) -> usize {
        match self {
            Self::Adaptive => adaptive::NODE_FIGURES,
            Self::Euler | Self::Relaxation | Self::ImplicitEuler | Self::TrBdf2 => 1,
        }
    }

    /// Where the climate meets a node's figures in the work: sets the gauge pressure [Pa], where there is one, and
    /// returns φ of the last step [1].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the climate's loop over volumes")]
    pub(crate) fn meet(self, figures: &mut [f32], gauge_pa: Option<f32>) -> f32 {
        if let (Some(pressure), Some(gauge_pa)) = (figures.first_mut(), gauge_pa) {
            *pressure = gauge_pa;
        }
        match self {
            Self::Adaptive => figures.get(adaptive::NODE_FIGURES - 1).copied().unwrap_or(1.0),
            Self::Euler | Self::Relaxation | Self::ImplicitEuler | Self::TrBdf2 => 1.0,
        }
    }

    /// Where in the state the sum stands that the first line gave, with its carry behind it, and the places between
    /// two lines.
    pub(crate) const fn given_at(self, nodes: usize) -> (usize, usize) {
        match self {
            Self::Adaptive => (adaptive::State::line_at(nodes, 0) + 1, adaptive::State::line_at(0, 1)),
            _ => (4 * nodes + 2, 6),
        }
    }

    /// Finds out whether the method takes this network with a step of `step_us` [µs].
    pub fn check<E: Element>(self, network: &Network<'_, E>, step_us: u32) -> Result<(), MethodError> {
        if matches!(self, Self::Euler | Self::Relaxation) && !network.climate.is_none() {
            return Err(MethodError::Climate);
        }
        match self {
            Self::Euler => relaxation::check(network, step_us, 1_000_000),
            Self::Relaxation => relaxation::check(network, step_us, 10_000),
            Self::Adaptive => adaptive::check(network, step_us),
            Self::ImplicitEuler | Self::TrBdf2 => implicit::check(network, step_us),
        }
    }

    /// Refuses the first node without a gas volume of its own.
    pub(crate) fn refuse_junctions<E>(network: &Network<'_, E>) -> Result<(), MethodError> {
        let liquid = network.nodes.iter().position(|node| matches!(node.kind, NodeKind::Liquid { .. }));
        if let Some(index) = liquid {
            return Err(MethodError::Liquid(index as u32));
        }
        let junction = network.nodes.iter().position(|node| node.kind == NodeKind::Junction);
        junction.map_or(Ok(()), |index| Err(MethodError::Junction(index as u32)))
    }
}
