//! The adaptive operator: how much a stiff row is slowed so that an explicit step stays stable.
//!
//! `φ = min(1, 1/(h·|a|))`, a the diagonal of the row's Jacobian (Qiu et al. 2017, from Gershgorin's theorem).
//!
//! Derived here: a line of v rows `q_i' = q_{i−1} − q_i − R_i·w|w|` and one flow row
//! `w' = φ·(q_v − R·w|w|)` is scaled by a diagonal similarity that makes every row sum at most 1 − h·η. With
//! `A = 2φ·R·|w|`, `B = 2φ·ΣR_i·|w|` the largest such η for which Bernoulli's inequality gives a closed form is
//! `η = 2(A − B)/((1 + vA) + √((1 − vA)² + 4vB))` (with v = 1 where A < B). By Gershgorin's theorem no eigenvalue of I + h·J then lies
//! outside the disc of radius 1 − h·η. It is a proof of stability where A > B, that is where the flow row's
//! resistance exceeds that of all other rows. The ends of the line are taken as held, and h ≤ 1 in units of
//! the method's pseudo-time.
//!
//! Traps, each with a test: with 2 instead of 1 in φ the step sits on the edge of the disc and never settles;
//! φ from full row sums mixes Pa and kg/s; the flow must sit on the stiffest element.

use crate::math;

/// What makes a line's step stable, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Proof {
    /// The method needs no bound on eigenvalues: `adaptive` does not expand by its theorem, the implicit methods
    /// solve for the step's end. It says nothing about what arithmetic does.
    ByConstruction,
    /// The flow row dominates: every eigenvalue lies in the disc by Gershgorin's theorem.
    Dominant,
    /// The step is short against the flow row (2·h·R·|w| < ½), as in the paper's loop with its valve open. A
    /// guard, no proof: a stiff element far from the flow row breaks it (a network file therefore puts the flow
    /// where the eigenvalues were checked when it was read).
    ShortStep,
    /// Neither: the margin has to be computed from the eigenvalues.
    None,
}

/// How far the operator bends the physics, and what is known of stability, over all lines.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Margin {
    /// Smallest φ of any line [1, 0…1]; 1 where nothing is slowed.
    pub phi: f32,
    /// Largest upper bound of the spectral radius of any line's step [1]; below 1 it proves stability. NaN for
    /// methods that need none.
    pub spectral_bound: f32,
    /// The weakest of the lines' proofs.
    pub proof: Proof,
}

impl Margin {
    /// The margin of nothing: the neutral element of [`Self::with`].
    pub const FREE: Self = Self { phi: 1.0, spectral_bound: 0.0, proof: Proof::ByConstruction };

    /// The margin of a method that is stable by construction, with the smallest φ of any node.
    pub(crate) const fn by_construction(phi: f32) -> Self {
        Self { phi, spectral_bound: f32::NAN, proof: Proof::ByConstruction }
    }

    /// Returns the worse of both, figure by figure.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            phi: if other.phi < self.phi { other.phi } else { self.phi },
            spectral_bound: math::larger(other.spectral_bound, self.spectral_bound),
            proof: if other.proof > self.proof { other.proof } else { self.proof },
        }
    }
}

/// Returns φ = min(1, 1/(h·|a|)) for `stiffness` = h·|a| [1, ≥ 0].
#[inline(always)]
#[allow(clippy::inline_always, reason = "one division and one select")]
pub fn phi(stiffness: f32) -> f32 {
    1.0 / math::larger(stiffness, 1.0)
}

/// A line as the operator sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowRow {
    /// Step h [s of pseudo-time], ≤ 1.
    pub step: f32,
    /// Slope of w|w|: 2|w|, or the laminar limit flow where |w| is below it [kg/s].
    pub slope: f32,
    /// Quadratic resistance of the flow row, R [Pa·s²/kg²].
    pub own: f32,
    /// Linear resistance of the flow row [Pa·s/kg].
    pub own_linear: f32,
    /// Upper bound of the resistance of all other rows, fan slope included, ΣR [Pa·s²/kg²].
    pub others: f32,
    /// Number v of other rows.
    pub rows: f32,
}

