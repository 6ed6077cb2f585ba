//! The general relaxation system in `f64`, written from the equations: any number of nodes and lines, the flow
//! state on any element, mass taken out, flow in both directions.
//!
//! For a line from A to B whose flow w is that of element v, with pressures `q_i = p_i − p_A` behind the elements
//! before v: `q_i' = q_{i−1} − q_i − loss_i`, `w' = φ·(q_{v−1} + p_A − p_B − Σ_{j ≥ v} loss_j)`, and nodes
//! `p' = (Rg·T/V)·Σw`. [`Model::step`] is one explicit step of it with the operator and with the nodes moved by
//! the new flows; as [`Equations`] it is the same system without step and operator.

use crate::tight::Equations;

/// Part of the reference flow below which a power law is continued by the curve that touches it there.
const SMALLEST_PART: f64 = 1e-3;

/// `Δp_ref·(|a|/w_ref)^n`, against the flow a.
#[derive(Debug, Clone, Copy, Default)]
pub struct Power {
    /// Loss at the reference flow [Pa]; 0 for an element without such a loss.
    pub drop_pa: f64,
    /// Reference flow [kg/s].
    pub flow_kg_s: f64,
    /// Exponent n [1].
    pub exponent: f64,
}

impl Power {
    /// Loss [Pa] and its slope [Pa·s/kg] at flow `a` [kg/s].
    fn at(&self, a: f64) -> (f64, f64) {
        if self.drop_pa <= 0.0 {
            return (0.0, 0.0);
        }
        let n = self.exponent;
        let part = (a / self.flow_kg_s).abs();
        let law = |part: f64| self.drop_pa * part.powf(n);
        let slope = |part: f64| n * self.drop_pa / self.flow_kg_s * part.powf(n - 1.0);
        if part >= SMALLEST_PART {
            return (law(part) * a.signum(), slope(part));
        }
        // R·a|a| + L·a with value and slope of the law at the smallest part
        let flow = SMALLEST_PART * self.flow_kg_s;
        let (value, rise) = (law(SMALLEST_PART), slope(SMALLEST_PART));
        let (quadratic, linear) = ((rise * flow - value) / (flow * flow), 2.0 * value / flow - rise);
        (quadratic * a * a.abs() + linear * a, 2.0 * quadratic * a.abs() + linear)
    }
}

/// One element: `p_in − p_out = R·a|a| + L·a + power(a) − head` at its own inlet flow a.
#[derive(Debug, Clone, Copy, Default)]
pub struct Part {
    /// Quadratic resistance R [Pa·s²/kg²].
    pub resistance: f64,
    /// Linear resistance L [Pa·s/kg].
    pub linear: f64,
    /// Loss by a power law.
    pub power: Power,
    /// Head [Pa].
    pub head: f64,
    /// Mass taken out of forward flow per mass that leaves [1].
    pub removal: f64,
}

/// One line.
#[derive(Debug, Clone)]
pub struct Branch {
    /// Node at the inlet.
    pub from: usize,
    /// Node at the outlet.
    pub to: usize,
    /// Elements from inlet to outlet.
    pub parts: Vec<Part>,
    /// The element that carries the flow state.
    pub flow_part: usize,
    /// Driving pressure below which the line's law is linear [Pa]; 0 where a part is not purely quadratic.
    pub laminar_below_pa: f64,
}

impl Branch {
    /// Flow at the inlet of part `index` per flow at the flow part; behind the last part for `parts.len()`.
    /// Nothing is taken out of reversed flow.
    pub fn ratio(&self, index: usize, forward: bool) -> f64 {
        if !forward {
            return 1.0;
        }
        let gain = |part: &Part| 1.0 + part.removal;
        let (v, parts) = (self.flow_part, &self.parts);
        if index <= v {
            parts[index..v].iter().map(gain).product()
        } else {
            1.0 / parts[v..index].iter().map(gain).product::<f64>()
        }
    }

