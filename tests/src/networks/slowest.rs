//! How long a network takes to settle: its slowest time constant from the linearised equations.
//!
//! Nodes with capacities C joined by conductances S decay as `C·dp/dt = −K·p`; the slowest time constant is the
//! largest eigenvalue of `K⁻¹·C`, a matrix without a negative entry, found by iteration. Conductances are taken
//! twice, at the steady state and as the chord to the farthest that a line can be away from it, and the slower
//! result counts. `adaptive` slows a node of small volume to C/φ.

use eclss_core::{Element, Line, Network, NodeKind, Segment};
use eclss_network_file::steady::Steady;
use nalgebra::{DMatrix, DVector};

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

/// Pressures that count as rest when a line's direction is asked for [Pa]: ten times what a settled one may be off.
const REST_PA: f64 = 1e-3;

/// Loss of a line near rest and at flow, in one direction: `R·w·max(|w|, w_lin) + L·w`.
#[derive(Clone, Copy)]
struct Loss {
    quadratic: f64,
    linear: f64,
    laminar: f64,
    head: f64,
}

impl Loss {
    fn of(network: &Network<'_>, line: &Line, w: f64, forward: bool) -> Self {
        let mut loss = Self { quadratic: 0.0, linear: 0.0, laminar: 0.0, head: 0.0 };
        for segment in network.segments_of(line) {
            let inputs = network.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
            let at = eclss_core::Operating::plain(inputs, w as f32);
            let law = if forward { segment.element.law(&at) } else { segment.element.reverse_law(&at) };
            loss.quadratic += f64::from(law.resistance);
            loss.linear += f64::from(law.linear);
            loss.head += f64::from(law.head);
        }
        // A line of closed check valves alone has nothing but linear leaks.
        loss.laminar =
            (f64::from(line.laminar_below_pa) / loss.quadratic.max(f64::MIN_POSITIVE)).sqrt().min(1e6);
        loss
    }

    /// Flow at the driving pressure `y`, head included [kg/s].
    fn flow(&self, y: f64) -> f64 {
        let laminar = y / (self.quadratic * self.laminar + self.linear);
        if laminar.abs() < self.laminar {
            return laminar;
        }
        2.0 * y / (self.linear + (self.linear * self.linear + 4.0 * self.quadratic * y.abs()).sqrt())
    }

    fn at(&self, w: f64) -> f64 {
        self.quadratic * w * w.abs().max(self.laminar) + self.linear * w
    }

    fn slope(&self, w: f64) -> f64 {
        self.quadratic * if w.abs() > self.laminar { 2.0 * w.abs() } else { self.laminar } + self.linear
    }
}

/// Losses of a line around a flow in both directions, which differ where it has check valves.
pub(super) struct Losses {
    forward: Loss,
    reverse: Loss,
    /// The flow [kg/s].
    w: f64,
}

impl Losses {
    pub(super) fn of(network: &Network<'_>, line: &Line, w: f64) -> Self {
        Self { forward: Loss::of(network, line, w, true), reverse: Loss::of(network, line, w, false), w }
    }

    /// Those of the part of a line that has the flow of its flow segment: what lies between two volumes, below the
    /// whole line's laminar flow.
    pub(super) fn of_stretch(network: &Network<'_>, line: &Line, w: f64, storage: Storage) -> Self {
        let whole = Self::of(network, line, w);
        if storage != Storage::Whole {
            return whole;
        }
        let segments = network.segments_of(line);
        let flow = line.flow_segment as usize;
        let stores = |segment: &Segment| segment.outlet_volume_m3 > 0.0;
        let first = segments[..flow].iter().rposition(stores).map_or(0, |before| before + 1);
        let last = segments[flow..].iter().position(stores).map_or(segments.len() - 1, |on| flow + on);
        let part = Line {
            first_segment: line.first_segment + first as u32,
            segments: (last - first + 1) as u32,
            flow_segment: (flow - first) as u32,
            ..*line
        };
        let part = Self::of(network, &part, w);
        let forward = Loss { laminar: whole.forward.laminar, ..part.forward };
        let reverse = Loss { laminar: whole.reverse.laminar, ..part.reverse };
        Self { forward, reverse, w }
    }

    fn toward(&self, w: f64) -> &Loss {
        if w < 0.0 { &self.reverse } else { &self.forward }
    }

    /// Difference between the pressures that drive this flow and another [Pa].
    pub(super) fn apart_pa(&self, other: f64) -> f64 {
        (self.toward(self.w).at(self.w) - self.toward(other).at(other)).abs()
    }

    /// Pressure that drives the flow, its head included [Pa].
    fn drive_pa(&self) -> f64 {
        self.toward(self.w).at(self.w)
    }

    /// Slope of flow over pressure at the flow; the smaller of both directions where it rests [kg/(s·Pa)].
    fn slope(&self) -> f64 {
        if self.drive_pa().abs() > REST_PA {
            return 1.0 / self.toward(self.w).slope(self.w);
        }
        (1.0 / self.forward.slope(self.w)).min(1.0 / self.reverse.slope(self.w))
    }

    /// The larger of both directions where it rests: inertance swings longest through what is open [kg/(s·Pa)].
    fn widest(&self) -> f64 {
        if self.drive_pa().abs() > REST_PA {
            return self.slope();
        }
        (1.0 / self.forward.slope(self.w)).max(1.0 / self.reverse.slope(self.w))
    }

