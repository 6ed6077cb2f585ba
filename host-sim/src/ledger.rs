//! Whether the mass ledger of a running simulator closes.

use eclss_core::{NodeKind, Simulator, air};
use eclss_network_file::Loaded;

/// What is needed to close the ledger of one network, again and again without taking memory.
#[derive(Debug, Clone)]
pub struct Closure {
    /// Mass of all cabins at the start [kg].
    total_kg: f64,
    /// What each node has too much after its flows [kg].
    open_kg: Vec<f64>,
}

impl Closure {
    /// For this network.
    pub fn new(loaded: &Loaded) -> Self {
        let mass = |node: &eclss_core::Node| match node.kind {
            NodeKind::Cabin { volume_m3 } => {
                let pressure = f64::from(loaded.reference_pa) + f64::from(node.start_gauge_pa);
                let gas = f64::from(air::GAS_CONSTANT_J_KG_K) * f64::from(node.temperature_k);
                pressure * f64::from(volume_m3) / gas
            }
            _ => 0.0,
        };
        let total_kg = loaded.nodes.iter().map(mass).sum();
        Self { total_kg, open_kg: vec![0.0; loaded.nodes.len()] }
    }

    /// What the mass ledger lacks, over the mass of all cabins [1]: the larger of what the worst node and what the
    /// whole network lacks. NaN where there is no cabin.
    pub fn read(&mut self, simulator: &Simulator<'_>) -> f64 {
        let network = simulator.network();
        if !network.climate.volumes.is_empty() {
            // A climate books its own transfers: of each gas, of water and of coolant.
            let masses = simulator.ledgers().into_iter().filter(|ledger| ledger.unit == "kg");
            return masses.map(|ledger| ledger.gap().abs()).fold(0.0, f64::max) / self.total_kg;
        }
        let mut whole = 0.0;
        for (node, open) in self.open_kg.iter_mut().enumerate() {
            *open = simulator.node_mass_kg(node) + simulator.fictitious_kg(node);
            whole += *open;
        }
        for (index, line) in network.lines.iter().enumerate() {
            let [taken, given, drained] = simulator.line_sums_kg(index);
            self.open_kg[line.from as usize] += taken;
            self.open_kg[line.to as usize] -= given;
            whole += drained + simulator.held_kg(index);
        }
        let lacks = self.open_kg.iter().fold(whole.abs(), |worst: f64, open| worst.max(open.abs()));
        lacks / self.total_kg
    }
}
