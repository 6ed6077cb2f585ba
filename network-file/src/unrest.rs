//! Networks that never come to rest, told with ids and places of the file.
//!
//! Some are meant so (a cabin that a condenser drains), some are mistakes (a source into a tank without outlet). No
//! method is wrong in any of them: pressures move as they should until they leave their range. A search for their
//! steady state has no answer, and that is said before it is looked for.

use eclss_core::NodeKind;

use crate::loaded::Loaded;
use crate::notes::Notes;
use crate::steady::{SteadyError, balance, islands_without_boundary, steady};

/// Lines of the file where nodes and lines are named, counted from 1; empty for a network that was not read from text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Places {
    /// Of every node.
    pub nodes: Vec<usize>,
    /// Of every line.
    pub lines: Vec<usize>,
    /// Of every placed component.
    pub components: Vec<usize>,
}

/// Why a network does not come to rest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unrest {
    /// Line of the file that it is about, counted from 1; `None` where there is no text.
    pub line: Option<usize>,
    /// The reason, with ids.
    pub reason: String,
    /// Whether pressures merely fall or rise for ever, as may be meant; else there is no balance at all.
    pub drifts: bool,
}

impl Places {
    pub(crate) fn new(loaded: &Loaded, notes: &Notes, text: &str) -> Self {
        let ends: Vec<usize> = text.match_indices('\n').map(|(byte, _)| byte).collect();
        let line = |path: &str| {
            let byte = notes.place(path, &["id"]).start;
            ends.partition_point(|&end| end < byte) + 1
        };
        let all =
            |kind: &str, count: usize| (0..count).map(|index| line(&format!("{kind}[{index}]"))).collect();
        Self {
            nodes: all("node", loaded.nodes.len()),
            lines: all("line", loaded.lines.len()),
            components: loaded.climate.paths.iter().map(|path| line(path)).collect(),
        }
    }
}

impl SteadyError {
    /// Line of the file that the error is about, counted from 1.
    pub fn place(&self, loaded: &Loaded) -> Option<usize> {
        let node = |index: &u32| loaded.places.nodes.get(*index as usize).copied();
        let line = |index: &u32| loaded.places.lines.get(*index as usize).copied();
        match self {
            Self::Network(_) | Self::Inputs { .. } => None,
            Self::Floating { nodes } => nodes.first().and_then(node),
            Self::Drained { lines, nodes, .. } => {
                lines.first().and_then(line).or_else(|| nodes.first().and_then(node))
            }
            Self::BelowVacuum { node: index, .. } | Self::BeyondRange { node: index, .. } => node(index),
            Self::Switching { segments } => {
                let has = |segment: &u32| {
                    let own = loaded.lines.iter().position(|line| {
                        (line.first_segment..line.first_segment + line.segments).contains(segment)
                    });
                    own.and_then(|index| loaded.places.lines.get(index).copied())
                };
                segments.first().and_then(has)
            }
            Self::NotFound { line: index, .. } => line(index),
        }
    }
}

/// Says why `loaded` has no state of rest with the inputs of its start; empty where it has one.
pub fn unrest(loaded: &Loaded) -> Vec<Unrest> {
    let network = loaded.network();
    let mut list = Vec::new();
    // Sources are told one by one.
    let by_sources =
        |error: &SteadyError| matches!(error, SteadyError::Drained { lines, .. } if lines.is_empty());
    if let Some(error) = steady(&network, &loaded.inputs).err().filter(|error| !by_sources(error)) {
        list.push(Unrest {
            line: error.place(loaded),
            reason: error.text(&loaded.names),
            drifts: matches!(error, SteadyError::Drained { .. }),
        });
    }
    for nodes in islands_without_boundary(&network, &loaded.inputs) {
        if balance(&network.climate, &loaded.inputs, &nodes).is_even() {
            continue;
        }
        for (index, node, gas_kg_s) in network.climate.gas_sources(&loaded.inputs) {
            let holds = network.nodes.get(node as usize).map(|node| node.kind);
            let of_gas = matches!(holds, Some(NodeKind::Cabin { .. }));
            if !of_gas || !nodes.contains(&node) || gas_kg_s.abs() < f32::MIN_POSITIVE {
                continue;
            }
            let ids: Vec<_> =
                nodes.iter().map(|&node| format!("`{}`", loaded.names.nodes[node as usize])).collect();
            let id = loaded.names.components.get(index as usize).map_or("?", String::as_str);
            let kind = network.climate.component(index).map_or("source", |(table, _)| table.kind().name());
            list.push(Unrest {
                line: loaded.places.components.get(index as usize).copied(),
                reason: format!(
                    "no steady state: {kind} `{id}` puts {gas_kg_s:.3e} kg/s into {}, which have no boundary; their \
                     pressures change for ever",
                    ids.join(", ")
                ),
                drifts: true,
            });
        }
    }
    list
}
