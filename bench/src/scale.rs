//! How the cost of `adaptive` and `tr-bdf2` grows with the number of nodes.

use std::hint::black_box;

use eclss_core::Method;

use crate::floor::Floor;
use crate::runner::still_trusted;
use crate::turns::{Contender, take};
use crate::{Description, Failure, Progress, Runner};

/// Nodes of the chains.
pub const SCALE_SIZES: [usize; 4] = [6, 100, 1_000, 10_000];

/// Step [µs].
const STEP_US: u32 = 1_000;
/// Turns of every contender.
const TURNS: usize = 101;
/// Methods that take any topology.
const METHODS: [Method; 2] = [Method::Adaptive, Method::TrBdf2];

/// What one method costs on one network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleRow {
    /// Nodes with a volume.
    pub nodes: usize,
    /// Equations of the floor: nodes and lines.
    pub equations: usize,
    /// Name of the method; `floor` for one scalar root and one division per equation.
    pub method: &'static str,
    /// Median time per step [ns].
    pub median_ns: f64,
    /// Median over the turns of the time over the floor's in the same turn [1].
    pub ratio_to_floor: f64,
}

/// Measures `adaptive` and `tr-bdf2` on chains of `sizes` nodes (≥ 1 each), a line between every two
/// neighbours, each against the floor over 2·nodes equations. Rows by size, then by method.
pub fn scale_costs(sizes: &[usize], progress: &mut dyn FnMut(Progress)) -> Result<Vec<ScaleRow>, Failure> {
    let mut rows = Vec::new();
    for (done, &nodes) in sizes.iter().enumerate() {
        progress(Progress { done, total: sizes.len(), equations: 2 * nodes });
        rows.extend(measure(&Description::node_chain(nodes), nodes, 2 * nodes, TURNS)?);
    }
    progress(Progress { done: sizes.len(), total: sizes.len(), equations: 0 });
    Ok(rows)
}

/// Measures both methods on a mesh of `side` × `side` nodes against the floor over all nodes and lines.
pub fn mesh_cost(side: usize) -> Result<Vec<ScaleRow>, Failure> {
    let (nodes, lines) = (side * side, 2 * side * (side - 1));
    measure(&Description::mesh(side), nodes, nodes + lines, 11)
}

/// Returns the exponent of cost growth of `method`: the slope of log(time) over log(nodes) between the two largest
/// sizes at least ten times apart, since a small network is dominated by what every step costs once.
pub fn exponent(rows: &[ScaleRow], method: &str) -> Option<f64> {
    let mut of_method: Vec<&ScaleRow> = rows.iter().filter(|row| row.method == method).collect();
    of_method.sort_by_key(|row| row.nodes);
    let largest = of_method.pop()?;
    let smaller = of_method.into_iter().rev().find(|row| 10 * row.nodes <= largest.nodes)?;
    let growth = (largest.median_ns / smaller.median_ns).ln();
    Some(growth / (largest.nodes as f64 / smaller.nodes as f64).ln())
}

fn measure(
    description: &Description,
    nodes: usize,
    equations: usize,
    turns: usize,
) -> Result<Vec<ScaleRow>, Failure> {
    let network = description.network();
    let mut floor = Floor::new(equations);
    let mut runners = METHODS.map(|method| Runner::new(&network, method));
    let mut simulators = Vec::new();
    for (method, runner) in METHODS.into_iter().zip(&mut runners) {
        simulators.push(runner.simulator(&network, method, STEP_US)?);
    }
    let mut contenders = vec![Contender::new(|calls| (0..calls).for_each(|_| floor.run()))];
    contenders.extend(simulators.iter_mut().map(|simulator| {
        Contender::new(move |calls| {
            for _ in 0..calls {
                black_box(simulator.step());
            }
        })
    }));
    take(&mut contenders, turns);
    let names = std::iter::once("floor").chain(METHODS.into_iter().map(Method::name));
    let rows = contenders
        .iter()
        .zip(names)
        .map(|(contender, method)| ScaleRow {
            nodes,
            equations,
            method,
            median_ns: contender.median_ns(),
            ratio_to_floor: contender.ratio_to(&contenders[0]),
        })
        .collect();
    drop(contenders);
    simulators.iter().try_for_each(still_trusted)?;
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_proportional_to_the_size_has_exponent_one() {
        let row = |nodes: usize, median_ns: f64| ScaleRow {
            nodes,
            equations: 2 * nodes,
            method: "adaptive",
            median_ns,
            ratio_to_floor: 1.0,
        };
        let rows = [row(10, 500.0), row(1_000, 7_000.0), row(10_000, 70_000.0)];
        assert!((exponent(&rows, "adaptive").unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(exponent(&rows, "tr-bdf2"), None);
    }
}
