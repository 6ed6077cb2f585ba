//! The floor: the least that an equation with a square-root law can cost in scalar arithmetic.
//!
//! Every quasi-steady flow needs one square root and one division. [`pass`] does just that for every equation:
//! it reads a driving pressure and a resistance, calls `libm::sqrtf` once, divides once and writes a flow.
//! Nothing is carried from one equation to the next, so the processor may overlap them as it likes; the unit
//! that takes roots and divides is what limits it. `libm::sqrtf` is one `sqrtss` on x86-64 written as inline
//! assembly, which a compiler can neither widen to a vector nor leave out, and that keeps the loop scalar
//! without any hint inside it. [`std::hint::black_box`] stands outside the loop only, around the whole
//! arrays: it keeps the result alive and slows nothing down.

use std::hint::black_box;

/// Arrays for as many equations as there are flows.
#[derive(Debug, Clone)]
pub struct Floor {
    drive_pa: Vec<f32>,
    resistance: Vec<f32>,
    flow_kg_s: Vec<f32>,
}

impl Floor {
    /// Returns arrays for `equations` equations with ordinary values: 1…100 Pa, 800…5800 Pa·s²/kg².
    pub fn new(equations: usize) -> Self {
        let spread = |index: usize, period: usize| (index * 31 % period) as f32 / period as f32;
        Self {
            drive_pa: (0..equations).map(|index| 1.0 + 99.0 * spread(index, 97)).collect(),
            resistance: (0..equations).map(|index| 800.0 + 5_000.0 * spread(index, 89)).collect(),
            flow_kg_s: vec![0.0; equations],
        }
    }

    /// Goes over all equations once.
    pub fn run(&mut self) {
        pass(black_box(&self.drive_pa), black_box(&self.resistance), black_box(&mut self.flow_kg_s));
        black_box(&mut self.flow_kg_s);
    }
}

/// Writes `√(drive/resistance)` [kg/s] as `√drive/√R` would be with the root of R known: one root and one
/// division for every equation.
#[inline(never)]
pub fn pass(drive_pa: &[f32], resistance: &[f32], flow_kg_s: &mut [f32]) {
    for ((flow, drive), resistance) in flow_kg_s.iter_mut().zip(drive_pa).zip(resistance) {
        *flow = libm::sqrtf(*drive) / *resistance;
    }
}
