//! The iteration of the steady state.

use eclss_core::Element;
use eclss_core::{Fault, Line, Network, Node, NodeKind, Plan, Responsive};

use super::characteristic::Characteristic;
use super::elimination::Matrix;
use super::island::Islands;
use super::memory::Memories;
use super::response::{self, Circumstances};
use super::{Steady, SteadyError, capacity};
use crate::plan::PlanTables;

/// Most Newton iterations.
const MOST: u32 = 400;
/// Most trials of a step.
const HALVINGS: u32 = 8;
/// Rounds for which flows, laws and memories are looked at in turn at the start.
const START_ROUNDS: u32 = 40;
/// Slope by which a source of flow stands in the matrix, so that no node is without an equation [kg/(s·Pa)].
const SOURCE_KG_S_PA: f64 = 1e-18;
/// Flow of a source below which it is none [kg/s].
const SMALLEST_SOURCE_KG_S: f64 = 1e-12;
/// Pressure difference below which nothing is told apart [Pa].
const SMALLEST_SPAN_PA: f64 = 1e-3;
/// Residual at which there is nothing left to gain.
const EXACT: f64 = 1e-15;
/// Residual above which another search is worth its time.
const FINE: f64 = 1e-9;
/// Largest residual of an answer: a law that follows its flow is known in single precision only.
const ENOUGH: f64 = 1e-6;

/// Where the iteration stands.
#[derive(Debug, Clone)]
struct Point {
    /// Pressure of every node [Pa gauge].
    gauge: Vec<f64>,
    /// Flow of every line [kg/s].
    flow: Vec<f64>,
    /// dp/dt of every closed island [Pa/s].
    rate: Vec<f64>,
    /// Law of every line at its flow.
    laws: Vec<Characteristic>,
    /// Largest imbalance of any line and node as part of what could be there [1].
    residual: f64,
}

/// The equations.
struct Problem<'n, E> {
    network: &'n Network<'n, E>,
    inputs: &'n [f32],
    islands: &'n Islands,
    /// Connections with one node of every closed island held.
    tables: PlanTables,
    capacity: Vec<f64>,
    /// Gas that sources bring into every node [kg/s].
    supplied: Vec<f64>,
    /// Closed island of every node, `usize::MAX` for a node of one that is held.
    island: Vec<usize>,
    /// What the elements with a memory stand at.
    memory: Vec<f32>,
    /// Largest pressure difference that boundaries and heads can make [Pa].
    span_pa: f64,
    /// Pressure that sources can build up beyond it [Pa]; 0 without any.
    built_pa: f64,
    /// Flow that it would drive through each line, and through all lines of each node [kg/s].
    line_kg_s: Vec<f64>,
    node_kg_s: Vec<f64>,
}

/// Finds the steady flows.
pub(super) fn solve<E: Element>(
    network: &Network<'_, E>,
    inputs: &[f32],
    islands: &Islands,
) -> Result<Steady, SteadyError> {
    let mut problem = Problem::new(network, inputs, islands);
    let mut memories = Memories::new(network);
    loop {
        problem.memory.clone_from(&memories.values);
        let (point, iterations) = problem.balance()?;
        let at = |entry: &Responsive, line: &Line| {
            let here = problem.circumstances(entry, line, &point.gauge);
            let w = point.flow[entry.line as usize];
            (w, response::ends(network, inputs, line, w, &here).0)
        };
        if memories.agree(network, inputs, at)? {
            return problem.answer(point, iterations);
        }
    }
}

/// Flow that the start's pressures drive through every line, with every memory where it then stands.
pub(super) fn at_start<E: Element>(network: &Network<'_, E>, inputs: &[f32], islands: &Islands) -> Vec<f64> {
    let mut problem = Problem::new(network, inputs, islands);
    let mut memories = Memories::new(network);
    let gauge: Vec<f64> = network.nodes.iter().map(|node| f64::from(node.start_gauge_pa)).collect();
    let mut flow = vec![0.0; network.lines.len()];
    for _ in 0..START_ROUNDS {
        let laws = problem.laws(&gauge, &flow);
        for ((w, law), line) in flow.iter_mut().zip(laws).zip(network.lines) {
            *w = law.driven(Problem::<E>::drop_pa(line, &gauge));
        }
        let at = |entry: &Responsive, line: &Line| {
            let (here, w) = (problem.circumstances(entry, line, &gauge), flow[entry.line as usize]);
            (w, response::ends(network, inputs, line, w, &here).0)
        };
        if !matches!(memories.agree(network, inputs, at), Ok(false)) {
            break;
        }
        problem.memory.clone_from(&memories.values);
    }
    flow
}

