//! Method 11: weighted regression.

use super::linear::{LinearSolution, Solved, Stability, Triangle, finish, fit_line, scale, singular};
use super::{ClassicalFit, ClassicalRoute};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Weighted least squares with uniform weights, as in the paper.
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "weighted-regression",
    paper_number: 11,
    title: "Weighted regression",
    summary: "Modified Gram–Schmidt in the inner product of the weights; all weights 1.",
    citations: &["Aitken, Proc. Royal Soc. Edinburgh 55 (1935) 42", "Björck, BIT 7 (1967) 1"],
    draws: false,
    fit,
};

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    let weights = vec![1.0; envelope.len()];
    fit_line(envelope, |columns, y| least_squares(columns, y, &weights))
}

/// Minimizes Σ wᵢ·rᵢ² over the columns' coefficients. The weights are inverse variances up to a factor.
///
/// Weights are positive, one per row. For the coefficients, a weight k counts a row k times; for the degrees
/// of freedom of the standard errors it counts the row once.
///
/// # Errors
/// [`OracleError::Weight`] for a weight that is not positive and finite, [`OracleError::Shape`] (column 0)
/// for a wrong number of weights; otherwise the errors of the unweighted routes.
pub fn least_squares(columns: &[&[f64]], y: &[f64], weights: &[f64]) -> Result<LinearSolution, OracleError> {
    if weights.len() != y.len() {
        return Err(OracleError::Shape { column: 0, found: weights.len(), expected: y.len() });
    }
    for (row, &weight) in (1..).zip(weights) {
        if !(weight > 0.0 && weight.is_finite()) {
            return Err(OracleError::Weight { row, weight });
        }
    }
    // Only ratios of weights matter for the coefficients; the largest becomes 1 to keep sums in range.
    let largest = weights.iter().copied().fold(0.0, f64::max);
    let roots: Vec<f64> = weights.iter().map(|weight| (weight / largest).sqrt()).collect();
    let weigh = |values: &[f64]| values.iter().zip(&roots).map(|(x, root)| x * root).collect::<Vec<f64>>();
    crate::certified::check(columns, y)?;
    let weighted: Vec<Vec<f64>> = columns.iter().map(|column| weigh(column)).collect();
    let weighted: Vec<&[f64]> = weighted.iter().map(Vec::as_slice).collect();
    let right = weigh(y);

    let scaled = scale(&weighted, &right)?;
    let (triangle, projected) = gram_schmidt(scaled.columns, right.clone())?;
    let solved = Solved {
        lengths: &scaled.lengths,
        scaled: triangle.solve(&projected),
        inverse_rows: triangle.inverse_rows(),
        condition: triangle.condition(),
        stability: Stability::Orthogonal,
    };
    let mut solution = finish(&weighted, &right, solved)?;
    solution.residual_std_dev *= largest.sqrt();
    Ok(solution)
}

/// Returns triangle and projections. The right-hand side is treated as one more column, which makes the
/// method as accurate as Householder's.
fn gram_schmidt(columns: Vec<Vec<f64>>, mut y: Vec<f64>) -> Result<(Triangle, Vec<f64>), OracleError> {
    let size = columns.len();
    let mut rest: std::collections::VecDeque<Vec<f64>> = columns.into();
    let mut triangle: Vec<Vec<f64>> = vec![Vec::new(); size];
    let mut projected = Vec::with_capacity(size);
    let mut done = 0;
    while let Some(mut column) = rest.pop_front() {
        let length = super::vectors::length(&column);
        if length == 0.0 {
            return Err(singular());
        }
        column.iter_mut().for_each(|x| *x /= length);
        let project = |target: &mut [f64]| {
            let share = super::vectors::dot(&column, target);
            super::vectors::add_scaled(target, -share, &column);
            share
        };
        let shares = std::iter::once(length).chain(rest.iter_mut().map(|target| project(target)));
        for (entries, share) in triangle.iter_mut().skip(done).zip(shares) {
            entries.push(share);
        }
        projected.push(project(&mut y));
        done += 1;
    }
    Ok((Triangle(triangle), projected))
}

#[cfg(test)]
mod tests {
    use super::least_squares;
    use crate::error::OracleError;

    #[test]
    fn a_weight_of_three_is_a_row_three_times() {
        let (x, y) = ([0.0, 1.0, 2.5, 4.0], [1.0, 0.5, 0.25, -2.0]);
        let weighted = least_squares(&[&[1.0; 4], &x], &y, &[1.0, 3.0, 1.0, 2.0]).unwrap();
        let (x, y) = ([0.0, 1.0, 1.0, 1.0, 2.5, 4.0, 4.0], [1.0, 0.5, 0.5, 0.5, 0.25, -2.0, -2.0]);
        let repeated = least_squares(&[&[1.0; 7], &x], &y, &[1.0; 7]).unwrap();
        for (one, other) in weighted.coefficients.iter().zip(&repeated.coefficients) {
            assert!((one - other).abs() < 1e-14, "{weighted:?} {repeated:?}");
        }
        // Five degrees of freedom instead of two.
        assert!((weighted.std_errors[1] / repeated.std_errors[1] - 2.5_f64.sqrt()).abs() < 1e-13);
    }

    #[test]
    fn a_common_factor_of_the_weights_changes_only_the_unit_variance() {
        let (x, y) = ([0.0, 1.0, 2.5, 4.0], [1.0, 0.5, 0.25, -2.0]);
        let one = least_squares(&[&[1.0; 4], &x], &y, &[1.0, 3.0, 1.0, 2.0]).unwrap();
        let other = least_squares(&[&[1.0; 4], &x], &y, &[4.0, 12.0, 4.0, 8.0]).unwrap();
        assert_eq!(one.coefficients, other.coefficients);
        assert!((one.std_errors[0] / other.std_errors[0] - 1.0).abs() < 1e-14);
        assert!((other.residual_std_dev / one.residual_std_dev - 2.0).abs() < 1e-14);
    }

    #[test]
    fn a_weight_that_is_not_positive_is_refused() {
        for weight in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = least_squares(&[&[1.0; 3]], &[1.0, 2.0, 3.0], &[1.0, weight, 1.0]).unwrap_err();
            assert!(matches!(error, OracleError::Weight { row: 2, .. }), "{error}");
        }
    }
}
