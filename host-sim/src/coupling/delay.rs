//! A volume that hardware loads with delay: how strong the hardware may be.
//!
//! A node takes in the flow that hardware reported d ticks after it saw the pressure. With e the deviation from rest,
//!
//! ```text
//! y_k = y_{k−1} + a·(e_{k−d} − y_{k−1})                  the channel's filter, a = h/(τ + h)
//! e_{k+1} = e_k − g·(α0·y_k + α1·y_{k−1} + α2·y_{k−2})   g = h·c·G, α the method's mean of the input over a step
//! ```
//!
//! With α0 = 1 and without filter this is `z^(d+1) − z^d + g = 0`, stable up to `g = 2·sin(π/(2·(2d + 1)))`: 1, 0.618,
//! 0.445 for d = 1, 2, 3. Everything else is found by bisection on the eigenvalues. Derived for a node alone; lines of
//! the plant with losses only damp it. What inertance does is not covered.

use eclss_core::Method;
use nalgebra::DMatrix;

use crate::linear::{eigenvalues, spectral_radius};

/// What lies between a node's pressure and the flow that comes back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loop {
    /// Whole ticks of delay; at least the one of the exchange.
    pub ticks: u32,
    /// Time constant of the filter over the step [1]; 0 for none.
    pub filter: f64,
    /// α0, α1, α2 [1].
    pub mean: [f64; 3],
}

/// Returns how the mean of a measured flow over a step is made of this tick's sample and the two before [1].
pub fn mean_over_step(method: Method, continued: bool) -> [f64; 3] {
    match (method, continued) {
        (Method::Euler | Method::Relaxation | Method::Adaptive, _)
        | (Method::ImplicitEuler | Method::TrBdf2, false) => [1.0, 0.0, 0.0],
        // The flow is that at the step's end.
        (Method::ImplicitEuler, true) => [2.0, -1.0, 0.0],
        // √½ of that at (1 − √½)·h and 1 − √½ of that at the end: on a straight line the mean, in the middle.
        (Method::TrBdf2, true) => [1.5, -0.5, 0.0],
    }
}

impl Loop {
    /// Delay of a slow signal [ticks]; what a continued input gains is subtracted.
    pub fn delay_ticks(&self) -> f64 {
        f64::from(self.ticks) + self.filter + self.mean[1] + 2.0 * self.mean[2]
    }

    /// Returns the largest h·c·G with which the loop is stable.
    pub fn limit(&self) -> f64 {
        if self.filter <= 0.0 && self.mean[1].abs() + self.mean[2].abs() <= 0.0 {
            return 2.0 * (std::f64::consts::PI / (2.0 * (2.0 * f64::from(self.ticks) + 1.0))).sin();
        }
        let stable = |gain: f64| {
            let values = eigenvalues(&self.matrix(gain));
            values.is_some_and(|values| spectral_radius(&values) < 1.0)
        };
        // A small gain is stable in any case; from there to the first that is not.
        let (mut inside, mut outside) = (0.0, 4.0);
        let mut gain = 1e-3;
        while gain < outside {
            if stable(gain) {
                inside = gain;
            } else {
                outside = gain;
            }
            gain *= 1.05;
        }
        for _ in 0..40 {
            let middle = 0.5 * (inside + outside);
            if stable(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    }

    /// One tick as a matrix over `e_k … e_{k−d}`, `y_{k−1}`, `y_{k−2}`.
    fn matrix(&self, gain: f64) -> DMatrix<f64> {
        let d = self.ticks as usize;
        let a = 1.0 / (1.0 + self.filter);
        let [now, last, before] = self.mean;
        let y = d + 1;
        let mut matrix = DMatrix::zeros(d + 3, d + 3);
        // y_k = a·e_{k−d} + (1 − a)·y_{k−1}
        matrix[(y, d)] = a;
        matrix[(y, y)] = 1.0 - a;
        matrix[(y + 1, y)] = 1.0;
        matrix[(0, 0)] = 1.0;
        matrix[(0, d)] -= gain * now * a;
        matrix[(0, y)] -= gain * (now * (1.0 - a) + last);
        matrix[(0, y + 1)] -= gain * before;
        for row in 1..=d {
            matrix[(row, row - 1)] = 1.0;
        }
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn plain(ticks: u32) -> Loop {
        Loop { ticks, filter: 0.0, mean: [1.0, 0.0, 0.0] }
    }

    #[test]
    fn limits_are_the_published_ones() {
        for (ticks, limit) in [(0, 2.0), (1, 1.0), (2, 0.618), (3, 0.445)] {
            assert!((plain(ticks).limit() - limit).abs() < 5e-4, "{ticks}");
        }
    }

    #[test]
    fn means_are_means() {
        for method in Method::ALL {
            for continued in [false, true] {
                let sum: f64 = mean_over_step(method, continued).iter().sum();
                assert!((sum - 1.0).abs() < 1e-12);
            }
        }
    }

    /// The closed form, the eigenvalues and the recursion itself say the same.
    #[test]
    fn the_recursion_agrees_with_its_limit() {
        let loops = [
            plain(1),
            plain(3),
            Loop { filter: 2.5, ..plain(1) },
            Loop { mean: mean_over_step(Method::TrBdf2, false), ..plain(1) },
            Loop { mean: mean_over_step(Method::TrBdf2, true), ..plain(2) },
            Loop { filter: 1.0, mean: mean_over_step(Method::ImplicitEuler, true), ..plain(1) },
        ];
        for looped in loops {
            let limit = looped.limit();
            let radius = |gain: f64| spectral_radius(&eigenvalues(&looped.matrix(gain)).unwrap());
            assert!(radius(0.999 * limit) < 1.0 && radius(1.001 * limit) > 1.0, "{looped:?}: {limit}");
            for (gain, grows) in [(0.95 * limit, false), (1.05 * limit, true)] {
                let d = looped.ticks as usize;
                let (mut e, mut y) = (vec![1.0f64; d + 1], [0.0f64; 3]);
                for _ in 0..4_000 {
                    let next = y[0] + (e[0] - y[0]) / (1.0 + looped.filter);
                    y = [next, y[0], y[1]];
                    let flow: f64 = looped.mean.iter().zip(y).map(|(weight, y)| weight * y).sum();
                    let last = e[d] - gain * flow;
                    e.remove(0);
                    e.push(last.clamp(-1e12, 1e12));
                }
                assert_eq!(e[d].abs() > 10.0, grows, "{looped:?} at {gain}: {}", e[d]);
            }
        }
    }
}
