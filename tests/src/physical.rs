//! Reference experiments P and P0 in `f64`: the paper's loop with inertance and, in P, duct volumes.
//!
//! Written from the equations and not from our code. States are the pressures behind elements 1…5 (gauge
//! against the held cabin) and the flows of elements 1…6; in P0 the line stores nothing and has one flow.

use crate::paper::{self, DRAIN, FAN_HEAD_PA, KINKS_S, RESISTANCES, START_FLOW_KG_S, UPSTREAM};
use crate::tight::Equations;

/// Length over flow area of every duct, D = 0.1 m and L = 2 m [1/m].
pub const INERTANCE: f64 = 2.0 / (std::f64::consts::PI * 0.0025);
/// Volume of every duct [m³].
pub const VOLUME_M3: f64 = std::f64::consts::PI * 0.0025 * 2.0;
/// dp/dm of such a volume at 295.15 K [Pa/kg].
pub const PER_MASS: f64 = 287.05 * 295.15 / VOLUME_M3;

/// What the drain does when the flow behind it runs backward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drain {
    /// It puts mass back, as in the reference values of P and P0.
    Signed,
    /// It stops, as in the product.
    Clipped,
}

/// Experiment P: eleven states.
#[derive(Debug, Clone, Copy)]
pub struct Ringing(pub Drain);

impl Ringing {
    /// Returns the start state.
    pub fn start() -> Vec<f64> {
        let mut state = vec![0.0; 11];
        state[5..].fill(START_FLOW_KG_S);
        state
    }

    fn removal(self, flow: f64) -> f64 {
        if self.0 == Drain::Signed || flow > 0.0 { DRAIN } else { 0.0 }
    }

    fn resistance(opening: f64, element: usize) -> f64 {
        RESISTANCES.get(element).copied().unwrap_or_else(|| paper::valve_resistance(opening))
    }

    /// Writes f(x) with the valve at `opening` [1], wherever it comes from.
    pub fn rates_at(self, opening: f64, x: &[f64], rates: &mut [f64]) {
        let (pressure, flow) = x.split_at(5);
        for behind in 0..5 {
            let mut net = flow[behind] - flow[behind + 1];
            if behind == 3 {
                net -= self.removal(flow[4]) * flow[4];
            }
            rates[behind] = PER_MASS * net;
        }
        for element in 0..6 {
            let before = if element == 0 { 0.0 } else { pressure[element - 1] };
            let after = if element == 5 { 0.0 } else { pressure[element] };
            let head = if element == 1 { FAN_HEAD_PA } else { 0.0 };
            let loss = Self::resistance(opening, element) * flow[element] * flow[element].abs();
            rates[5 + element] = (before - after + head - loss) / INERTANCE;
        }
    }

    /// Writes ∂f/∂x·`v` with the valve at `opening` [1].
    pub fn slope_at(self, opening: f64, x: &[f64], v: &[f64], out: &mut [f64]) {
        let flow = &x[5..];
        for behind in 0..5 {
            let mut net = v[5 + behind] - v[6 + behind];
            if behind == 3 {
                net -= self.removal(flow[4]) * v[9];
            }
            out[behind] = PER_MASS * net;
        }
        for element in 0..6 {
            let before = if element == 0 { 0.0 } else { v[element - 1] };
            let after = if element == 5 { 0.0 } else { v[element] };
            let slope = 2.0 * Self::resistance(opening, element) * flow[element].abs();
            out[5 + element] = (before - after - slope * v[5 + element]) / INERTANCE;
        }
    }
}

impl Equations for Ringing {
    fn order(&self) -> usize {
        11
    }

    fn rates(&self, t_s: f64, x: &[f64], rates: &mut [f64]) {
        self.rates_at(paper::opening(t_s), x, rates);
    }

    fn slope_along(&self, t_s: f64, x: &[f64], v: &[f64], out: &mut [f64]) {
        self.slope_at(paper::opening(t_s), x, v, out);
    }

    fn scale(&self, index: usize) -> f64 {
        if index < 5 { 1.0 } else { 1e-3 }
    }

    fn kinks_s(&self) -> &[f64] {
        &KINKS_S
    }
}

/// Experiment P0: one state, the flow at the valve.
#[derive(Debug, Clone, Copy)]
pub struct Lumped;

impl Lumped {
    fn resistance(t_s: f64) -> f64 {
        let others: f64 = paper::felt_resistances().iter().sum();
        others + paper::valve_resistance(paper::opening(t_s))
    }

    /// Four elements carry U·w, two carry w.
    const TOTAL_INERTANCE: f64 = (4.0 * UPSTREAM + 2.0) * INERTANCE;
}

impl Equations for Lumped {
    fn order(&self) -> usize {
        1
    }

    fn rates(&self, t_s: f64, x: &[f64], rates: &mut [f64]) {
        rates[0] = (FAN_HEAD_PA - Self::resistance(t_s) * x[0] * x[0].abs()) / Self::TOTAL_INERTANCE;
    }

    fn slope_along(&self, t_s: f64, x: &[f64], v: &[f64], out: &mut [f64]) {
        out[0] = -2.0 * Self::resistance(t_s) * x[0].abs() * v[0] / Self::TOTAL_INERTANCE;
    }

    fn scale(&self, _index: usize) -> f64 {
        1e-3
    }

    fn kinks_s(&self) -> &[f64] {
        &KINKS_S
    }
}
