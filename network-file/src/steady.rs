//! Steady state of a network: the flows and pressures at which nothing changes any more, in `f64`.
//!
//! Unknown are the flow w of every line and the pressure p of every node that is not held:
//!
//! ```text
//! line   loss(w) = p_from − p_to            (quasi-steady; volumes and inertances inside lines play no part)
//! node   Σ given − Σ taken + s = Cap·r      s from sources of gas; r = dp/dt of the node's island, 0 wherever an island can rest
//! ```
//!
//! An *island* is what hangs together through lines. One with a boundary has its pressures from there. One
//! without keeps its mass, so the level of its pressures follows from the mass at the start; if something in it
//! is drained or supplied it never comes to rest: its flows do, while all its pressures fall at one rate r. Closed air is
//! what no boundary holds but space, and nobody feeds: its rest is a vacuum, and that of a station that leaks 0.2 kg/d is of no
//! use to anybody. Its masses are held, and the answer names them ([`Steady::held`]).
//!
//! Solved by Newton's method in flows and pressures together (the global gradient algorithm of Todini and
//! Pilati, 1988), with the slope of a line's loss taken at the larger of its flow and the flow that the present
//! pressures would drive, and the step halved where it does not help. Nothing here is shared with the methods
//! that step in time but the elements' laws, so that it can judge them.
//!
//! Of a climate only the gas of sources is in the balance; temperatures and compositions stay those of the start, and
//! what crews, removers and fog do to the mass of air is left out.

mod characteristic;
mod elimination;
mod island;
mod memory;
mod newton;
mod response;

use eclss_core::Climate;
use eclss_core::Element;
use eclss_core::{Network, NetworkError, NodeKind};

use self::island::Islands;
use crate::Names;

/// Absolute pressure below which a boundary counts as space [Pa]: that of Mars is 600 … 900 Pa.
pub(crate) const SPACE_PA: f64 = 1_000.0;

/// Flows and pressures of a state of rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Steady {
    /// Pressure of every node as deviation from the reference [Pa].
    pub gauge_pa: Vec<f64>,
    /// Flow of every line at its flow segment [kg/s].
    pub flow_kg_s: Vec<f64>,
    /// Rate at which every node's pressure goes on changing [Pa/s]: 0 in a state of rest.
    pub rate_pa_s: Vec<f64>,
    /// Newton iterations that it took.
    pub iterations: u32,
    /// Closed air that loses gas to space, or by lines whose flow is given: its mass is held, and its pressures are those
    /// of a network in which it stays.
    pub held: Vec<Held>,
    /// What is left unbalanced, as part of the pressures and flows that could be there [1].
    pub residual: f64,
}

/// Nodes whose mass a steady state holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// The nodes.
    pub nodes: Vec<u32>,
    /// The lines through which they would go on losing or gaining mass.
    pub lines: Vec<u32>,
    /// Rate at which all their pressures would change [Pa/s].
    pub rate_pa_s: f64,
}

/// Why there is no steady state; nodes and lines by their index.
#[derive(Debug, Clone, PartialEq)]
pub enum SteadyError {
    /// The description is wrong.
    Network(NetworkError),
    /// There are fewer input values than slots.
    Inputs {
        /// Number of slots.
        needed: usize,
        /// Number of values.
        given: usize,
    },
    /// Nodes without volume hang together without a boundary: nothing fixes their pressure.
    Floating {
        /// The nodes.
        nodes: Vec<u32>,
    },
    /// An island without boundary is drained or supplied: its pressures change for ever.
    Drained {
        /// Its nodes.
        nodes: Vec<u32>,
        /// The lines that drain; none where only sources supply.
        lines: Vec<u32>,
        /// Rate of all its pressures [Pa/s].
        rate_pa_s: f64,
    },
    /// The balance needs less than no pressure at a node.
    BelowVacuum {
        /// The node.
        node: u32,
        /// Its absolute pressure in the balance [Pa].
        pressure_pa: f64,
    },
    /// The balance needs more pressure at a node than a run is trusted with.
    BeyondRange {
        /// The node.
        node: u32,
        /// Its absolute pressure in the balance [Pa].
        pressure_pa: f64,
    },
    /// Elements with a memory never find a place: where they stand, the pressures make them switch.
    Switching {
        /// The segments.
        segments: Vec<u32>,
    },
    /// The iteration did not find a balance.
    NotFound {
        /// The line that is farthest from it.
        line: u32,
        /// What it lacks [Pa].
        imbalance_pa: f64,
    },
}