impl FlowRow {
    /// h·|a| of the flow row [1].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "two products and a sum")]
    pub fn stiffness(&self) -> f32 {
        self.step * (self.slope * self.own + self.own_linear)
    }

    /// Returns the margin of this line for any φ, also for none (φ = 1 whatever the stiffness).
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub fn margin(&self, phi: f32) -> Margin {
        let overshoot = self.step * phi * (self.slope * self.own + self.own_linear) - 1.0;
        // With φ the flow row lands on the centre; what is left there is rounding.
        if phi >= 1.0 && overshoot > 0.0 {
            let bound = self.bound_beyond_centre(overshoot, phi * self.slope * self.others);
            return Margin { phi, spectral_bound: bound, proof: Proof::None };
        }
        self.margin_with_phi(phi)
    }

    /// Returns the margin of this line with the φ of [`phi`], which keeps the flow row from overshooting.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
    pub fn margin_with_phi(&self, phi: f32) -> Margin {
        let own = phi * (self.slope * self.own + self.own_linear);
        let others = phi * self.slope * self.others;
        let dominant = own >= others;
        // Bernoulli's inequality needs the largest power where rows shrink and the smallest where they grow.
        let power = if dominant { self.rows } else { 1.0 };
        let (sum, difference) = (1.0 + power * own, 1.0 - power * own);
        let root = math::sqrt(difference * difference + 4.0 * power * others);
        let spectral_bound = 1.0 - self.step * (2.0 * (own - others) / (sum + root));
        let proof = match (dominant, self.stiffness() < 0.5) {
            (true, _) => Proof::Dominant,
            (false, true) => Proof::ShortStep,
            (false, false) => Proof::None,
        };
        Margin { phi, spectral_bound, proof }
    }

    /// Bound where the flow row alone overshoots, which only happens without φ: rows are scaled so that each
    /// sum is at most D + h·k, D = h·A − 1.
    #[cold]
    fn bound_beyond_centre(&self, overshoot: f32, others: f32) -> f32 {
        if self.rows < 1.0 {
            return overshoot;
        }
        let gap = (1.0 - overshoot) / self.step;
        overshoot + self.step * 0.5 * (gap + math::sqrt(gap * gap + 4.0 * others))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER_CLOSED: FlowRow = FlowRow {
        step: 1e-3,
        slope: 2.0 * 4.0594e-3,
        own: 1.8147e7,
        own_linear: 0.0,
        others: 39_879.0,
        rows: 5.0,
    };

    #[test]
    fn a_soft_row_is_left_alone_and_a_stiff_one_lands_on_the_centre() {
        assert!((phi(0.3) - 1.0).abs() < f32::EPSILON);
        for stiffness in [1.0f32, 7.0, 147.5, 1e9] {
            assert!((1.0 - phi(stiffness) * stiffness).abs() < 1e-6);
        }
        assert!((phi(f32::INFINITY)).abs() < f32::MIN_POSITIVE);
    }

    #[test]
    fn the_papers_stiff_end_is_proven() {
        let margin = PAPER_CLOSED.margin(phi(PAPER_CLOSED.stiffness()));
        assert_eq!(margin.proof, Proof::Dominant);
        assert!(margin.spectral_bound < 1.0, "{margin:?}");
    }

    #[test]
    fn without_phi_the_stiff_row_is_reported_outside() {
        let margin = PAPER_CLOSED.margin(1.0);
        assert!(margin.spectral_bound > 100.0 && margin.proof == Proof::None, "{margin:?}");
    }

    #[test]
    fn a_short_step_is_not_called_a_proof() {
        let open = FlowRow { own: 86.0, slope: 2.0 * 0.0865, ..PAPER_CLOSED };
        let margin = open.margin(phi(open.stiffness()));
        assert_eq!(margin.proof, Proof::ShortStep);
        assert!(margin.spectral_bound > 1.0);
    }
}
