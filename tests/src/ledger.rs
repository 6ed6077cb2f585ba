//! What a mass ledger must add up to, whatever the method.
//!
//! Node: stored + fictitious = given to it − taken from it. Network: what nodes and lines hold beyond the start,
//! what was drained and what boundaries received add up to nothing.

use eclss_core::{BuildError, Health, Method, NodeKind, air};
use eclss_network_file::{Loaded, parse};

use crate::product::with_simulator;

const PAPER: &str = include_str!("../../networks/paper.toml");

/// A supply that makes up for what the open loop drains, 33.6 kg a day: 100 Pa over an orifice.
const MAKE_UP: &str = r#"
[[node]]
id = "gas"
kind = "boundary"
pressure_pa = 101425.0
temperature_k = 295.15

[[line]]
id = "make_up"
from = "gas"
to = "cabin"

[[line.element]]
id = "orifice"
kind = "pipe"
resistance_pa_s2_kg2 = 6.6e8
"#;

/// Returns the paper's loop with its dynamic cabin of 60 m³: the valve closes to 2 % at 11 s and stays there.
///
/// # Panics
/// When a file of ours is not a good one any more.
pub fn closing() -> Loaded {
    parse(PAPER, "paper.toml").expect("a good file")
}

/// Returns the same loop with the valve open for good and a supply that makes up for what it drains.
///
/// # Panics
/// When a file of ours is not a good one any more.
pub fn supplied() -> Loaded {
    let open = PAPER.split("[[schedule]]").next().unwrap_or_default();
    parse(&format!("{open}{MAKE_UP}"), "supplied.toml").expect("a good file")
}

/// A ledger at the end of a run.
#[derive(Debug, Clone, Copy)]
pub struct Closure {
    /// Mass of all cabins at the start [kg].
    pub total_kg: f64,
    /// What was drained [kg].
    pub drained_kg: f64,
    /// What came from boundaries [kg].
    pub entered_kg: f64,
    /// What the operator kept from being stored [kg].
    pub fictitious_kg: f64,
    /// The larger of what the worst node and what the whole network lacks [kg].
    pub error_kg: f64,
}

impl Closure {
    /// The error as part of the total mass [1].
    pub fn relative(&self) -> f64 {
        self.error_kg / self.total_kg
    }
}

/// Runs `loaded` until plant time `until_us` [µs] and closes its ledger.
///
/// # Panics
///
/// If the run is not trusted to its end.
pub fn close(loaded: &Loaded, method: Method, step_us: u32, until_us: u64) -> Result<Closure, BuildError> {
    let network = loaded.network();
    with_simulator(&network, method, step_us, |simulator| {
        while simulator.time_us() < until_us {
            let health = simulator.step();
            assert_eq!(health, Health::Trusted, "{} at {} µs", method.name(), simulator.time_us());
        }
        let mut open: Vec<f64> = (0..network.nodes.len())
            .map(|node| simulator.node_mass_kg(node) + simulator.fictitious_kg(node))
            .collect();
        let (mut total_kg, mut entered_kg, mut fictitious_kg) = (0.0, 0.0, 0.0);
        let mut whole: f64 = open.iter().sum();
        for (index, node) in network.nodes.iter().enumerate() {
            fictitious_kg += simulator.fictitious_kg(index);
            match node.kind {
                NodeKind::Cabin { volume_m3 } => {
                    let pressure = f64::from(network.reference_pa) + f64::from(node.start_gauge_pa);
                    let gas = f64::from(air::GAS_CONSTANT_J_KG_K) * f64::from(node.temperature_k);
                    total_kg += pressure * f64::from(volume_m3) / gas;
                }
                NodeKind::Boundary => entered_kg -= simulator.node_mass_kg(index),
                // A liquid keeps its mass but for what a few pascals press in.
                NodeKind::Liquid { .. } | NodeKind::Junction => {}
            }
        }
        let mut drained_kg = 0.0;
        for (index, line) in network.lines.iter().enumerate() {
            let [taken, given, drained] = simulator.line_sums_kg(index);
            open[line.from as usize] += taken;
            open[line.to as usize] -= given;
            drained_kg += drained;
            whole += drained + simulator.held_kg(index);
        }
        let error_kg = open.iter().fold(whole.abs(), |worst, error| worst.max(error.abs()));
        Closure { total_kg, drained_kg, entered_kg, fictitious_kg, error_kg }
    })
}
