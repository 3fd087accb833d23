//! Method 5: singular value decomposition by one-sided Jacobi rotations.

use super::linear::{
    LinearSolution, Solved, Stability, UNIT_ROUNDOFF, finish, fit_line, ratio, scale, singular,
};
use super::vectors::{combine, diagonal, dot, length};
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

/// Sweeps over all pairs of columns; convergence is quadratic, so that six to ten are usual.
const MOST_SWEEPS: usize = 60;

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    fit_line(envelope, least_squares)
}

/// Least squares of `y` on the columns of a design matrix, each as long as `y`, by x = V·Σ⁻¹·Uᵀy.
///
/// # Errors
/// [`OracleError`] for unusable input, and where fewer than four digits can be promised.
pub fn least_squares(columns: &[&[f64]], y: &[f64]) -> Result<LinearSolution, OracleError> {
    let scaled = scale(columns, y)?;
    let parts = decompose(scaled.columns);
    let condition = ratio(&parts.values);
    if !condition.is_finite() {
        return Err(singular());
    }
    let shares: Vec<f64> =
        parts.left.iter().zip(&parts.values).map(|(left, value)| dot(left, y) / value).collect();
    let weighted: Vec<Vec<f64>> = parts
        .right
        .iter()
        .zip(&parts.values)
        .map(|(right, value)| right.iter().map(|x| x / value).collect())
        .collect();
    let solved = Solved {
        lengths: &scaled.lengths,
        scaled: combine(&parts.right, &shares),
        inverse_rows: transpose(&weighted),
        condition,
        stability: Stability::Orthogonal,
    };
    finish(columns, y, solved)
}

/// A = U·Σ·Vᵀ, the singular values in no order.
pub(super) struct Decomposition {
    /// Columns of U, of length one; zero where the value is zero.
    pub(super) left: Vec<Vec<f64>>,
    pub(super) values: Vec<f64>,
    /// Columns of V.
    pub(super) right: Vec<Vec<f64>>,
}

/// Decomposes a matrix given by columns.
pub(super) fn decompose(mut columns: Vec<Vec<f64>>) -> Decomposition {
    let mut right: Vec<Vec<f64>> = diagonal(&vec![1.0; columns.len()]).collect();
    let rows = columns.first().map_or(0, Vec::len);
    let tolerance = (rows as f64).sqrt() * UNIT_ROUNDOFF;
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for second in 1..columns.len() {
            let (heads, tails) = columns.split_at_mut(second);
            let (right_heads, right_tails) = right.split_at_mut(second);
            let (Some(b), Some(right_b)) = (tails.first_mut(), right_tails.first_mut()) else { break };
            for (a, right_a) in heads.iter_mut().zip(right_heads) {
                if let Some((cosine, sine)) = rotation(a, b, tolerance) {
                    rotate(a, b, cosine, sine);
                    rotate(right_a, right_b, cosine, sine);
                    rotated = true;
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let values: Vec<f64> = columns.iter().map(|column| length(column)).collect();
    for (column, value) in columns.iter_mut().zip(&values) {
        if *value > 0.0 {
            column.iter_mut().for_each(|x| *x /= value);
        }
    }
    Decomposition { left: columns, values, right }
}

/// Singular values of a matrix given by columns.
pub(super) fn singular_values(columns: Vec<Vec<f64>>) -> Vec<f64> {
    decompose(columns).values
}

/// Cosine and sine of the rotation that makes two columns orthogonal; `None` where they are.
fn rotation(a: &[f64], b: &[f64], tolerance: f64) -> Option<(f64, f64)> {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    // Not a comparison of products alone: it has to fail for what is no number.
    let crossed = ab.abs() > tolerance * (aa * bb).sqrt() && ab != 0.0;
    if !crossed {
        return None;
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    Some((cosine, cosine * tangent))
}

fn rotate(a: &mut [f64], b: &mut [f64], cosine: f64, sine: f64) {
    for (x, y) in a.iter_mut().zip(b) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

/// Rows of a square matrix given by columns.
pub(super) fn transpose(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let rows = columns.first().map_or(0, Vec::len);
    (0..rows).map(|row| columns.iter().filter_map(|column| column.get(row).copied()).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::{decompose, least_squares};
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