    /// Slope of the chord from the flow to that at a drive which is larger `by` [Pa].
    fn chord(&self, by: f64) -> f64 {
        let y = self.drive_pa() + by;
        if by.abs() > 0.0 { (self.toward(y).flow(y) - self.w) / by } else { f64::MAX }
    }

    /// w/y as the operator looks at it: the larger of both directions [kg/(s·Pa)].
    fn secant(&self) -> f64 {
        let y = self.drive_pa().abs().max(f64::MIN_POSITIVE);
        (self.forward.flow(y) / y).max(self.reverse.flow(y) / y)
    }
}

/// Returns the slowest time constant [s] on the way from the network's start to `target`.
pub fn time_constant_s(network: &Network<'_>, target: &Steady, storage: Storage) -> f64 {
    let away = network.nodes.iter().zip(&target.gauge_pa).filter(|(node, _)| node.kind != NodeKind::Boundary);
    let away = away.map(|(node, gauge)| (f64::from(node.start_gauge_pa) - gauge).abs()).fold(0.0, f64::max);
    let losses: Vec<_> =
        network.lines.iter().zip(&target.flow_kg_s).map(|(line, &w)| Losses::of(network, line, w)).collect();
    let mut near = Vec::new();
    let mut far = Vec::new();
    let mut secants = vec![0.0; network.nodes.len()];
    let mut columns_s = 0.0f64;
    for (line, loss) in network.lines.iter().zip(&losses) {
        near.push(loss.slope());
        far.push(loss.chord(2.0 * away).min(loss.chord(-2.0 * away)).min(loss.slope()));
        secants[line.from as usize] += loss.secant();
        secants[line.to as usize] += loss.secant();
        let inertance: f64 = network.segments_of(line).iter().map(|s| f64::from(s.inertance_per_m)).sum();
        columns_s = columns_s.max(2.0 * inertance * loss.widest());
    }
    let capacities = capacities(network, storage, &secants);
    let nodes = slowest(network, &capacities, &near).max(slowest(network, &capacities, &far));
    if storage == Storage::Whole { nodes.max(columns_s) } else { nodes }
}

fn capacities(network: &Network<'_>, storage: Storage, secants: &[f64]) -> Vec<f64> {
    let gas = |temperature: f32| 287.05 * f64::from(temperature);
    let of = |(node, secant): (&eclss_core::Node, &f64)| match (node.kind, storage) {
        (NodeKind::Cabin { volume_m3 }, Storage::Whole) => f64::from(volume_m3) / gas(node.temperature_k),
        (NodeKind::Cabin { volume_m3 }, Storage::Slowed(step_s)) => {
            (f64::from(volume_m3) / gas(node.temperature_k)).max(step_s * secant / THETA)
        }
        _ => 0.0,
    };
    let mut capacities: Vec<f64> = network.nodes.iter().zip(secants).map(of).collect();
    if storage == Storage::Whole {
        // A volume inside a line is filled through less of the line than either of its nodes is.
        for line in network.lines {
            let inside: f64 = network.segments_of(line).iter().map(|s| f64::from(s.outlet_volume_m3)).sum();
            for node in [line.from as usize, line.to as usize] {
                capacities[node] += inside / gas(network.nodes[node].temperature_k);
            }
        }
    }
    capacities
}

/// Largest eigenvalue of K⁻¹·C; the largest volume of a network without boundary is taken as held.
fn slowest(network: &Network<'_>, capacities: &[f64], conductances: &[f64]) -> f64 {
    let mut held: Vec<bool> = network.nodes.iter().map(|node| node.kind == NodeKind::Boundary).collect();
    if !held.contains(&true) {
        let largest = (0..held.len()).max_by(|&a, &b| capacities[a].total_cmp(&capacities[b]));
        held[largest.unwrap_or(0)] = true;
    }
    let rows: Vec<usize> = (0..held.len()).filter(|&node| !held[node]).collect();
    if rows.is_empty() {
        return 0.0;
    }
    let row_of = |node: u32| rows.binary_search(&(node as usize)).ok();
    let mut matrix = DMatrix::<f64>::zeros(rows.len(), rows.len());
    for (line, &conductance) in
        network.lines.iter().zip(conductances).filter(|(line, _)| line.from != line.to)
    {
        let (from, to) = (row_of(line.from), row_of(line.to));
        for end in [from, to].into_iter().flatten() {
            matrix[(end, end)] += conductance;
        }
        if let (Some(from), Some(to)) = (from, to) {
            matrix[(from, to)] -= conductance;
            matrix[(to, from)] -= conductance;
        }
    }
    let factors = matrix.lu();
    let mut shape = DVector::from_element(rows.len(), 1.0);
    let mut slowest = 0.0;
    for _ in 0..60 {
        let stored = DVector::from_fn(rows.len(), |row, _| capacities[rows[row]] * shape[row]);
        let Some(next) = factors.solve(&stored) else { return f64::INFINITY };
        slowest = next.amax();
        if slowest <= 0.0 || slowest.is_nan() {
            return slowest;
        }
        shape = next / slowest;
    }
    slowest
}