impl<'n, E: Element> Problem<'n, E> {
    /// Flows and pressures in balance, with all that switches as it stands, and the iterations it took.
    ///
    /// Halved steps hardly move where a balance lies far outside all pressures that there are, as behind a closed
    /// valve of a drained cabin, and stop short of the kink of a check valve at rest. Whole steps find both, but not
    /// from everywhere.
    fn balance(&self) -> Result<(Point, u32), SteadyError> {
        let (mut best, mut iterations) = self.search(self.start(), HALVINGS);
        for from_start in [false, true] {
            // NaN is not good either.
            let good = if from_start { best.residual <= ENOUGH } else { best.residual <= FINE };
            if !good {
                let (point, more) = self.search(if from_start { self.start() } else { best.clone() }, 1);
                iterations += more;
                if point.residual < best.residual || best.residual.is_nan() {
                    best = point;
                }
            }
        }
        // What sources feed may rest far above all pressures of the start, as before a choked orifice.
        for share in [0.1, 1.0, 10.0] {
            let good = best.residual <= ENOUGH;
            if self.built_pa > 0.0 && !good {
                let (point, more) = self.search(self.raised(share * self.built_pa), HALVINGS);
                iterations += more;
                if point.residual < best.residual || best.residual.is_nan() {
                    best = point;
                }
            }
        }
        if best.residual > ENOUGH || best.residual.is_nan() {
            let (line, imbalance_pa) = self.worst_line(&best);
            return Err(SteadyError::NotFound { line, imbalance_pa });
        }
        Ok((best, iterations))
    }

    /// The best point on the way from `point`, and the iterations it took; every step is tried `trials` times, each
    /// half as long as the last.
    fn search(&self, mut point: Point, trials: u32) -> (Point, u32) {
        let mut iterations = 0;
        // Rounding makes the residual jitter near the answer: three steps that gain nothing end the search.
        let mut idle = 0;
        let mut best = point.clone();
        while iterations < MOST && idle < 3 && best.residual > EXACT {
            iterations += 1;
            point = self.improve(&point, trials);
            if point.residual < 0.9 * best.residual {
                idle = 0;
            } else if best.residual < ENOUGH {
                idle += 1;
            }
            if point.residual < best.residual {
                best = point.clone();
            }
        }
        (best, iterations)
    }

    fn circumstances<'c>(&'c self, entry: &'c Responsive, line: &Line, gauge: &[f64]) -> Circumstances<'c> {
        let nodes = [line.from as usize, line.to as usize];
        let reference = f64::from(self.network.reference_pa);
        Circumstances {
            entry,
            nodes_pa: nodes.map(|node| f64::max(reference + gauge[node], 0.0)),
            temperatures_k: nodes.map(|node| {
                let fixed = self.network.nodes[node].temperature_k;
                self.network.climate.virtual_start_k(node, fixed).unwrap_or(fixed)
            }),
            memory: &self.memory,
        }
    }

    fn new(network: &'n Network<'n, E>, inputs: &'n [f32], islands: &'n Islands) -> Self {
        let mut nodes: Vec<Node> = network.nodes.to_vec();
        let mut island = vec![usize::MAX; nodes.len()];
        for (index, closed) in islands.closed.iter().enumerate() {
            nodes[closed.pinned as usize].kind = NodeKind::Boundary;
            for &node in &closed.nodes {
                island[node as usize] = index;
            }
        }
        let tables = PlanTables::new(&nodes, network.lines, network.segments);
        let capacity = network.nodes.iter().map(capacity).collect();
        let memory = vec![0.0; network.memory_slots()];
        let mut problem = Self {
            network,
            inputs,
            islands,
            tables,
            capacity,
            supplied: super::supplied_kg_s(network, inputs),
            island,
            memory,
            span_pa: 0.0,
            built_pa: 0.0,
            line_kg_s: Vec::new(),
            node_kg_s: Vec::new(),
        };
        problem.set_scales();
        problem
    }