/// Returns the state of rest of `network` with its inputs held at `inputs`, or why there is none.
pub fn steady<E: Element>(network: &Network<'_, E>, inputs: &[f32]) -> Result<Steady, SteadyError> {
    let islands = islands(network, inputs)?;
    let mut found = newton::solve(network, inputs, &islands)?;
    for island in &islands.closed {
        let rate_pa_s = found.rate_pa_s[island.pinned as usize];
        let lines: Vec<u32> = [&island.leaks[..], &island.sources].concat();
        if island.drains.is_empty() && !lines.is_empty() {
            found.held.push(Held { nodes: island.nodes.clone(), lines, rate_pa_s });
            continue;
        }
        let balanced = island.drains.is_empty() && balance(&network.climate, inputs, &island.nodes).is_even();
        if rate_pa_s.abs() > 0.0 && !balanced {
            let (nodes, lines) = (island.nodes.clone(), island.drains.clone());
            return Err(SteadyError::Drained { nodes, lines, rate_pa_s });
        }
    }
    Ok(found)
}

/// Returns the flows of `network` with its inputs held at `inputs` once they no longer change. Where an island
/// without boundary is drained its pressures go on falling; [`Steady::rate_pa_s`] says how fast, and the
/// pressures are those at which the island holds the mass of the start.
pub fn steady_flows<E: Element>(network: &Network<'_, E>, inputs: &[f32]) -> Result<Steady, SteadyError> {
    newton::solve(network, inputs, &islands(network, inputs)?)
}

/// Flow that the start's pressures drive through every line with the inputs held at `inputs` [kg/s].
pub(crate) fn flows_at_start<E: Element>(network: &Network<'_, E>, inputs: &[f32]) -> Vec<f64> {
    let islands = Islands::find(network, inputs, &supplied_kg_s(network, inputs));
    islands.map(|islands| newton::at_start(network, inputs, &islands)).unwrap_or_default()
}

fn islands<E: Element>(network: &Network<'_, E>, inputs: &[f32]) -> Result<Islands, SteadyError> {
    network.check().map_err(SteadyError::Network)?;
    if inputs.len() < network.inputs.len() {
        return Err(SteadyError::Inputs { needed: network.inputs.len(), given: inputs.len() });
    }
    Islands::find(network, inputs, &supplied_kg_s(network, inputs))
}

/// Returns nodes that hang together without a volume or a boundary among them, if there are any: nothing fixes
/// their pressure.
pub(crate) fn floating<E: Element>(network: &Network<'_, E>) -> Option<Vec<u32>> {
    match Islands::find(network, network.inputs, &[]) {
        Err(SteadyError::Floating { nodes }) => Some(nodes),
        _ => None,
    }
}

/// Nodes of every island that no boundary holds.
pub(crate) fn islands_without_boundary<E: Element>(
    network: &Network<'_, E>,
    inputs: &[f32],
) -> Vec<Vec<u32>> {
    let closed = Islands::find(network, inputs, &supplied_kg_s(network, inputs))
        .map(|islands| islands.closed)
        .unwrap_or_default();
    closed.into_iter().map(|island| island.nodes).collect()
}

/// What sources bring into some nodes [kg/s].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Balance {
    sum: f64,
    size: f64,
}

