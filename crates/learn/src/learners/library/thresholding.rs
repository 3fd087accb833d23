//! Sequentially thresholded least squares.
//!
//! Brunton, Proctor, Kutz, PNAS 113 (2016) 3932. Terms are compared by their contribution (weight times the
//! norm of the column), because weights in different units cannot be compared.

use super::Term;
use crate::linear::least_squares;
use nalgebra::{DMatrix, DVector};

/// Linear regression of accelerations, or of their weak form, on terms. Rows belong to groups that are
/// resampled as a whole.
#[derive(Debug, Clone)]
pub struct Regression {
    /// Terms, one per column.
    pub terms: Vec<Term>,
    /// Values of the terms, rows × terms.
    pub rows: DMatrix<f64>,
    /// Right side, one per row: accelerations or their weak form.
    pub right: DVector<f64>,
    /// Group of each row.
    pub groups: Vec<usize>,
}

impl Regression {
    /// Returns the rows with these indices.
    #[must_use]
    pub fn selected(&self, rows: &[usize]) -> Self {
        Self {
            terms: self.terms.clone(),
            rows: self.rows.select_rows(rows),
            right: self.right.select_rows(rows),
            groups: rows.iter().filter_map(|&row| self.groups.get(row).copied()).collect(),
        }
    }
}

/// Returns the weights of the kept terms and 0 for the others. Least squares is repeated, each time without
/// the terms that contribute less than `threshold` of the whole, until every term contributes more.
#[must_use]
pub fn thresholded(regression: &Regression, threshold: f64) -> Vec<f64> {
    let total = regression.right.norm().max(f64::MIN_POSITIVE);
    let mut kept: Vec<usize> = (0..regression.rows.ncols()).collect();
    loop {
        let columns = regression.rows.select_columns(&kept);
        let Some(weights) = least_squares(&columns, &regression.right) else {
            return vec![0.0; regression.rows.ncols()];
        };
        let sizes: Vec<f64> = columns
            .column_iter()
            .zip(weights.iter())
            .map(|(column, weight)| column.norm() * weight.abs() / total)
            .collect();
        // A term without effect on these rows cannot be distinguished from any other.
        let left: Vec<usize> =
            kept.iter().zip(&sizes).filter(|(_, size)| **size >= threshold).map(|(term, _)| *term).collect();
        if left.len() == kept.len() || left.is_empty() {
            let mut all = vec![0.0; regression.rows.ncols()];
            for (&term, &weight) in kept.iter().zip(weights.iter()) {
                if let Some(slot) = all.get_mut(term) {
                    *slot = weight;
                }
            }
            return all;
        }
        kept = left;
    }
}
