//! A modern implicit solver of variable step and order as a peer: diffsol's BDF with a sparse LU.
//!
//! It solves the relaxation system of [`crate::Description::paper_chain`] in `f64` through the closing of the valve, and
//! must deliver the state every millisecond. It is given what helps it: the exact Jacobian with its sparsity, a
//! sparse factorisation, a steady state to start from, tolerances of engineering size, and interpolation
//! within its own longer steps. Many frames then cost nothing but the interpolation, and some hold a whole
//! step with a factorisation: the mean is its strength, the worst frame is what a real-time loop must allow for.

use diffsol::{FaerSparseLU, FaerSparseMat, OdeBuilder, OdeSolverMethod};

use crate::Failure;
use crate::chains::{FRAMES, REPEATS, STEP_US, timed};
use crate::description::{CLOSING_US, REMAINS_OPEN};
use crate::turns::{Frames, frames};

type Matrix = FaerSparseMat<f64>;
type Lu = FaerSparseLU<f64>;

/// Relative tolerance [1].
const RELATIVE: f64 = 1e-4;
/// Absolute tolerances of a pressure [Pa] and of a flow [kg/s].
const ABSOLUTE: [f64; 2] = [1e-2, 1e-6];

const PIPES: f64 = 39_713.0;
const DRIVE_PA: f64 = 300.0;

/// Resistance of the valve at `t_s` [s] [Pa·s²/kg²].
fn valve(t_s: f64) -> f64 {
    let [begins, ends] = CLOSING_US.map(|time_us| time_us as f64 * 1e-6);
    let closed = ((t_s - begins) / (ends - begins)).clamp(0.0, 1.0);
    let opening = 1.0 - closed * (1.0 - f64::from(REMAINS_OPEN));
    85.978_462 * opening.powf(-3.134_165)
}

/// Frames of BDF on a chain of `n` equations.
pub(crate) fn bdf_frames(n: usize) -> Result<Frames, Failure> {
    let peer = |error: diffsol::error::DiffsolError| Failure::Peer(error.to_string());
    let last = n - 1;
    let pipe = PIPES / last as f64;
    let steady = (DRIVE_PA / (PIPES + valve(0.0))).sqrt();
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(RELATIVE)
        .atol((0..n).map(|index| ABSOLUTE[usize::from(index == last)]))
        .h0(1e-4)
        .rhs_implicit(
            move |x, _, t, rates| {
                let square = x[last] * x[last].abs();
                let mut before = 0.0;
                for (rate, q) in rates[..last].iter_mut().zip(x) {
                    *rate = before - q - pipe * square;
                    before = *q;
                }
                rates[last] = before + DRIVE_PA - valve(t) * square;
            },
            move |x, _, t, v, out| {
                let slope = 2.0 * x[last].abs() * v[last];
                let mut before = 0.0;
                for (row, along) in out[..last].iter_mut().zip(v) {
                    *row = before - along - pipe * slope;
                    before = *along;
                }
                out[last] = before - valve(t) * slope;
            },
        )
        .init(
            move |_, _, x| {
                for (index, q) in x.iter_mut().enumerate() {
                    *q = -pipe * steady * steady * (index + 1) as f64;
                }
                x[last] = steady;
            },
            n,
        )
        .build()
        .map_err(peer)?;
    frames(REPEATS, |frame| {
        let mut solver = problem.bdf::<Lu>().map_err(peer)?;
        for index in 1..=FRAMES {
            let until_s = index as f64 * f64::from(STEP_US) * 1e-6;
            let mut outcome = Ok(());
            frame(timed(|| {
                outcome = (|| {
                    while solver.state().t < until_s {
                        solver.step()?;
                    }
                    std::hint::black_box(solver.interpolate(until_s)?);
                    Ok(())
                })();
            }));
            outcome.map_err(peer)?;
        }
        Ok(())
    })
}
