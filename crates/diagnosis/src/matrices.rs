//! Symmetric systems: raised diagonals and a scaled solution.

#![allow(clippy::indexing_slicing, reason = "rows and columns are those of the matrices")]

use nalgebra::DMatrix;

/// Minimum relative increase of each entry of a diagonal, against rounding.
const LEAST: f64 = 1e-13;

/// Raises the diagonal of a normal matrix by a factor; a column without any effect gets the pivot 1.
///
/// Each entry is raised in proportion to itself and not to another one: the columns differ by many orders of
/// magnitude, as do the units of their parameters.
pub(crate) fn raised(matrix: &DMatrix<f64>, factor: f64) -> DMatrix<f64> {
    let mut raised = matrix.clone();
    for i in 0..matrix.nrows() {
        let own = matrix[(i, i)];
        raised[(i, i)] = if own > 0.0 { own * (1.0 + factor + LEAST) } else { 1.0 };
    }
    raised
}

/// Multiplies some entries of a square matrix's diagonal by 1 + `ridge`.
pub(crate) fn ridged(
    matrix: &DMatrix<f64>,
    entries: impl IntoIterator<Item = usize>,
    ridge: f64,
) -> DMatrix<f64> {
    let mut ridged = matrix.clone();
    for i in entries {
        let own = matrix[(i, i)];
        ridged[(i, i)] = own * (1.0 + ridge);
    }
    ridged
}

/// Solves a symmetric system after scaling it to a unit diagonal, since parameters differ by many orders of
/// magnitude.
pub(crate) fn solve(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    debug_assert!(matrix.is_square() && matrix.nrows() == right.nrows());
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        matrix[(i, j)] * scale[i] * scale[j] + if i == j { 1e-13 } else { 0.0 }
    });
    let scaled_right = DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| right[(i, j)] * scale[i]);
    let solution = scaled.cholesky()?.solve(&scaled_right);
    Some(DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| solution[(i, j)] * scale[i]))
}

/// Multiplies two matrices by the same sums on every processor: beyond five rows and columns, `*` takes what the processor
/// multiplies fastest, and the last digits of a diagnosis would depend on it.
pub(crate) fn product(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    left.transpose().tr_mul(right)
}

#[cfg(test)]
mod tests {
    use super::raised;
    use nalgebra::{DMatrix, DVector};

    /// In other units of a parameter its step has other units too, and nothing else changes.
    #[test]
    fn a_step_does_not_depend_on_units() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 0.3, 0.3, 1.0]);
        let right = DVector::from_vec(vec![0.7, -0.4]);
        let step = raised(&matrix, 1e-4).cholesky().unwrap().solve(&right);
        for unit in [1e-12, 1e-6, 1e9] {
            let units = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, unit]));
            let other =
                raised(&(&units * &matrix * &units), 1e-4).cholesky().unwrap().solve(&(&units * &right));
            assert!((units * other - &step).norm() < 1e-12 * step.norm(), "{unit}");
        }
    }

    #[test]
    fn a_column_without_effect_does_not_move() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 0.0, 0.0, 0.0]);
        let step = raised(&matrix, 0.0).cholesky().unwrap().solve(&DVector::from_vec(vec![1.0, 0.0]));
        assert!((step[0] - 0.5).abs() < 1e-12 && step[1] == 0.0, "{step}");
    }
}
