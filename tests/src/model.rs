//! The general relaxation system in `f64`, written from the equations: any number of nodes and lines, the flow
//! state on any element, mass taken out, flow in both directions.
//!
//! For a line from A to B whose flow w is that of element v, with pressures `q_i = p_i − p_A` behind the elements
//! before v: `q_i' = q_{i−1} − q_i − loss_i`, `w' = φ·(q_{v−1} + p_A − p_B − Σ_{j ≥ v} loss_j)`, and nodes
//! `p += h·(Rg·T/V)·Σw` with the new flows.

/// One element: `p_in − p_out = R·a|a| + L·a − head` at its own inlet flow a.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    /// Quadratic resistance R [Pa·s²/kg²].
    pub resistance: f64,
    /// Linear resistance L [Pa·s/kg].
    pub linear: f64,
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
    /// Driving pressure below which the line's law is linear [Pa].
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

    /// Linear resistance of part `index` as the flow state feels it [Pa·s/kg].
    pub fn felt_linear(&self, index: usize, forward: bool) -> f64 {
        self.parts[index].linear * self.ratio(index, forward)
    }

    /// The line's whole quadratic resistance with a linear loss at flow `w` [kg/s] counted as quadratic.
    fn total(&self, w: f64) -> f64 {
        let forward = w > 0.0;
        (0..self.parts.len())
            .map(|i| self.felt(i, forward) + self.felt_linear(i, forward) / w.abs().max(1e-6))
            .sum()
    }

    /// Flow below which the line is linear [kg/s] when it flows at `w`.
    pub fn laminar_flow(&self, w: f64) -> f64 {
        (self.laminar_below_pa / self.total(w)).sqrt()
    }

    /// Pressure lost in part `index` at flow `w` of the flow part [Pa].
    fn loss(&self, index: usize, w: f64) -> f64 {
        let square = w * w.abs().max(self.laminar_flow(w));
        let forward = w > 0.0;
        self.felt(index, forward) * square + self.felt_linear(index, forward) * w - self.parts[index].head
    }

    /// Slope of the loss of part `index` over w [Pa·s/kg].
    pub fn slope(&self, index: usize, w: f64) -> f64 {
        let laminar = self.laminar_flow(w);
        let square = if w.abs() > laminar { 2.0 * w.abs() } else { laminar };
        self.felt(index, w > 0.0) * square + self.felt_linear(index, w > 0.0)
    }

    /// φ of the flow row at flow `w` and step `h`: from the flow row's own quadratic loss, 2·R·|w|.
    fn phi(&self, w: f64, h: f64) -> f64 {
        let forward = w > 0.0;
        let linear = |i| self.felt_linear(i, forward) / w.abs().max(1e-6);
        let own: f64 = (self.flow_part..self.parts.len()).map(|i| self.felt(i, forward) + linear(i)).sum();
        (1.0 / (2.0 * h * own * w.abs().max(self.laminar_flow(w)))).min(1.0)
    }
}

/// A network.
#[derive(Debug, Clone)]
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
    /// Mass taken out so far [kg].
    pub removed_kg: f64,
}

impl Model {
    /// Returns the state with these node pressures [Pa] and line flows [kg/s], rows at 0.
    pub fn start(&self, pressures: Vec<f64>, flows: Vec<f64>) -> ModelState {
        let rows = self.branches.iter().map(|branch| vec![0.0; branch.flow_part]).collect();
        ModelState { pressures, rows, flows, removed_kg: 0.0 }
    }

    /// One explicit step of `h` [s] with the operator on every flow row.
    pub fn step(&self, state: &mut ModelState, h: f64) {
        let mut net = vec![0.0; state.pressures.len()];
        for (index, branch) in self.branches.iter().enumerate() {
            let (w, v) = (state.flows[index], branch.flow_part);
            let rows = &mut state.rows[index];
            let mut before = 0.0;
            for (part, q) in rows.iter_mut().enumerate() {
                let old = *q;
                *q += h * (before - old - branch.loss(part, w));
                before = old;
            }
            let driving = before + state.pressures[branch.from] - state.pressures[branch.to];
            let lost: f64 = (v..branch.parts.len()).map(|part| branch.loss(part, w)).sum();
            let flow = w + h * branch.phi(w, h) * (driving - lost);
            state.flows[index] = flow;
            let (inlet, outlet) =
                (flow * branch.ratio(0, flow > 0.0), flow * branch.ratio(branch.parts.len(), flow > 0.0));
            net[branch.from] -= inlet;
            net[branch.to] += outlet;
            state.removed_kg += h * (inlet - outlet);
        }
        for ((pressure, slope), net) in state.pressures.iter_mut().zip(&self.pressure_per_mass).zip(net) {
            *pressure += h * slope * net;
        }
    }

    /// Largest unbalanced pressure of any line at a state [Pa]: 0 exactly at a steady state.
    pub fn imbalance_pa(&self, state: &ModelState) -> f64 {
        let line = |(index, branch): (usize, &Branch)| {
            let lost: f64 = (0..branch.parts.len()).map(|part| branch.loss(part, state.flows[index])).sum();
            (state.pressures[branch.from] - state.pressures[branch.to] - lost).abs()
        };
        self.branches.iter().enumerate().map(line).fold(0.0, f64::max)
    }
}
