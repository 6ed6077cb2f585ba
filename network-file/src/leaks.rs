//! Flow to space: the sum over all lines that end in a vacuum, at the start's pressures and inputs.

use eclss_core::{Network, NodeKind, air};

use crate::steady::{SPACE_PA, flows_at_start};

/// Seconds of a day.
const SECONDS_A_DAY: f64 = 86_400.0;

/// Flow to space at the start.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Leaks {
    /// Index of every line that lets something out, and how much [kg/d].
    pub lines: Vec<(u32, f64)>,
    /// Gas that all cabins hold [kg].
    pub held_kg: f64,
}

impl Leaks {
    /// Sum over all lines [kg/d].
    pub fn kg_d(&self) -> f64 {
        self.lines.iter().map(|(_, kg_d)| kg_d).sum()
    }
}

/// Sums what the lines of `network` let out into boundaries below 1 kPa, with its inputs at `inputs`.
pub fn leaks_to_space(network: &Network<'_>, inputs: &[f32]) -> Leaks {
    let pressure = |node: &eclss_core::Node| f64::from(network.reference_pa) + f64::from(node.start_gauge_pa);
    let space = |node: u32| {
        let node = network.nodes.get(node as usize);
        node.is_some_and(|node| node.kind == NodeKind::Boundary && pressure(node) < SPACE_PA)
    };
    let mut leaks = Leaks::default();
    for node in network.nodes {
        if let NodeKind::Cabin { volume_m3 } = node.kind {
            let gas = f64::from(air::GAS_CONSTANT_J_KG_K) * f64::from(node.temperature_k);
            leaks.held_kg += pressure(node) * f64::from(volume_m3) / gas;
        }
    }
    if !(0..network.nodes.len() as u32).any(space) {
        return leaks;
    }
    for ((index, line), flow_kg_s) in (0u32..).zip(network.lines).zip(flows_at_start(network, inputs)) {
        let out_kg_s = match (space(line.from), space(line.to)) {
            (false, true) => flow_kg_s,
            (true, false) => -flow_kg_s,
            _ => continue,
        };
        if out_kg_s > 0.0 {
            leaks.lines.push((index, out_kg_s * SECONDS_A_DAY));
        }
    }
    leaks.lines.sort_by(|a, b| b.1.total_cmp(&a.1));
    leaks
}
