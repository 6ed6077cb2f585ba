//! Solution of the node equations in `f64` on the pattern of [`PlanTables`].
//!
//! Row-wise LU without pivoting: the matrix is a row-dominant M-matrix, and its pattern with fill is known.

use eclss_core::Plan;

use crate::plan::PlanTables;

/// A matrix on the pattern of connection tables.
#[derive(Debug)]
pub(super) struct Matrix<'p> {
    tables: &'p PlanTables,
    entries: Vec<f64>,
}

impl<'p> Matrix<'p> {
    /// Returns the matrix of zeros.
    pub(super) fn new(tables: &'p PlanTables) -> Self {
        Self { tables, entries: vec![0.0; tables.columns.len()] }
    }

    /// Adds to an entry; [`Plan::NOWHERE`] is skipped.
    pub(super) fn add(&mut self, entry: u32, value: f64) {
        if entry != Plan::NOWHERE {
            self.entries[entry as usize] += value;
        }
    }

    fn bounds(&self, row: usize) -> std::ops::Range<usize> {
        self.tables.row_start[row] as usize..self.tables.row_start[row + 1] as usize
    }

    /// Replaces the entries by their factors L + U.
    pub(super) fn factorise(&mut self) {
        let rows = self.tables.order.len();
        let mut dense = vec![0.0; rows];
        for row in 0..rows {
            let range = self.bounds(row);
            for entry in range.clone() {
                dense[self.tables.columns[entry] as usize] = self.entries[entry];
            }
            for entry in range.start..self.tables.diagonal[row] as usize {
                let by = self.tables.columns[entry] as usize;
                let diagonal = self.tables.diagonal[by] as usize;
                let factor = dense[by] / self.entries[diagonal];
                dense[by] = factor;
                for above in diagonal + 1..self.bounds(by).end {
                    dense[self.tables.columns[above] as usize] -= factor * self.entries[above];
                }
            }
            for entry in range {
                self.entries[entry] = dense[self.tables.columns[entry] as usize];
            }
        }
    }

    /// Solves for a right-hand side by row, in place, with the factors.
    pub(super) fn solve(&self, rhs: &mut [f64]) {
        let columns = &self.tables.columns;
        for row in 0..rhs.len() {
            let lower = self.bounds(row).start..self.tables.diagonal[row] as usize;
            let known: f64 = lower.map(|entry| self.entries[entry] * rhs[columns[entry] as usize]).sum();
            rhs[row] -= known;
        }
        for row in (0..rhs.len()).rev() {
            let diagonal = self.tables.diagonal[row] as usize;
            let upper = diagonal + 1..self.bounds(row).end;
            let known: f64 = upper.map(|entry| self.entries[entry] * rhs[columns[entry] as usize]).sum();
            rhs[row] = (rhs[row] - known) / self.entries[diagonal];
        }
    }
}
