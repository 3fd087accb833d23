//! Method 2: a polynomial fit as in `numpy.polyfit`.

use super::jacobi::decompose;
use super::linear::{LinearSolution, Solved, Triangle, finish, line_from, ratio, scale, singular};
use super::{ClassicalFit, ClassicalRoute};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Polynomial fit of degree 1.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "polynomial-fit",
    paper_number: 2,
    title: "Polynomial fit (polyfit)",
    summary: "A Vandermonde matrix with scaled columns, reduced by Givens rotations, solved by SVD.",
    citations: &[
        "NumPy reference, numpy.polyfit",
        "Gentleman, J. Inst. Math. Appl. 12 (1973) 329",
        "Chan, ACM Trans. Math. Software 8 (1982) 72",
    ],
    draws: false,
    fit,
};

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    line_from(envelope, &polynomial(envelope.times_s(), envelope.log_amplitudes(), 1)?)
}

/// Fits `y` by least squares on the powers 0 to `degree` of `x`; coefficients from the lowest power up.
///
/// The steps are those of `numpy.polyfit`: the columns of the Vandermonde matrix are divided by their
/// lengths, and singular values below rows·ε of the largest count as zero. The rows enter one after the other
/// by Givens rotations, and the singular values are those of the triangle.
///
/// # Errors
/// [`OracleError`] for unusable input, if a singular value counts as zero (numpy drops it and warns), or if
/// fewer than four digits can be promised.
pub fn polynomial(x: &[f64], y: &[f64], degree: usize) -> Result<LinearSolution, OracleError> {
    let mut powers = vec![vec![1.0; x.len()]];
    for _ in 0..degree {
        let next = powers.last().map(|last| last.iter().zip(x).map(|(power, x)| power * x).collect());
        powers.extend(next);
    }
    let columns: Vec<&[f64]> = powers.iter().map(Vec::as_slice).collect();
    let scaled = scale(&columns, y)?;
    let (triangle, right) = rotate_rows(&scaled.columns, y);
    let parts = decompose(triangle.square());
    let condition = ratio(&parts.values);
    if condition.is_nan() || condition >= 1.0 / (y.len() as f64 * f64::EPSILON) {
        return Err(singular());
    }
    finish(&columns, y, Solved::by_singular_values(&parts, condition, &right, &scaled.lengths))
}

/// Returns the triangle and the transformed right-hand side, built row by row.
fn rotate_rows(columns: &[Vec<f64>], y: &[f64]) -> (Triangle, Vec<f64>) {
    let size = columns.len();
    // Row i of the triangle starts at its diagonal.
    let mut rows: Vec<Vec<f64>> = (0..size).map(|row| vec![0.0; size - row]).collect();
    let mut right = vec![0.0; size];
    for (at, &value) in y.iter().enumerate() {
        let entries: Vec<f64> = columns.iter().filter_map(|column| column.get(at).copied()).collect();
        let mut rest = entries.as_slice();
        let mut shrunk: Vec<f64>;
        let mut value = value;
        for (row, right) in rows.iter_mut().zip(&mut right) {
            let (Some(&pivot), Some(&head)) = (row.first(), rest.first()) else { break };
            shrunk = rest.to_vec();
            if head != 0.0 {
                let size = libm::hypot(pivot, head);
                let (cosine, sine) = (pivot / size, head / size);
                for (upper, lower) in row.iter_mut().zip(&mut shrunk) {
                    (*upper, *lower) = (cosine * *upper + sine * *lower, cosine * *lower - sine * *upper);
                }
                (*right, value) = (cosine * *right + sine * value, cosine * value - sine * *right);
            }
            let [_, shorter @ ..] = shrunk.as_slice() else { break };
            rest = shorter;
        }
    }
    let column = |at: usize| rows.iter().take(at + 1).enumerate().filter_map(move |(i, row)| row.get(at - i));
    (Triangle((0..size).map(|at| column(at).copied().collect()).collect()), right)
}

#[cfg(test)]
mod tests {
    use super::{OracleError, polynomial};

    #[test]
    fn a_cubic_is_found() {
        let x: Vec<f64> = (0..12).map(|i| f64::from(i) * 0.25 - 1.0).collect();
        let y: Vec<f64> = x.iter().map(|x| 1.0 - 2.0 * x + 0.5 * x * x * x).collect();
        let fit = polynomial(&x, &y, 3).unwrap();
        for (found, expected) in fit.coefficients.iter().zip([1.0, -2.0, 0.0, 0.5]) {
            assert!((found - expected).abs() < 1e-14, "{fit:?}");
        }
    }

    #[test]
    fn a_degree_that_the_numbers_cannot_hold_is_refused() {
        let x: Vec<f64> = (0..60).map(|i| 100.0 + f64::from(i) * 0.01).collect();
        let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
        let refused = polynomial(&x, &y, 8);
        assert!(matches!(refused, Err(OracleError::IllConditioned { .. })), "{refused:?}");
    }
}