impl Balance {
    /// Whether as much is taken as is given, to the rounding of the inputs.
    pub(crate) fn is_even(self) -> bool {
        self.sum.abs() <= 1e-6 * self.size
    }
}

/// What the sources of gas bring into `nodes` at these inputs.
pub(crate) fn balance(climate: &Climate<'_>, inputs: &[f32], nodes: &[u32]) -> Balance {
    let own = climate.gas_sources(inputs).filter(|(_, node, _)| nodes.contains(node));
    own.map(|(_, _, flow)| f64::from(flow)).fold(Balance::default(), |balance, flow| Balance {
        sum: balance.sum + flow,
        size: balance.size + flow.abs(),
    })
}

/// Gas that the components of a network bring into every node at these inputs [kg/s].
fn supplied_kg_s<E>(network: &Network<'_, E>, inputs: &[f32]) -> Vec<f64> {
    let mut supplied = vec![0.0; network.nodes.len()];
    for (_, node, gas_kg_s) in network.climate.gas_sources(inputs) {
        if let Some(node) = supplied.get_mut(node as usize) {
            *node += f64::from(gas_kg_s);
        }
    }
    supplied
}

/// Capacity dm/dp of a node [kg/Pa]; 0 for a junction and, as it never matters, for a boundary.
fn capacity(node: &eclss_core::Node) -> f64 {
    match node.kind {
        NodeKind::Cabin { volume_m3 } => {
            let gas = f64::from(eclss_core::air::GAS_CONSTANT_J_KG_K) * f64::from(node.temperature_k);
            f64::from(volume_m3) / gas
        }
        NodeKind::Liquid { capacity_kg_pa } => f64::from(capacity_kg_pa),
        NodeKind::Junction | NodeKind::Boundary => 0.0,
    }
}

impl SteadyError {
    /// Returns the reason with the ids of the nodes and lines concerned.
    pub fn text(&self, names: &Names) -> String {
        let node = |index: &u32| name(&names.nodes, *index);
        let nodes = |list: &[u32]| list.iter().map(node).collect::<Vec<_>>().join(", ");
        let line = |index: &u32| name(&names.lines, *index);
        match self {
            Self::Network(error) => format!("the network is wrong: {error}"),
            Self::Inputs { needed, given } => format!("{given} input values for {needed} inputs"),
            Self::Floating { nodes: list } => {
                format!("nothing fixes the pressure of {}: no volume and no boundary among them", nodes(list))
            }
            Self::Drained { nodes: list, lines, rate_pa_s } if lines.is_empty() => format!(
                "no steady state: {} have no boundary and sources that change their mass; their pressures change by \
                 {rate_pa_s:.4} Pa/s for ever",
                nodes(list)
            ),
            Self::Drained { nodes: list, lines, rate_pa_s } => format!(
                "no steady state: {} have no boundary and lose mass through {}; their pressures change by \
                 {rate_pa_s:.4} Pa/s for ever",
                nodes(list),
                lines.iter().map(line).collect::<Vec<_>>().join(", ")
            ),
            Self::BelowVacuum { node: index, pressure_pa } => {
                format!("no steady state: {} would need {pressure_pa:.1} Pa absolute", node(index))
            }
            Self::BeyondRange { node: index, pressure_pa } => format!(
                "no steady state: {} would need {pressure_pa:.4e} Pa absolute, more than a run is trusted with",
                node(index)
            ),
            Self::Switching { segments } => format!(
                "no steady state: {} would open and close for ever",
                segments.iter().map(|index| name(&names.segments, *index)).collect::<Vec<_>>().join(", ")
            ),
            Self::NotFound { line: index, imbalance_pa } => {
                format!("no steady state found: line {} lacks {imbalance_pa:.3e} Pa", line(index))
            }
        }
    }
}

/// The id of a node or line, in quotes.
fn name(names: &[String], index: u32) -> String {
    names.get(index as usize).map_or_else(|| format!("number {index}"), |name| format!("`{name}`"))
}

#[cfg(test)]
mod tests;
