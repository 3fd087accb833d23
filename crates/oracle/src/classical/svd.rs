//! Method 5: singular value decomposition by one-sided Jacobi rotations.

use super::jacobi::decompose;
use super::linear::{LinearSolution, Solved, finish, fit_line, ratio, scale, singular};
use super::{ClassicalFit, ClassicalRoute};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Least squares by singular values.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "svd",
    paper_number: 5,
    title: "SVD least squares",
    summary: "Jacobi rotations make the columns orthogonal; the pseudo-inverse follows.",
    citations: &[
        "Hestenes, J. SIAM 6 (1958) 51",
        "Demmel, Veselić, SIAM J. Matrix Anal. Appl. 13 (1992) 1204",
    ],
    draws: false,
    fit,
};

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    fit_line(envelope, least_squares)
}

/// Fits `y` by least squares on the columns of a design matrix, each as long as `y`, by x = V·Σ⁻¹·Uᵀy.
///
/// # Errors
/// [`OracleError`] for unusable input, or if fewer than four digits can be promised.
pub fn least_squares(columns: &[&[f64]], y: &[f64]) -> Result<LinearSolution, OracleError> {
    let scaled = scale(columns, y)?;
    let parts = decompose(scaled.columns);
    let condition = ratio(&parts.values);
    if !condition.is_finite() {
        return Err(singular());
    }
    finish(columns, y, Solved::by_singular_values(&parts, condition, y, &scaled.lengths))
}

#[cfg(test)]
mod tests {
    use super::least_squares;
    use crate::classical::jacobi::decompose;
    use crate::classical::vectors::{combine, dot, times};

    #[test]
    fn the_factors_multiply_back() {
        let columns = vec![vec![1.0, 2.0, -1.0, 0.5], vec![0.0, 3.0, 1.0, -2.0], vec![1.0, 1.0, 1.0, 1.0]];
        let parts = decompose(columns.clone());
        for (at, column) in columns.iter().enumerate() {
            let row: Vec<f64> = parts.right.iter().map(|right| right[at]).collect();
            let back = combine(&parts.left, &times(&row, &parts.values));
            assert!(column.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-14), "{back:?}");
        }
        for (i, a) in parts.left.iter().enumerate() {
            for b in &parts.left[i + 1..] {
                assert!(dot(a, b).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_zero_residual_polynomial_is_met() {
        let x: Vec<f64> = (0..9).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| 3.0 - 2.0 * x).collect();
        let fit = least_squares(&[&[1.0; 9], &x], &y).unwrap();
        assert!((fit.coefficients[0] - 3.0).abs() < 1e-14 && (fit.coefficients[1] + 2.0).abs() < 1e-14);
    }
}
