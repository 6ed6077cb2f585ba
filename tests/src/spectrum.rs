//! Eigenvalues of one explicit step, from the Jacobian of the independent equations by nalgebra.

use crate::paper;
use crate::tight::Equations;
use nalgebra::linalg::balancing;
use nalgebra::{Complex, DMatrix, Schur};

/// Returns ∂f/∂x of `equations` at (`t_s`, `x`).
pub fn jacobian(equations: &impl Equations, t_s: f64, x: &[f64]) -> DMatrix<f64> {
    let order = equations.order();
    let mut matrix = DMatrix::zeros(order, order);
    let (mut unit, mut column) = (vec![0.0; order], vec![0.0; order]);
    for index in 0..order {
        unit.fill(0.0);
        unit[index] = 1.0;
        equations.slope_along(t_s, x, &unit, &mut column);
        matrix.set_column(index, &nalgebra::DVector::from_column_slice(&column));
    }
    matrix
}

/// Returns the eigenvalues of I + h·J for `step` = h and `rates` = J, whose rows the operator has scaled.
///
/// The eigenvalues of J are taken after balancing and only then moved to the disc of the step: pressures in
/// Pa and flows in kg/s differ by orders of magnitude, and a chain of equal rows is nearly defective.
///
/// # Panics
/// Where the iteration converges neither for J nor for its transpose.
pub fn step_eigenvalues(mut rates: DMatrix<f64>, step: f64) -> Vec<Complex<f64>> {
    balancing::balance_parlett_reinsch(&mut rates);
    // Now and then the shifts of the iteration go round in circles; the transpose takes other ones, and a
    // subdiagonal entry of a few roundings may count as zero.
    let schur = [1.0, 8.0, 64.0, 512.0]
        .into_iter()
        .flat_map(|roundings| [(rates.clone(), roundings), (rates.transpose(), roundings)])
        .find_map(|(matrix, roundings)| Schur::try_new(matrix, roundings * f64::EPSILON, 10_000));
    let schur = schur.expect("eigenvalues of a small matrix converge");
    schur.complex_eigenvalues().iter().map(|eigenvalue| eigenvalue * step + 1.0).collect()
}

/// Returns the spectral radius of I + h·J.
pub fn step_radius(rates: DMatrix<f64>, step: f64) -> f64 {
    step_eigenvalues(rates, step).iter().map(|eigenvalue| eigenvalue.norm()).fold(0.0, f64::max)
}

/// The adaptive operator as the paper states it: min(1, 1/(h·|a|)).
pub fn phi(step: f64, diagonal: f64) -> f64 {
    (1.0 / (step * diagonal.abs())).min(1.0)
}

/// Returns the Jacobian of a line with held ends: rows `q_i' = q_{i−1} − q_i − R_i·w|w|` for `rows` = `R_i`
/// and the flow row `w' = φ·(q_last − R·w|w|)` for `own` = R, at a flow of `slope`/2, slope = d(w|w|)/dw = 2|w|.
pub fn line_jacobian(rows: &[f64], own: f64, slope: f64, phi: f64) -> DMatrix<f64> {
    let last = rows.len();
    let mut matrix = DMatrix::zeros(last + 1, last + 1);
    for (index, resistance) in rows.iter().enumerate() {
        matrix[(index, index)] = -1.0;
        matrix[(index, last)] = -resistance * slope;
        matrix[(index + 1, index)] = 1.0;
    }
    if last > 0 {
        matrix[(last, last - 1)] = phi;
    }
    matrix[(last, last)] = -phi * own * slope;
    matrix
}

/// Returns the spectral radius of a step of `h` [s] of the paper's loop at the steady state of a frozen
/// `opening` [1], with the operator where `stabilised`.
pub fn paper_radius(opening: f64, h: f64, stabilised: bool) -> f64 {
    let slope = 2.0 * paper::steady_flow_kg_s(opening);
    let own = paper::valve_resistance(opening);
    let phi = if stabilised { phi(h, own * slope) } else { 1.0 };
    step_radius(line_jacobian(&paper::felt_resistances(), own, slope, phi), h)
}

/// Returns the opening [1] below which a plain step of `h` [s] leaves the unit disc, by bisection.
pub fn paper_edge(h: f64) -> f64 {
    let (mut unstable, mut stable) = (0.02, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (unstable + stable);
        if paper_radius(middle, h, false) > 1.0 { unstable = middle } else { stable = middle }
    }
    stable
}
