//! Tight solutions: a right-hand side in `f64`, integrated by diffsol to a tolerance far below any bar.
//!
//! Integration starts anew at every kink of the inputs, where a multi-step method's history is worth nothing.
//! Two methods of different families are offered so that a test can show that the answer is the equations'
//! and not the solver's.

use diffsol::error::DiffsolError;
use diffsol::{MatrixCommon, NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod};

type M = NalgebraMat<f64>;
type Lu = NalgebraLU<f64>;

/// A system of ordinary differential equations `x' = f(t, x)` in SI units.
pub trait Equations {
    /// Number of states.
    fn order(&self) -> usize;

    /// Writes f(t, x) for time `t_s` [s].
    fn rates(&self, t_s: f64, x: &[f64], rates: &mut [f64]);

    /// Writes ∂f/∂x·`v` at (t, x).
    fn slope_along(&self, t_s: f64, x: &[f64], v: &[f64], out: &mut [f64]);

    /// Absolute tolerance per unit of relative tolerance: the size below which state `index` does not matter.
    fn scale(&self, index: usize) -> f64;

    /// Times [s] at which the inputs have a kink or a jump, ascending.
    fn kinks_s(&self) -> &[f64];
}

/// Which of diffsol's implicit methods integrates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Backward differentiation of variable order and step.
    Bdf,
    /// Singly diagonally implicit Runge-Kutta of order 4(3).
    Esdirk34,
}

/// Integrates from `start` at `from_s` [s] and returns the states at each of `times_s` [s] (ascending, none
/// before `from_s`) with relative tolerance `tolerance`.
pub fn solve(
    equations: &impl Equations,
    family: Family,
    tolerance: f64,
    from_s: f64,
    start: &[f64],
    times_s: &[f64],
) -> Result<Vec<Vec<f64>>, DiffsolError> {
    let mut answers = Vec::with_capacity(times_s.len());
    let (mut begin, mut state) = (from_s, start.to_vec());
    let mut wanted = times_s;
    let Some(&last) = times_s.last() else { return Ok(answers) };
    let ends = equations.kinks_s().iter().copied().filter(|&kink| from_s < kink && kink < last);
    for end in ends.chain([last]) {
        let here = wanted.iter().take_while(|&&time| time <= end).count();
        let (inside, later) = wanted.split_at(here);
        // The end of the piece is always asked for, because the next one starts there.
        let mut times: Vec<f64> = inside.iter().copied().filter(|&time| time > begin).collect();
        answers.extend(inside.iter().filter(|&&time| time <= begin).map(|_| state.clone()));
        let extra = times.last() != Some(&end);
        if extra {
            times.push(end);
        }
        if end > begin {
            let mut piece = solve_piece(equations, family, tolerance, begin, &state, &times)?;
            state = piece.last().cloned().unwrap_or(state);
            if extra {
                piece.pop();
            }
            answers.append(&mut piece);
        }
        (begin, wanted) = (end, later);
    }
    Ok(answers)
}

/// One piece without a kink inside; `times_s` ascend and end at the piece's end.
fn solve_piece(
    equations: &impl Equations,
    family: Family,
    tolerance: f64,
    from_s: f64,
    start: &[f64],
    times_s: &[f64],
) -> Result<Vec<Vec<f64>>, DiffsolError> {
    let order = equations.order();
    let problem = OdeBuilder::<M>::new()
        .t0(from_s)
        .rtol(tolerance)
        .atol((0..order).map(|index| tolerance * equations.scale(index)))
        .h0(1e-6)
        .rhs_implicit(
            |x, _, t, rates| equations.rates(t, x, rates),
            |x, _, t, v, out| equations.slope_along(t, x, v, out),
        )
        .init(|_, _, x| x.copy_from_slice(start), order)
        .build()?;
    let (columns, _) = match family {
        Family::Bdf => problem.bdf::<Lu>()?.solve_dense(times_s)?,
        Family::Esdirk34 => problem.esdirk34::<Lu>()?.solve_dense(times_s)?,
    };
    let states = columns.inner();
    Ok((0..times_s.len()).map(|column| (0..order).map(|row| states[(row, column)]).collect()).collect())
}