    /// Span of pressures, and the flows that it would drive: what imbalances are measured by.
    fn set_scales(&mut self) {
        let network = self.network;
        let gauge: Vec<f64> = network.nodes.iter().map(|node| f64::from(node.start_gauge_pa)).collect();
        let laws = self.laws(&gauge, &vec![1e-3; network.lines.len()]);
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for ((node, &gauge), &apart) in network.nodes.iter().zip(&gauge).zip(&self.islands.apart) {
            // A leak to a vacuum without any supply drives by what is in the cabins.
            let drives = node.kind == NodeKind::Boundary || !network.responsive.is_empty();
            if drives && !apart {
                low = low.min(gauge);
                high = high.max(gauge);
            }
        }
        let sourced = || laws.iter().filter_map(|law| law.source_kg_s);
        let own = || laws.iter().filter(|law| law.source_kg_s.is_none());
        let heads = own().map(|law| law.head.abs()).fold(0.0, f64::max);
        self.span_pa = ((high - low).max(0.0) + heads).max(SMALLEST_SPAN_PA);
        // What sources bring may leave through any line, and builds up what pressure that takes.
        let fed = self.supplied.iter().copied().chain(sourced());
        let supplied: f64 = fed.map(f64::abs).sum();
        let losses = own().map(|law| law.loss(supplied).abs()).fold(0.0, f64::max);
        self.built_pa = if supplied > 0.0 { losses.min(f64::from(Fault::GAUGE_LIMIT_PA)) } else { 0.0 };
        let driven = |law: &Characteristic| {
            law.source_kg_s.unwrap_or_else(|| law.driven(self.span_pa - law.head).max(supplied))
        };
        self.line_kg_s = laws.iter().map(driven).collect();
        self.node_kg_s = vec![f64::MIN_POSITIVE; network.nodes.len()];
        for (line, flow) in network.lines.iter().zip(&self.line_kg_s) {
            self.node_kg_s[line.from as usize] += flow.abs();
            self.node_kg_s[line.to as usize] += flow.abs();
        }
    }

    /// Start values: pressures as they are, flows as large as any pressure difference could make them, because
    /// Newton's method for a root comes down on it from above.
    fn start(&self) -> Point {
        let gauge = self.network.nodes.iter().map(|node| f64::from(node.start_gauge_pa)).collect();
        let rate = vec![0.0; self.islands.closed.len()];
        self.at(gauge, self.line_kg_s.clone(), rate)
    }

    /// The start with all pressures that are not held so much higher.
    fn raised(&self, by_pa: f64) -> Point {
        let nodes = self.network.nodes.iter();
        let gauge = nodes.map(|node| {
            f64::from(node.start_gauge_pa) + if node.kind == NodeKind::Boundary { 0.0 } else { by_pa }
        });
        let rate = vec![0.0; self.islands.closed.len()];
        self.at(gauge.collect(), self.line_kg_s.clone(), rate)
    }

    /// Laws of all lines at their flows and at the pressures of their nodes.
    fn laws(&self, gauge: &[f64], flow: &[f64]) -> Vec<Characteristic> {
        let mut responsive = self.network.responsive.iter().peekable();
        let law = |((index, line), &w): ((u32, &Line), &f64)| {
            let entry = responsive.next_if(|entry| entry.line == index);
            let here = entry.map(|entry| self.circumstances(entry, line, gauge));
            Characteristic::at(self.network, self.inputs, line, w, here.as_ref())
        };
        (0u32..).zip(self.network.lines).zip(flow).map(law).collect()
    }

    fn drop_pa(line: &Line, gauge: &[f64]) -> f64 {
        gauge[line.from as usize] - gauge[line.to as usize]
    }

    /// Completes a point: laws at its flows, and how far it is from balance.
    fn at(&self, gauge: Vec<f64>, flow: Vec<f64>, rate: Vec<f64>) -> Point {
        let laws = self.laws(&gauge, &flow);
        let mut net = self.own(&rate);
        let mut residual = 0.0f64;
        for ((line, law), &w) in self.network.lines.iter().zip(&laws).zip(&flow) {
            let drop = Self::drop_pa(line, &gauge);
            // By what the line holds back, where sources have built up more than the span.
            let scale = self.span_pa.max(drop.abs().min(self.built_pa));
            let lack = match law.source_kg_s {
                None => (drop - law.loss(w)).abs() / scale,
                Some(flow) => (w - flow).abs() / flow.abs().max(SMALLEST_SOURCE_KG_S),
            };
            residual = worse(residual, lack);
            net[line.from as usize] -= law.inlet * w;
            net[line.to as usize] += law.outlet * w;
        }
        for ((node, net), scale) in self.network.nodes.iter().zip(&net).zip(&self.node_kg_s) {
            if node.kind != NodeKind::Boundary {
                residual = worse(residual, net.abs() / scale);
            }
        }
        Point { gauge, flow, rate, laws, residual }
    }