    /// Quadratic resistance of part `index` as the flow state feels it [Pa·s²/kg²].
    pub fn felt(&self, index: usize, forward: bool) -> f64 {
        self.parts[index].resistance * self.ratio(index, forward).powi(2)
    }

    /// Flow below which the line is linear [kg/s].
    pub fn laminar_flow(&self, forward: bool) -> f64 {
        if self.laminar_below_pa <= 0.0 {
            return 0.0;
        }
        let total: f64 = (0..self.parts.len()).map(|index| self.felt(index, forward)).sum();
        (self.laminar_below_pa / total).sqrt()
    }

    /// Pressure lost in part `index` at flow `w` of the flow part [Pa].
    pub fn loss(&self, index: usize, w: f64) -> f64 {
        let (part, forward) = (&self.parts[index], w > 0.0);
        let a = self.ratio(index, forward) * w;
        let square = w * w.abs().max(self.laminar_flow(forward));
        self.felt(index, forward) * square + part.linear * a + part.power.at(a).0 - part.head
    }

    /// Slope of the loss of part `index` over w [Pa·s/kg].
    pub fn slope(&self, index: usize, w: f64) -> f64 {
        let (part, forward) = (&self.parts[index], w > 0.0);
        let ratio = self.ratio(index, forward);
        let laminar = self.laminar_flow(forward);
        let square = if w.abs() < laminar { laminar } else { 2.0 * w.abs() };
        self.felt(index, forward) * square + ratio * (part.linear + part.power.at(ratio * w).1)
    }

    /// Slopes of the rows before the flow part, and of the flow row [Pa·s/kg].
    pub fn slopes(&self, w: f64) -> (Vec<f64>, f64) {
        let v = self.flow_part;
        ((0..v).map(|i| self.slope(i, w)).collect(), (v..self.parts.len()).map(|i| self.slope(i, w)).sum())
    }

