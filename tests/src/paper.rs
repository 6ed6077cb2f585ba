//! The ventilation loop of Qiu et al. 2017 in `f64`, written from the equations and not from our code.
//!
//! Cabin, pipe 1, fan 2, pipe 3, condensing heat exchanger 4, pipe 5, valve 6, back to the cabin. Pressures
//! are gauge against the cabin, which is held. Upstream of the heat exchanger's outlet the flow is U·w.

use crate::tight::Equations;

/// Head of the fan at zero flow [Pa].
pub const FAN_HEAD_PA: f64 = 300.0;
/// Quadratic fall of the fan's head [Pa·s²/kg²].
pub const FAN_SLOPE: f64 = 12_984.201;
/// Resistances of elements 1…5 [Pa·s²/kg²], the fan's as its slope.
pub const RESISTANCES: [f64; 5] = [805.874, FAN_SLOPE, 5_337.527, 16_007.337, 4_577.822];
/// Resistance of the open valve [Pa·s²/kg²].
pub const VALVE_OPEN: f64 = 85.978_462;
/// Exponent of the valve's opening [1].
pub const VALVE_EXPONENT: f64 = 3.134_165;
/// Mass drained at the heat exchanger per mass that leaves it [1].
pub const DRAIN: f64 = 0.0045;
/// Flow upstream of the drain per flow behind it, U [1].
pub const UPSTREAM: f64 = 1.0 + DRAIN;
/// Flow at the start [kg/s]; all pressures start at 0.
pub const START_FLOW_KG_S: f64 = 1e-3;
/// Kinks of the valve's opening [s].
pub const KINKS_S: [f64; 2] = [10.0, 11.0];

/// Returns the valve's opening [1]: open until 10 s, then linear to 2 % at 11 s.
pub fn opening(t_s: f64) -> f64 {
    (1.0 - 0.98 * (t_s - 10.0)).clamp(0.02, 1.0)
}

/// Returns the valve's resistance [Pa·s²/kg²] at `opening` [1].
pub fn valve_resistance(opening: f64) -> f64 {
    VALVE_OPEN * opening.powf(-VALVE_EXPONENT)
}

/// Returns the resistances of elements 1…5 as the flow behind the drain meets them [Pa·s²/kg²].
pub fn felt_resistances() -> [f64; 5] {
    let square = UPSTREAM * UPSTREAM;
    let [r1, r2, r3, r4, r5] = RESISTANCES;
    [r1 * square, r2 * square, r3 * square, r4 * square, r5]
}

/// Returns the exact steady flow at the valve [kg/s] for an opening [1].
pub fn steady_flow_kg_s(opening: f64) -> f64 {
    let others: f64 = felt_resistances().iter().sum();
    (FAN_HEAD_PA / (others + valve_resistance(opening))).sqrt()
}

/// Returns the steady pressures behind elements 1…5 [Pa gauge] for an opening [1].
pub fn steady_pressures_pa(opening: f64) -> [f64; 5] {
    let square = steady_flow_kg_s(opening).powi(2);
    let mut pressure = 0.0;
    let mut element = 0;
    felt_resistances().map(|r| {
        element += 1;
        pressure += if element == 2 { FAN_HEAD_PA } else { 0.0 };
        pressure -= r * square;
        pressure
    })
}

/// The relaxation system: every element's pressure residual as a rate of 1/s; states p1…p5 [Pa] and w [kg/s].
#[derive(Debug, Clone, Copy, Default)]
pub struct Relaxation;

impl Equations for Relaxation {
    fn order(&self) -> usize {
        6
    }

    fn rates(&self, t_s: f64, x: &[f64], rates: &mut [f64]) {
        let square = x[5] * x[5].abs();
        let felt = felt_resistances();
        rates[0] = -x[0] - felt[0] * square;
        rates[1] = x[0] - x[1] + FAN_HEAD_PA - felt[1] * square;
        rates[2] = x[1] - x[2] - felt[2] * square;
        rates[3] = x[2] - x[3] - felt[3] * square;
        rates[4] = x[3] - x[4] - felt[4] * square;
        rates[5] = x[4] - valve_resistance(opening(t_s)) * square;
    }

    fn slope_along(&self, t_s: f64, x: &[f64], v: &[f64], out: &mut [f64]) {
        let slope = 2.0 * x[5].abs() * v[5];
        let felt = felt_resistances();
        out[0] = -v[0] - felt[0] * slope;
        out[1] = v[0] - v[1] - felt[1] * slope;
        out[2] = v[1] - v[2] - felt[2] * slope;
        out[3] = v[2] - v[3] - felt[3] * slope;
        out[4] = v[3] - v[4] - felt[4] * slope;
        out[5] = v[4] - valve_resistance(opening(t_s)) * slope;
    }

    fn scale(&self, index: usize) -> f64 {
        if index == 5 { 1e-3 } else { 1.0 }
    }

    fn kinks_s(&self) -> &[f64] {
        &KINKS_S
    }
}

/// Returns the start state of [`Relaxation`].
pub fn relaxation_start() -> [f64; 6] {
    [0.0, 0.0, 0.0, 0.0, 0.0, START_FLOW_KG_S]
}
