//! Sparse elimination on a pattern that was fixed when the network was built.
//!
//! Row-wise LU without pivoting of a row-dominant M-matrix: the pattern decides the sequence of operations,
//! the values do not. A row is scattered into a dense vector, reduced by the rows above it, and gathered back.

use crate::Plan;

/// The matrix and the vectors of its solution.
pub(crate) struct Matrix<'w> {
    /// Entries of L + U in the order of [`Plan::columns`].
    pub(crate) entries: &'w mut [f32],
    /// Right-hand side, then the solution, by row.
    pub(crate) rhs: &'w mut [f32],
    /// Reciprocals of the pivots.
    pub(crate) reciprocal: &'w mut [f32],
    /// One row, dense.
    pub(crate) dense: &'w mut [f32],
}

impl Matrix<'_> {
    /// Adds to an entry; [`Plan::NOWHERE`] is skipped.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "called four times a line and solve")]
    pub(crate) fn add(&mut self, entry: u32, value: f32) {
        if let Some(slot) = self.entries.get_mut(entry as usize) {
            *slot += value;
        }
    }

    /// Adds to a right-hand side; [`Plan::NOWHERE`] is skipped.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "called twice a line and solve")]
    pub(crate) fn add_rhs(&mut self, row: u32, value: f32) {
        if let Some(slot) = self.rhs.get_mut(row as usize) {
            *slot += value;
        }
    }

    /// Factorises and solves in place: afterwards `rhs` holds the solution by row.
    pub(crate) fn solve(&mut self, plan: &Plan<'_>) {
        let rows = plan.row_start.windows(2).zip(plan.diagonal);
        for (row, (bounds, &diagonal)) in rows.enumerate() {
            self.reduce(plan, row, bounds, diagonal as usize);
        }
        let rows = plan.row_start.windows(2).zip(plan.diagonal);
        for (row, (bounds, &diagonal)) in rows.enumerate().rev() {
            let upper = diagonal as usize + 1..bounds.last().copied().unwrap_or(0) as usize;
            let (Some(columns), Some(entries)) = (plan.columns.get(upper.clone()), self.entries.get(upper))
            else {
                continue;
            };
            let mut value = self.rhs.get(row).copied().unwrap_or(0.0);
            for (&column, &entry) in columns.iter().zip(entries) {
                value -= entry * self.rhs.get(column as usize).copied().unwrap_or(0.0);
            }
            if let (Some(slot), Some(reciprocal)) = (self.rhs.get_mut(row), self.reciprocal.get(row)) {
                *slot = value * reciprocal;
            }
        }
    }

    /// Reduces one row by all rows above it and its right-hand side with it.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "the body of the only loop over rows")]
    fn reduce(&mut self, plan: &Plan<'_>, row: usize, bounds: &[u32], diagonal: usize) {
        let &[first, past] = bounds else { return };
        let range = first as usize..past as usize;
        let (Some(columns), Some(entries)) = (plan.columns.get(range.clone()), self.entries.get_mut(range))
        else {
            return;
        };
        for (&column, &mut entry) in columns.iter().zip(entries) {
            if let Some(slot) = self.dense.get_mut(column as usize) {
                *slot = entry;
            }
        }
        let mut value = self.rhs.get(row).copied().unwrap_or(0.0);
        let lower = columns.get(..diagonal - first as usize).unwrap_or(&[]);
        for &by in lower {
            let by = by as usize;
            let (Some(slot), Some(reciprocal)) = (self.dense.get_mut(by), self.reciprocal.get(by)) else {
                continue;
            };
            let factor = *slot * reciprocal;
            *slot = factor;
            value -= factor * self.rhs.get(by).copied().unwrap_or(0.0);
            let (Some(&above), Some(&end)) = (plan.diagonal.get(by), plan.row_start.get(by + 1)) else {
                continue;
            };
            let upper = above as usize + 1..end as usize;
            let (Some(columns), Some(entries)) = (plan.columns.get(upper.clone()), self.entries.get(upper))
            else {
                continue;
            };
            for (&column, &entry) in columns.iter().zip(entries) {
                if let Some(slot) = self.dense.get_mut(column as usize) {
                    *slot -= factor * entry;
                }
            }
        }
        let range = first as usize..past as usize;
        for (&column, entry) in columns.iter().zip(self.entries.get_mut(range).unwrap_or(&mut [])) {
            *entry = self.dense.get(column as usize).copied().unwrap_or(0.0);
        }
        let pivot = self.dense.get(row).copied().unwrap_or(1.0);
        if let (Some(slot), Some(reciprocal)) = (self.rhs.get_mut(row), self.reciprocal.get_mut(row)) {
            *slot = value;
            *reciprocal = 1.0 / pivot;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of four with the full fill of its natural order, against the answer known by construction.
    #[test]
    fn solves_a_ring_with_fill() {
        let plan = Plan {
            row_start: &[0, 3, 7, 11, 15],
            columns: &[0, 1, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3],
            diagonal: &[0, 4, 9, 14],
            ..Plan::EMPTY
        };
        let dense: [[f32; 4]; 4] =
            [[4.0, -1.0, 0.0, -2.0], [-1.5, 5.0, -1.0, 0.0], [0.0, -2.0, 4.5, -1.0], [-1.0, 0.0, -1.0, 3.0]];
        let solution = [1.0f32, -2.0, 0.5, 3.0];
        let mut entries = [0.0f32; 15];
        let mut rhs = [0.0f32; 4];
        for row in 0..4 {
            for entry in plan.row_start[row] as usize..plan.row_start[row + 1] as usize {
                entries[entry] = dense[row][plan.columns[entry] as usize];
            }
            rhs[row] = (0..4).map(|column| dense[row][column] * solution[column]).sum();
        }
        let mut matrix =
            Matrix { entries: &mut entries, rhs: &mut rhs, reciprocal: &mut [0.0; 4], dense: &mut [0.0; 4] };
        matrix.solve(&plan);
        for (found, exact) in rhs.iter().zip(solution) {
            assert!((found - exact).abs() < 1e-5, "{rhs:?}");
        }
    }
}
