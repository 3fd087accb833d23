//! Entries of matrices and vectors without a panic: what is not there is zero, and setting it does nothing.

use nalgebra::{DMatrix, DVector};

pub(crate) fn entry(matrix: &DMatrix<f64>, row: usize, column: usize) -> f64 {
    matrix.get((row, column)).copied().unwrap_or(0.0)
}

pub(crate) fn set(matrix: &mut DMatrix<f64>, row: usize, column: usize, value: f64) {
    if let Some(slot) = matrix.get_mut((row, column)) {
        *slot = value;
    }
}

pub(crate) fn element(vector: &DVector<f64>, index: usize) -> f64 {
    vector.get(index).copied().unwrap_or(0.0)
}

/// A square matrix with its diagonal raised by a factor, and each entry by a little of the largest: a column
/// without any effect still gets a pivot.
pub(crate) fn raised(matrix: &DMatrix<f64>, factor: f64) -> DMatrix<f64> {
    let largest = matrix.diagonal().max().max(f64::MIN_POSITIVE);
    let mut raised = matrix.clone();
    for i in 0..matrix.nrows() {
        let own = entry(matrix, i, i);
        set(&mut raised, i, i, own + factor * own + 1e-14 * largest);
    }
    raised
}

/// A square matrix with some entries of its diagonal multiplied by 1 + `ridge`.
pub(crate) fn ridged(
    matrix: &DMatrix<f64>,
    entries: impl IntoIterator<Item = usize>,
    ridge: f64,
) -> DMatrix<f64> {
    let mut ridged = matrix.clone();
    for i in entries {
        let own = entry(matrix, i, i);
        set(&mut ridged, i, i, own * (1.0 + ridge));
    }
    ridged
}
