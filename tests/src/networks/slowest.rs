//! How long a network takes to settle: its slowest time constant from the linearised equations.
//!
//! What stores stands at *points*, the nodes and the volumes inside lines; between two of them a *reach* has one flow.
//! Capacities C joined by conductances S decay as `C·dp/dt = −K·p`; the slowest time constant is the largest eigenvalue
//! of `K⁻¹·C`, a matrix without a negative entry, found by iteration. Conductances are taken twice, at the steady
//! state and as the chord to the farthest that a reach can be away from it, and the slower result counts.
//!
//! Inertances I make it `J·x = λ·M·x`, x the pressures and flows, M the C and I, J the balances. The slowest rate is that of
//! the eigenvalues ν of √M·J⁻¹·√M, 1/λ all of them: slow ones are the large ones there, and what stores nothing is 0.
//!
//! `adaptive` slows a node of small volume to C/φ, and knows nothing inside a line.

mod loss;
mod swing;

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
            for end in reach.ends {
                secants[end] += reach.losses.secant();
            }
        }
        for (capacity, secant) in self.capacities.iter_mut().zip(secants).filter(|(own, _)| **own > 0.0) {
            *capacity = capacity.max(step_s * secant / THETA);
        }
    }

    /// Points whose pressures are free; the largest volume of a network without boundary is taken as held.
    fn rows(&self) -> Vec<usize> {
        let mut held = self.held.clone();
        if !held.contains(&true) {
            let largest = (0..held.len()).max_by(|&a, &b| self.capacities[a].total_cmp(&self.capacities[b]));
            held[largest.unwrap_or(0)] = true;
        }
        (0..held.len()).filter(|&point| !held[point]).collect()
    }

    /// Largest eigenvalue of K⁻¹·C.
    fn slowest(&self, conductance: impl Fn(&Losses) -> f64) -> f64 {
        let rows = self.rows();
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

/// Returns the slowest time constant [s] on the way from the network's start to `target`, or some that is longer than
/// `most_s`.
pub fn time_constant_s(network: &Network<'_>, target: &Steady, storage: Storage, most_s: f64) -> f64 {
    let parts = Parts::of(network, target, storage);
    let by = 2.0 * parts.away_pa;
    let chord = |losses: &Losses| losses.chord(by).min(losses.chord(-by)).min(losses.slope());
    let stored = parts.slowest(Losses::slope).max(parts.slowest(chord));
    if storage != Storage::Whole || stored > most_s {
        return stored;
    }
    stored.max(parts.slowest_swing_s(chord))
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::components::{CheckValve, Pipe};
    use eclss_core::{AnyComponent, Node, example};

    /// One volume at rest behind a pipe, a volume inside and a second element, to a held node [s].
    fn time_s(volume_m3: f32, inertance_per_m: f32, inside_m3: f32, second: AnyComponent) -> f64 {
        let node = |kind| Node { kind, start_gauge_pa: 0.0, temperature_k: 300.0 };
        let nodes = [node(NodeKind::Boundary), node(NodeKind::Cabin { volume_m3 })];
        let segment = |element, inertance_per_m, outlet_volume_m3| Segment {
            element,
            inertance_per_m,
            outlet_volume_m3,
            first_input: 0,
        };
        let pipe = Pipe::new(1e4).into_any();
        let segments = [segment(second, 0.0, inside_m3), segment(pipe, inertance_per_m, 0.0)];
        let line = example::paper_loop().lines[0];
        let lines = [Line { to: 1, segments: 2, flow_segment: 1, laminar_below_pa: 1.0, ..line }];
        let network = Network { nodes: &nodes, lines: &lines, segments: &segments, ..example::paper_loop() };
        let (gauge_pa, flow_kg_s, rate_pa_s) = (vec![0.0; 2], vec![0.0], vec![0.0; 2]);
        let rest = Steady { gauge_pa, flow_kg_s, rate_pa_s, held: Vec::new(), iterations: 0, residual: 0.0 };
        time_constant_s(&network, &rest, Storage::Whole, f64::INFINITY)
    }

    const PER_M3: f64 = 1.0 / (287.05 * 300.0);
    /// Forward it resists with 1e4, backward it leaks 1e-7 kg/(s·Pa).
    const VALVE: AnyComponent = CheckValve { resistance_pa_s2_kg2: 1e4, reverse_pa_s_kg: 1e7 }.into_any();

    #[test]
    fn one_volume_behind_a_column_is_a_quadratic_equation() {
        // The pipe has all of the resistance that counts: 1e4·√(1 Pa/1e4) at rest.
        let wide = Pipe::new(1e-6).into_any();
        let loss = 1e4 * (1.0f64 / 1e4).sqrt();
        for volume in [1e-4, 1e-2, 1.0, 100.0] {
            for inertance in [1.0, 30.0, 1000.0] {
                let c = volume * PER_M3;
                let root = (c * loss) * (c * loss) - 4.0 * inertance * c;
                let rate = (c * loss - root.max(0.0).sqrt()) / (2.0 * inertance * c);
                let said = time_s(volume as f32, inertance as f32, 0.0, wide);
                // Without inertance it counts too, and is slower where the column only helps.
                let expected = f64::max(1.0 / rate, c * loss);
                assert!(
                    (said / expected - 1.0).abs() < 1e-3,
                    "{volume} m3, {inertance} 1/m: {said} s, not {expected} s"
                );
            }
        }
    }

    #[test]
    fn a_volume_behind_a_check_valve_fills_through_its_leak() {
        // Towards its held node the volume inside the line has only the leak, towards the other only the pipe.
        let said = time_s(1e-4, 0.0, 1e-2, VALVE);
        let leak = 1e7 * (1e-2 + 1e-4) * PER_M3;
        assert!((said / leak - 1.0).abs() < 1e-3, "{said} s, not {leak} s");
    }
}
