//! How long a network takes to settle: its slowest time constant from the linearised equations.
//!
//! What stores stands at *points*, the nodes and the volumes inside lines; between two of them a *reach* has one flow.
//! Capacities C joined by conductances S decay as `C·dp/dt = −K·p`; the slowest time constant is the largest eigenvalue
//! of `K⁻¹·C`, a matrix without a negative entry, found by iteration. Conductances are taken twice, at the steady
//! state and as the chord to the farthest that a reach can be away from it, and the slower result counts.
//!
//! Inertances I add `I·dw/dt = Δp − w/S`. Where a rate λ is not real the energies in C and in I are equal, so that its
//! real part is −½·Σ(w²/S)/Σ(I·w²): swings decay no slower than with 2·I·S. A real rate −μ is at least the
//! smallest 1/(I·S), or else `w = Δp/(1/S − μ·I)` has conductances of no less than S: no slower than without I.
//!
//! `adaptive` slows a node of small volume to C/φ, and knows nothing inside a line.

mod loss;

use std::ops::Range;

use eclss_core::{Line, Network, NodeKind, Segment};
use eclss_network_file::steady::Steady;
use nalgebra::{DMatrix, DVector};

pub(super) use self::loss::Losses;

/// What stores in a network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Storage {
    /// Nodes, slowed by the operator at this step [s]; lines hold nothing.
    Slowed(f64),
    /// Nodes, volumes inside lines, and inertances.
    Whole,
}

/// Safety factor of the operator.
const THETA: f64 = 0.8;

/// Segments of a line that have one flow, one range for every reach.
fn reaches(network: &Network<'_>, line: &Line, storage: Storage) -> Vec<Range<usize>> {
    let segments = network.segments_of(line);
    // What stands behind the last segment is the node.
    let stores = |&last: &usize| segments[last].outlet_volume_m3 > 0.0 && last + 1 < segments.len();
    let mut first = 0;
    let joints = (0..segments.len()).filter(|last| storage == Storage::Whole && stores(last));
    let mut ranges: Vec<_> = joints.map(|last| std::mem::replace(&mut first, last + 1)..last + 1).collect();
    ranges.push(first..segments.len());
    ranges
}

/// Losses of the reach that has the flow of a line, which is `w` [kg/s].
pub(super) fn losses_of_flow(network: &Network<'_>, line: &Line, w: f64, storage: Storage) -> Losses {
    let own = |range: &Range<usize>| range.contains(&(line.flow_segment as usize));
    let range = reaches(network, line, storage).into_iter().find(own).unwrap_or(0..0);
    Losses::of(network, line, range, w)
}

/// What connects two points.
struct Reach {
    ends: [usize; 2],
    losses: Losses,
    inertance_per_m: f64,
}

/// Points and reaches of a network at its steady state.
struct Parts {
    reaches: Vec<Reach>,
    /// Capacity of every point [kg/Pa]; 0 where nothing is stored or the pressure is held.
    capacities: Vec<f64>,
    /// Whether the pressure is held.
    held: Vec<bool>,
    /// Farthest that any pressure starts from its steady state [Pa].
    away_pa: f64,
}

impl Parts {
    fn of(network: &Network<'_>, target: &Steady, storage: Storage) -> Self {
        let gas = |node: u32| 287.05 * f64::from(network.nodes[node as usize].temperature_k);
        let mut parts = Self { reaches: Vec::new(), capacities: Vec::new(), held: Vec::new(), away_pa: 0.0 };
        for ((index, node), gauge) in (0..).zip(network.nodes).zip(&target.gauge_pa) {
            let volume_m3 = if let NodeKind::Cabin { volume_m3 } = node.kind { volume_m3 } else { 0.0 };
            let held = node.kind == NodeKind::Boundary;
            parts.point(f64::from(volume_m3) / gas(index), held, f64::from(node.start_gauge_pa) - gauge);
        }
        for (line, &w) in network.lines.iter().zip(&target.flow_kg_s) {
            let start = f64::from(network.nodes[line.from as usize].start_gauge_pa);
            let (mut from, mut gauge) = (line.from as usize, target.gauge_pa[line.from as usize]);
            let segments = network.segments_of(line);
            for range in reaches(network, line, storage) {
                let last = &segments[range.end - 1];
                let inertances = segments[range.clone()].iter().map(|s: &Segment| s.inertance_per_m);
                let inertance_per_m = inertances.map(f64::from).sum();
                let ends_line = range.end == segments.len();
                let losses = Losses::of(network, line, range, w);
                gauge -= losses.drop_pa();
                let to = if ends_line {
                    line.to as usize
                } else {
                    parts.point(f64::from(last.outlet_volume_m3) / gas(line.from), false, start - gauge)
                };
                parts.reaches.push(Reach { ends: [from, to], losses, inertance_per_m });
                from = to;
            }
        }
        if let Storage::Slowed(step_s) = storage {
            parts.slow(step_s);
        }
        parts
    }