    /// Flow [kg/s] at which the line rests under the driving pressure `driving_pa` of its nodes [Pa].
    pub fn steady_flow_kg_s(&self, driving_pa: f64) -> f64 {
        let unbalanced =
            |w: f64| driving_pa - (0..self.parts.len()).map(|index| self.loss(index, w)).sum::<f64>();
        let (mut low, mut high) = (-100.0, 100.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if unbalanced(middle) > 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

/// A network.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// dp/dm of every node [Pa/kg], 0 where the pressure is held.
    pub pressure_per_mass: Vec<f64>,
    /// Lines.
    pub branches: Vec<Branch>,
}

/// State of a [`Model`].
#[derive(Debug, Clone)]
pub struct ModelState {
    /// Node pressures [Pa gauge].
    pub pressures: Vec<f64>,
    /// Pressures q behind the elements before each line's flow part [Pa].
    pub rows: Vec<Vec<f64>>,
    /// Flow of every line [kg/s].
    pub flows: Vec<f64>,
}

impl Model {
    /// Returns the state with these node pressures [Pa] and line flows [kg/s], rows at 0.
    pub fn start(&self, pressures: Vec<f64>, flows: Vec<f64>) -> ModelState {
        let rows = self.branches.iter().map(|branch| vec![0.0; branch.flow_part]).collect();
        ModelState { pressures, rows, flows }
    }

    /// One explicit step of `h` [s] with the operator on every flow row.
    pub fn step(&self, state: &mut ModelState, h: f64) {
        let mut net = vec![0.0; state.pressures.len()];
        for (index, branch) in self.branches.iter().enumerate() {
            let (w, v) = (state.flows[index], branch.flow_part);
            let mut before = 0.0;
            for (part, q) in state.rows[index].iter_mut().enumerate() {
                let old = *q;
                *q += h * (before - old - branch.loss(part, w));
                before = old;
            }
            let driving = before + state.pressures[branch.from] - state.pressures[branch.to];
            let lost: f64 = (v..branch.parts.len()).map(|part| branch.loss(part, w)).sum();
            let phi = (1.0 / (h * branch.slopes(w).1)).min(1.0);
            state.flows[index] = w + h * phi * (driving - lost);
            self.gather(index, state.flows[index], &mut net);
        }
        for ((pressure, slope), net) in state.pressures.iter_mut().zip(&self.pressure_per_mass).zip(net) {
            *pressure += h * slope * net;
        }
    }

    /// Adds what line `index` with flow `w` moves to the nodes' net flows [kg/s].
    fn gather(&self, index: usize, w: f64, net: &mut [f64]) {
        let branch = &self.branches[index];
        net[branch.from] -= w * branch.ratio(0, w > 0.0);
        net[branch.to] += w * branch.ratio(branch.parts.len(), w > 0.0);
    }

    /// Largest unbalanced pressure of any line [Pa] between nodes at `pressures` [Pa] with `flows` [kg/s]: 0
    /// exactly where every line rests.
    pub fn imbalance_pa(&self, pressures: &[f64], flows: &[f64]) -> f64 {
        let line = |(branch, &w): (&Branch, &f64)| {
            let lost: f64 = (0..branch.parts.len()).map(|part| branch.loss(part, w)).sum();
            (pressures[branch.from] - pressures[branch.to] - lost).abs()
        };
        self.branches.iter().zip(flows).map(line).fold(0.0, f64::max)
    }

    /// Where line `index` begins in the flat state of [`Equations`]: its rows, then its flow.
    pub fn first_of_line(&self, index: usize) -> usize {
        let before = self.branches[..index].iter().map(|branch| branch.flow_part + 1);
        self.pressure_per_mass.len() + before.sum::<usize>()
    }
}

/// Flat state: node pressures, then for every line its rows and its flow.
impl Equations for Model {
    fn order(&self) -> usize {
        self.first_of_line(self.branches.len())
    }

    fn rates(&self, _t_s: f64, x: &[f64], rates: &mut [f64]) {
        let nodes = self.pressure_per_mass.len();
        let mut net = vec![0.0; nodes];
        for (index, branch) in self.branches.iter().enumerate() {
            let (first, v) = (self.first_of_line(index), branch.flow_part);
            let w = x[first + v];
            let mut before = 0.0;
            for part in 0..v {
                rates[first + part] = before - x[first + part] - branch.loss(part, w);
                before = x[first + part];
            }
            let lost: f64 = (v..branch.parts.len()).map(|part| branch.loss(part, w)).sum();
            rates[first + v] = before + x[branch.from] - x[branch.to] - lost;
            self.gather(index, w, &mut net);
        }
        for ((rate, slope), net) in rates.iter_mut().zip(&self.pressure_per_mass).zip(net) {
            *rate = slope * net;
        }
    }

    fn slope_along(&self, _t_s: f64, x: &[f64], d: &[f64], out: &mut [f64]) {
        let nodes = self.pressure_per_mass.len();
        let mut net = vec![0.0; nodes];
        for (index, branch) in self.branches.iter().enumerate() {
            let (first, v) = (self.first_of_line(index), branch.flow_part);
            let (w, dw) = (x[first + v], d[first + v]);
            let mut before = 0.0;
            for part in 0..v {
                out[first + part] = before - d[first + part] - branch.slope(part, w) * dw;
                before = d[first + part];
            }
            out[first + v] = before + d[branch.from] - d[branch.to] - branch.slopes(w).1 * dw;
            net[branch.from] -= dw * branch.ratio(0, w > 0.0);
            net[branch.to] += dw * branch.ratio(branch.parts.len(), w > 0.0);
        }
        for ((out, slope), net) in out.iter_mut().zip(&self.pressure_per_mass).zip(net) {
            *out = slope * net;
        }
    }

    fn scale(&self, index: usize) -> f64 {
        let flow = (0..self.branches.len())
            .any(|line| self.first_of_line(line) + self.branches[line].flow_part == index);
        if flow { 1e-3 } else { 1.0 }
    }

    fn kinks_s(&self) -> &[f64] {
        &[]
    }
}
