//! Dense linear algebra for the small matrices of a fit.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Decomposes a symmetric positive semidefinite matrix. Its diagonal is raised by a growing factor until the
/// matrix is positive definite.
fn decomposed(matrix: &DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let factors = std::iter::successors(Some(1e-14), |factor| Some(factor * 100.0));
    factors.take_while(|factor| *factor < 1e-3).find_map(|factor| raised(matrix, factor).cholesky())
}

/// Solves a symmetric positive semidefinite system, regularized as in [`decomposed`].
pub(crate) fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    Some(decomposed(matrix)?.solve(right))
}

/// Inverts a symmetric positive semidefinite matrix, regularized as in [`decomposed`].
pub(crate) fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    Some(decomposed(matrix)?.inverse())
}

/// Returns the matrix with its diagonal multiplied by 1 + `factor`; a diagonal entry that is not positive
/// becomes 1.
pub(crate) fn raised(matrix: &DMatrix<f64>, factor: f64) -> DMatrix<f64> {
    let diagonal = matrix.diagonal().map(|own| if own > 0.0 { own * (1.0 + factor) } else { 1.0 });
    let mut raised = matrix.clone();
    raised.set_diagonal(&diagonal);
    raised
}

/// Solves the least-squares problem `rows · x ≈ right` by normal equations, with columns scaled to unit
/// length.
pub(crate) fn least_squares(rows: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let lengths: Vec<f64> = rows.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)).collect();
    let mut scaled = rows.clone();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let decomposed = scaled.svd(true, true);
    let solved = decomposed.solve(right, 1e-12).ok()?;
    let lengths = DVector::from_vec(lengths);
    Some(solved.component_div(&lengths))
}