    /// Adds a point that starts so far from its steady state [Pa]. Returns its index.
    fn point(&mut self, capacity: f64, held: bool, away_pa: f64) -> usize {
        self.capacities.push(capacity);
        self.held.push(held);
        if !held {
            self.away_pa = self.away_pa.max(away_pa.abs());
        }
        self.held.len() - 1
    }

    /// Gives every node the capacity that the operator makes of its own.
    fn slow(&mut self, step_s: f64) {
        let mut secants = vec![0.0; self.held.len()];
        for reach in &self.reaches {
            reach.ends.iter().for_each(|&end| secants[end] += reach.losses.secant());
        }
        for (capacity, secant) in self.capacities.iter_mut().zip(secants).filter(|(own, _)| **own > 0.0) {
            *capacity = capacity.max(step_s * secant / THETA);
        }
    }

    /// Largest eigenvalue of K⁻¹·C; the largest volume of a network without boundary is taken as held.
    fn slowest(&self, conductance: impl Fn(&Losses) -> f64) -> f64 {
        let mut held = self.held.clone();
        if !held.contains(&true) {
            let largest = (0..held.len()).max_by(|&a, &b| self.capacities[a].total_cmp(&self.capacities[b]));
            held[largest.unwrap_or(0)] = true;
        }
        let rows: Vec<usize> = (0..held.len()).filter(|&point| !held[point]).collect();
        if rows.is_empty() {
            return 0.0;
        }
        let mut matrix = DMatrix::<f64>::zeros(rows.len(), rows.len());
        for reach in self.reaches.iter().filter(|reach| reach.ends[0] != reach.ends[1]) {
            let conductance = conductance(&reach.losses);
            let ends = reach.ends.map(|end| rows.binary_search(&end).ok());
            for end in ends.into_iter().flatten() {
                matrix[(end, end)] += conductance;
            }
            if let [Some(from), Some(to)] = ends {
                matrix[(from, to)] -= conductance;
                matrix[(to, from)] -= conductance;
            }
        }
        let factors = matrix.lu();
        let mut shape = DVector::from_element(rows.len(), 1.0);
        let mut slowest = 0.0;
        for _ in 0..60 {
            let stored = DVector::from_fn(rows.len(), |row, _| self.capacities[rows[row]] * shape[row]);
            let Some(next) = factors.solve(&stored) else { return f64::INFINITY };
            slowest = next.amax();
            if slowest <= 0.0 || slowest.is_nan() {
                return slowest;
            }
            shape = next / slowest;
        }
        slowest
    }
}

/// Returns the slowest time constant [s] on the way from the network's start to `target`.
pub fn time_constant_s(network: &Network<'_>, target: &Steady, storage: Storage) -> f64 {
    let parts = Parts::of(network, target, storage);
    let by = 2.0 * parts.away_pa;
    let chord = |losses: &Losses| losses.chord(by).min(losses.chord(-by)).min(losses.slope());
    let stored = parts.slowest(Losses::slope).max(parts.slowest(chord));
    if storage != Storage::Whole {
        return stored;
    }
    let swings = parts.reaches.iter().map(|reach| 2.0 * reach.inertance_per_m * reach.losses.widest());
    swings.fold(stored, f64::max)
}
