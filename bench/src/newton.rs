//! The paper's baseline: one Newton iteration of implicit Euler with a dense matrix.
//!
//! The relaxation system `q_i' = q_{i−1} − q_i − R_i·w|w|`, `w' = q_last + p_A − p_B − R·w|w|` in `f64`; the
//! matrix `I − h·J` is written out in full and factorised by LU with partial pivoting. One iteration a step is
//! the least that an implicit method can do; a solver that iterates to a tolerance does it several times.

use nalgebra::{DMatrix, DVector};

/// A chain of n − 1 equal pipes and a valve between two held pressures.
#[derive(Debug, Clone)]
pub(crate) struct DenseNewton {
    state: DVector<f64>,
    pipe: f64,
    valve: f64,
    drive_pa: f64,
}

impl DenseNewton {
    /// Returns the chain of `equations` equations at `flow_kg_s` [kg/s] with rows at 0.
    pub(crate) fn new(equations: usize, flow_kg_s: f64) -> Self {
        let mut state = DVector::zeros(equations);
        state[equations - 1] = flow_kg_s;
        Self { state, pipe: 39_713.0 / (equations - 1) as f64, valve: 85.978_462, drive_pa: 300.0 }
    }

    /// Advances by `step_s` [s]. Returns the flow [kg/s]; `None` where the matrix is singular.
    pub(crate) fn step(&mut self, step_s: f64) -> Option<f64> {
        let last = self.state.len() - 1;
        let w = self.state[last];
        let (square, slope) = (w * w.abs(), 2.0 * w.abs());
        let mut rates = DVector::zeros(last + 1);
        let mut matrix = DMatrix::identity(last + 1, last + 1);
        let mut before = 0.0;
        for row in 0..last {
            rates[row] = before - self.state[row] - self.pipe * square;
            before = self.state[row];
            matrix[(row, row)] += step_s;
            matrix[(row, last)] = step_s * self.pipe * slope;
            matrix[(row + 1, row)] = -step_s;
        }
        rates[last] = before + self.drive_pa - self.valve * square;
        matrix[(last, last)] += step_s * self.valve * slope;
        rates *= step_s;
        if !matrix.lu().solve_mut(&mut rates) {
            return None;
        }
        self.state += rates;
        Some(self.state[last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settles_where_all_losses_eat_the_drive() {
        let mut newton = DenseNewton::new(6, 0.05);
        let mut flow = 0.0;
        for _ in 0..400 {
            flow = newton.step(0.1).unwrap();
        }
        assert!((flow / (300.0f64 / (39_713.0 + 85.978_462)).sqrt() - 1.0).abs() < 1e-6, "{flow}");
    }
}
