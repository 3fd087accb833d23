//! Normal equations whose columns differ much in size.

use nalgebra::{DMatrix, DVector};

/// Returns the inverse of a symmetric positive definite matrix, scaled to a diagonal of 1 in between.
pub(crate) fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let sizes = matrix.diagonal().map(f64::sqrt);
    if sizes.iter().any(|size| !size.is_finite() || *size <= 0.0) {
        return None;
    }
    let scale = &sizes * sizes.transpose();
    let scaled = matrix.component_div(&scale).cholesky()?;
    Some(scaled.inverse().component_div(&scale))
}

/// Solves normal equations; `None` if they do not determine a solution.
pub(crate) fn solve(matrix: &DMatrix<f64>, target: &DVector<f64>) -> Option<DVector<f64>> {
    Some(inverse(matrix)? * target)
}
