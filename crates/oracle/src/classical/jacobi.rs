//! Singular values and vectors by one-sided Jacobi rotations.

#![allow(clippy::indexing_slicing, reason = "a square matrix has a row for every column")]

use super::vectors::{UNIT_ROUNDOFF, diagonal, dot, length, rows};

/// Most sweeps over all pairs of columns; convergence is quadratic, so that six to ten are usual.
const MOST_SWEEPS: usize = 60;

/// Decomposition A = U·Σ·Vᵀ, with the singular values in no particular order.
pub(super) struct Decomposition {
    /// Columns of U, of length one; zero if the singular value is zero.
    pub(super) left: Vec<Vec<f64>>,
    pub(super) values: Vec<f64>,
    /// Columns of V.
    pub(super) right: Vec<Vec<f64>>,
}

/// Decomposes a matrix given by columns.
pub(super) fn decompose(mut columns: Vec<Vec<f64>>) -> Decomposition {
    debug_assert!(columns.iter().all(|column| Some(column.len()) == columns.first().map(Vec::len)));
    let mut right: Vec<Vec<f64>> = diagonal(&vec![1.0; columns.len()]).collect();
    let tolerance = (rows(&columns) as f64).sqrt() * UNIT_ROUNDOFF;
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

/// Returns the singular values of a matrix given by columns.
pub(super) fn singular_values(columns: Vec<Vec<f64>>) -> Vec<f64> {
    decompose(columns).values
}

/// Returns cosine and sine of the rotation that makes two columns orthogonal; `None` if they are.
fn rotation(a: &[f64], b: &[f64], tolerance: f64) -> Option<(f64, f64)> {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    // Not only a comparison of products: it has to be false for NaN.
    let crossed = ab.abs() > tolerance * (aa * bb).sqrt() && ab != 0.0;
    if !crossed {
        return None;
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let tangent = zeta.signum() / (zeta.abs() + libm::hypot(zeta, 1.0));
    let cosine = 1.0 / libm::hypot(tangent, 1.0);
    Some((cosine, cosine * tangent))
}

fn rotate(a: &mut [f64], b: &mut [f64], cosine: f64, sine: f64) {
    for (x, y) in a.iter_mut().zip(b) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

/// Returns the rows of a square matrix given by columns.
pub(super) fn transpose(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    debug_assert!(columns.iter().all(|column| column.len() == columns.len()), "a square matrix");
    (0..columns.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect()
}
