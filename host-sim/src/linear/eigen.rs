//! Eigenvalues and Gershgorin discs of a small dense matrix.

use nalgebra::DMatrix;
use nalgebra::linalg::{Schur, balancing};

/// A complex number.
pub type Complex = nalgebra::Complex<f64>;

/// A Gershgorin disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Its centre on the real axis, the diagonal entry.
    pub centre: f64,
    /// Its radius, the sum of the row's other entries.
    pub radius: f64,
}

impl Disc {
    /// Largest distance from zero of any point in the disc.
    pub fn reach(&self) -> f64 {
        self.centre.abs() + self.radius
    }
}

/// Returns the same operator in units that make rows and columns alike (Parlett and Reinsch): pressures of
/// hundreds of pascals and flows of hundredths of kg/s would otherwise stand side by side.
fn balanced(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let mut matrix = matrix.clone();
    balancing::balance_parlett_reinsch(&mut matrix);
    matrix
}

/// Returns all eigenvalues; `None` if the iteration does not converge or an entry is not finite.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex>> {
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let schur = Schur::try_new(balanced(matrix), f64::EPSILON, 10_000)?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

/// Returns the largest distance from zero of any eigenvalue.
pub fn spectral_radius(eigenvalues: &[Complex]) -> f64 {
    eigenvalues.iter().map(|value| value.re.hypot(value.im)).fold(0.0, f64::max)
}

/// Returns the Gershgorin disc of every row of the balanced matrix. All eigenvalues lie in their union.
pub fn gershgorin(matrix: &DMatrix<f64>) -> Vec<Disc> {
    let matrix = balanced(matrix);
    let disc = |row: usize| {
        let sum: f64 = matrix.row(row).iter().map(|entry| entry.abs()).sum();
        let centre = matrix[(row, row)];
        Disc { centre, radius: sum - centre.abs() }
    };
    (0..matrix.nrows()).map(disc).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_eigenvalues_are_found_across_units() {
        // Companion matrix of (x − 1)(x − 2)(x² + 1), with its rows in very different units.
        let mut matrix = DMatrix::from_row_slice(
            4,
            4,
            &[3.0, -3.0, 3.0, -2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        );
        let units = [1.0, 1e7, 1e-3, 1e4];
        for row in 0..4 {
            for column in 0..4 {
                matrix[(row, column)] *= units[row] / units[column];
            }
        }
        let found = eigenvalues(&matrix).unwrap();
        for (re, im) in [(1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            assert!(found.iter().any(|value| (value.re - re).hypot(value.im - im) < 1e-9), "{found:?}");
        }
        assert!((spectral_radius(&found) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn every_eigenvalue_lies_in_a_disc() {
        let matrix = DMatrix::from_fn(7, 7, |row, column| ((row * 7 + column) as f64 * 1.7).sin());
        let discs = gershgorin(&matrix);
        for value in eigenvalues(&matrix).unwrap() {
            let inside = |disc: &Disc| (value.re - disc.centre).hypot(value.im) <= disc.radius + 1e-9;
            assert!(discs.iter().any(inside));
        }
    }

    #[test]
    fn what_is_not_finite_has_no_eigenvalues() {
        assert!(eigenvalues(&DMatrix::from_element(2, 2, f64::NAN)).is_none());
    }
}
