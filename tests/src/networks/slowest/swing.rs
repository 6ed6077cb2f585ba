//! Capacities and inertances together: all rates at once.

use nalgebra::{Complex, DMatrix};

use super::{Losses, Parts, Reach};

/// Part of the largest eigenvalue below which another is rounding [1].
const HIDDEN: f64 = 1e-13;

/// Angular frequencies that are tried [rad/s].
const FREQUENCIES: [f64; 7] = [1e-2, 1.0, 10.0, 100.0, 1e3, 1e4, 1e6];

impl Parts {
    /// Slowest time constant of capacities and inertances together [s], for conductances between those at rest and the
    /// `far` ones.
    ///
    /// At angular frequency ω a reach of loss r = 1/S and inertance I takes r/(r² + ω²I²) of the power of a swing: least at
    /// the one end or at the other of r's range, at the nearer if the product of both is below (ωI)². Which ω a swing has
    /// is not known before; so they are all tried, a decade apart. Where nothing is inert the reach may lead to a volume
    /// or past it, which is tried both ways.
    pub(crate) fn slowest_swing_s(&self, far: impl Fn(&Losses) -> f64) -> f64 {
        let mut slowest = 0.0f64;
        for (frequency, open) in
            FREQUENCIES.iter().flat_map(|&frequency| [(frequency, false), (frequency, true)])
        {
            let conductance = |reach: &Reach| {
                let (most, least) = (reach.losses.widest(), far(&reach.losses));
                let impedance = frequency * reach.inertance_per_m;
                let near = if impedance > 0.0 { impedance * impedance * most * least > 1.0 } else { open };
                if near { most } else { least }
            };
            slowest = slowest.max(self.swing_s(conductance));
        }
        slowest
    }

    /// The same for given conductances.
    fn swing_s(&self, conductance: impl Fn(&Reach) -> f64) -> f64 {
        let rows = self.rows();
        let inert = self.reaches.iter().filter(|reach| reach.inertance_per_m > 0.0).count();
        let order = rows.len() + inert;
        if order == 0 {
            return 0.0;
        }
        let mut balances = DMatrix::<f64>::zeros(order, order);
        let mut root: Vec<f64> = rows.iter().map(|&point| self.capacities[point].sqrt()).collect();
        // No rate that is not real is slower: the energies in C and in I are equal, and only flows lose.
        let mut longest_s = 0.0f64;
        for reach in &self.reaches {
            let conductance = conductance(reach);
            let ends = reach.ends.map(|end| rows.binary_search(&end).ok()).into_iter().zip([1.0, -1.0]);
            let ends: Vec<(usize, f64)> = ends.filter_map(|(row, sign)| Some((row?, sign))).collect();
            if reach.inertance_per_m > 0.0 {
                let own = root.len();
                root.push(reach.inertance_per_m.sqrt());
                longest_s = longest_s.max(2.0 * reach.inertance_per_m * conductance);
                balances[(own, own)] = -1.0 / conductance;
                for (row, sign) in ends {
                    balances[(own, row)] += sign;
                    balances[(row, own)] -= sign;
                }
            } else {
                for (row, sign) in &ends {
                    for (other, to) in &ends {
                        balances[(*row, *other)] -= sign * to * conductance;
                    }
                }
            }
        }
        let Some(mut inverse) = balances.try_inverse() else { return f64::INFINITY };
        for (row, column) in (0..order).flat_map(|row| (0..order).map(move |column| (row, column))) {
            inverse[(row, column)] *= root[row] * root[column];
        }
        // What two equal real values leave of their difference by rounding has no root.
        let real =
            |value: Complex<f64>| Complex::new(value.re, if value.im.is_nan() { 0.0 } else { value.im });
        let values: Vec<_> = inverse.complex_eigenvalues().iter().copied().map(real).collect();
        let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let time_s = |value: &Complex<f64>| {
            // Of so fast a swing rounding hides how it decays.
            let hidden = HIDDEN * largest;
            let exact = value.norm_sqr() / hidden.max(-value.re);
            if -value.re > hidden { exact } else { longest_s.min(exact) }
        };
        values.iter().map(time_s).fold(0.0, f64::max)
    }
}