    /// What every node's balance has beside its lines: what sources bring, less what goes into its own storage [kg/s].
    fn own(&self, rate: &[f64]) -> Vec<f64> {
        let of = |((&island, &capacity), &supplied): ((&usize, &f64), &f64)| {
            supplied - capacity * rate.get(island).copied().unwrap_or(0.0)
        };
        self.island.iter().zip(&self.capacity).zip(&self.supplied).map(of).collect()
    }

    /// One damped Newton step.
    fn improve(&self, point: &Point, trials: u32) -> Point {
        let (gauge, flow, rate) = self.newton(point);
        let mut share = 1.0;
        let mut best: Option<Point> = None;
        for _ in 0..trials {
            let toward = |from: &[f64], to: &[f64]| -> Vec<f64> {
                from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect()
            };
            let trial =
                self.at(toward(&point.gauge, &gauge), toward(&point.flow, &flow), toward(&point.rate, &rate));
            let better = best.as_ref().is_none_or(|best| trial.residual < best.residual);
            if better {
                best = Some(trial);
            }
            if best.as_ref().is_some_and(|best| best.residual < point.residual) {
                break;
            }
            share *= 0.5;
        }
        best.unwrap_or_else(|| point.clone())
    }

    /// Pressures, flows and rates that solve the equations linearised at `point`.
    fn newton(&self, point: &Point) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let rows = self.tables.order.len();
        let row = |node: u32| Some(self.tables.row_of[node as usize] as usize).filter(|row| *row < rows);
        let mut matrix = Matrix::new(&self.tables);
        let mut known: Vec<f64> =
            self.tables.order.iter().map(|&node| self.supplied[node as usize]).collect();
        // Of every line: 1/slope, and the flow at unchanged pressures.
        let mut lines = Vec::with_capacity(self.network.lines.len());
        let all = self.network.lines.iter().zip(&point.laws).zip(&point.flow).zip(&self.tables.stamps);
        for (((line, law), &w), &[from_from, from_to, to_from, to_to]) in all {
            let drop = Self::drop_pa(line, &point.gauge);
            let b = match law.source_kg_s {
                None => 1.0 / law.slope(w.abs().max(law.driven(drop).abs())),
                Some(_) => SOURCE_KG_S_PA,
            };
            let ahead = law.source_kg_s.unwrap_or_else(|| w + b * (drop - law.loss(w)));
            let [by_from, by_to] = law.feels.map(|feels| b * feels);
            matrix.add(from_from, law.inlet * by_from);
            matrix.add(from_to, -law.inlet * by_to);
            matrix.add(to_from, -law.outlet * by_from);
            matrix.add(to_to, law.outlet * by_to);
            if let Some(row) = row(line.from) {
                known[row] -= law.inlet * ahead;
            }
            if let Some(row) = row(line.to) {
                known[row] += law.outlet * ahead;
            }
            if line.from == line.to && from_from != Plan::NOWHERE {
                // A loop through one node feels no pressure of it, unless its density does.
                matrix.add(from_from, -(law.inlet * by_to + law.outlet * by_from));
            }
            let moved = if law.source_kg_s.is_some() { [0.0; 2] } else { [by_from, by_to] };
            lines.push((moved, ahead));
        }
        matrix.factorise();
        matrix.solve(&mut known);
        let mut storing: Vec<f64> = self.tables.order.iter().map(|&node| self.capacity_of(node)).collect();
        matrix.solve(&mut storing);
        let rate = self.rates(point, &lines, &known, &storing);
        let mut gauge = point.gauge.clone();
        for (row, &node) in self.tables.order.iter().enumerate() {
            let rate = rate.get(self.island[node as usize]).copied().unwrap_or(0.0);
            gauge[node as usize] += known[row] - rate * storing[row];
        }
        let change = |node: u32| gauge[node as usize] - point.gauge[node as usize];
        let flow = self.network.lines.iter().zip(&lines).map(|(line, ([by_from, by_to], ahead))| {
            ahead + (by_from * change(line.from) - by_to * change(line.to))
        });
        (gauge.clone(), flow.collect(), rate)
    }

    /// Capacity of a node that stores in its island's common rate; 0 where an island is held.
    fn capacity_of(&self, node: u32) -> f64 {
        if self.island[node as usize] == usize::MAX { 0.0 } else { self.capacity[node as usize] }
    }

    /// Rates of the closed islands: what arrives at the node that stands for the level is stored there too.
    fn rates(&self, point: &Point, lines: &[([f64; 2], f64)], known: &[f64], storing: &[f64]) -> Vec<f64> {
        let rate_of = |closed: &super::island::Closed| {
            let is_supplied = closed.nodes.iter().any(|&node| self.supplied[node as usize].abs() > 0.0);
            let loses =
                [&closed.drains, &closed.leaks, &closed.sources].iter().any(|lines| !lines.is_empty());
            if !loses && !is_supplied {
                return 0.0;
            }
            let pinned = closed.pinned;
            // Net inflow of the pinned node with the rate at 0, and how much of it every unit of rate costs.
            let (mut net, mut cost) = (self.supplied[pinned as usize], self.capacity_of(pinned));
            let moved =
                |node: u32, list: &[f64]| list.get(self.tables.row_of[node as usize] as usize).copied();
            for ((line, law), &([by_from, by_to], ahead)) in
                self.network.lines.iter().zip(&point.laws).zip(lines)
            {
                let change = |list: &[f64]| {
                    by_from * moved(line.from, list).unwrap_or(0.0)
                        - by_to * moved(line.to, list).unwrap_or(0.0)
                };
                let gain = match (line.from == pinned, line.to == pinned) {
                    (true, true) => law.outlet - law.inlet,
                    (true, false) => -law.inlet,
                    (false, true) => law.outlet,
                    (false, false) => continue,
                };
                net += gain * (ahead + change(known));
                cost += gain * change(storing);
            }
            net / cost
        };
        self.islands.closed.iter().map(rate_of).collect()
    }

    /// The line whose pressures are farthest from balance.
    fn worst_line(&self, point: &Point) -> (u32, f64) {
        let lines = self.network.lines.iter().zip(&point.laws).zip(&point.flow);
        let lack = |law: &Characteristic, drop: f64, w| {
            if law.source_kg_s.is_some() { 0.0 } else { drop - law.loss(w) }
        };
        let lacks = lines.map(|((line, law), &w)| lack(law, Self::drop_pa(line, &point.gauge), w));
        (0u32..).zip(lacks).fold((0, 0.0), |worst: (u32, f64), (index, lack)| {
            if lack.abs() > worst.1.abs() || lack.is_nan() { (index, lack) } else { worst }
        })
    }

    /// Sets the level of closed islands by their mass and looks for pressures that cannot be.
    fn answer(&self, mut point: Point, iterations: u32) -> Result<Steady, SteadyError> {
        let mut rate_pa_s = vec![0.0; point.gauge.len()];
        for (closed, rate) in self.islands.closed.iter().zip(&point.rate) {
            let (mut mass, mut capacity) = (0.0, 0.0);
            for &node in &closed.nodes {
                let node = node as usize;
                mass += self.capacity[node]
                    * (point.gauge[node] - f64::from(self.network.nodes[node].start_gauge_pa));
                capacity += self.capacity[node];
            }
            for &node in &closed.nodes {
                point.gauge[node as usize] -= mass / capacity;
                rate_pa_s[node as usize] = *rate;
            }
        }
        let reference = f64::from(self.network.reference_pa);
        for (node, gauge) in (0u32..).zip(&point.gauge) {
            let pressure_pa = reference + gauge;
            let unknown = self.network.nodes[node as usize].kind != NodeKind::Boundary;
            if unknown && pressure_pa < -ENOUGH * reference {
                return Err(SteadyError::BelowVacuum { node, pressure_pa });
            }
            if unknown && *gauge > f64::from(Fault::GAUGE_LIMIT_PA) {
                return Err(SteadyError::BeyondRange { node, pressure_pa });
            }
        }
        let Point { gauge: gauge_pa, flow: flow_kg_s, residual, .. } = point;
        Ok(Steady { gauge_pa, flow_kg_s, rate_pa_s, held: Vec::new(), iterations, residual })
    }
}

/// The larger of two sizes; NaN where one is.
fn worse(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}
