//! Certifying route: column-scaled QR in double-double arithmetic.

use crate::FEWEST_DIGITS;
use crate::double_double::{DoubleDouble, UNIT_ROUNDOFF, dot};
use crate::error::OracleError;

/// Significant decimal digits of a double.
const MOST_DIGITS: f64 = 15.65;

/// Presence of a constant column, which decides whether R² is about the mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Intercept {
    /// The columns contain a constant: R² = 1 − RSS / Σ(y − ȳ)².
    Included,
    /// The columns contain no constant: R² = 1 − RSS / Σy².
    None,
}

/// Linear least-squares fit.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearFit {
    /// Coefficients, in the order of the columns.
    pub coefficients: Vec<f64>,
    /// Standard errors of the coefficients, for independent residuals of one variance.
    pub std_errors: Vec<f64>,
    /// Residuals, in the order of the rows.
    pub residuals: Vec<f64>,
    /// Standard deviation of the residuals, √(RSS / (rows − columns)).
    pub residual_std_dev: f64,
    /// Coefficient of determination.
    pub r_squared: f64,
    /// Two-norm condition number of the design matrix with columns scaled to length one.
    pub condition: f64,
    /// Significant digits promised for every nonzero coefficient.
    pub promised_digits: f64,
}

/// Fits `y` by least squares on the columns of a design matrix, each a slice as long as `y`.
///
/// Columns are scaled to length one, orthogonalized by the modified Gram–Schmidt process with `y` as the last
/// column, and back-substituted, all in double-double arithmetic; the given doubles are taken as exact. The
/// promise is the forward-error bound c·u·(κ + κ²·tan θ) with u the unit roundoff, κ the condition number, θ
/// the angle between `y` and its fit, and c = 10·(rows + columns). It has been an upper bound for every
/// problem tried so far; it is not an estimate.
///
/// # Errors
/// [`OracleError::Shape`], [`OracleError::TooFewRows`] and [`OracleError::NotFinite`] for unusable input;
/// [`OracleError::IllConditioned`] if fewer than four digits can be promised.
///
/// # Reference
/// Björck, Numerical Methods for Least Squares Problems (SIAM 1996), sections 1.4 and 2.4.
pub fn least_squares(columns: &[&[f64]], y: &[f64], intercept: Intercept) -> Result<LinearFit, OracleError> {
    check(columns, y)?;
    let rows = y.len();
    let exact = |column: &[f64]| column.iter().map(|&x| DoubleDouble::from(x)).collect::<Vec<_>>();
    let mut scales = Vec::new();
    let mut q: Vec<Vec<DoubleDouble>> = Vec::new();
    for column in columns {
        let column = exact(column);
        let length = dot(&column, &column).sqrt();
        scales.push(length);
        q.push(column.into_iter().map(|x| x / length).collect());
    }
    let Triangle { r, rhs, residual } = orthogonalize(q, exact(y), &scales)?;

    let scaled = back_substitute(&r, &rhs);
    let condition = condition_number(&r);
    let rss = dot(&residual, &residual);
    let fitted_length = dot(&rhs, &rhs).sqrt().value();
    let tangent = if fitted_length > 0.0 { rss.sqrt().value() / fitted_length } else { 0.0 };
    let promised_digits = promise(condition, tangent, rows + columns.len(), scaled.iter().map(|x| x.value()));
    if promised_digits.is_nan() || promised_digits < FEWEST_DIGITS {
        return Err(OracleError::IllConditioned { promised: promised_digits, condition });
    }

    let degrees = DoubleDouble::from((rows - columns.len()) as f64);
    let variance = rss / degrees;
    let coefficients = scaled.iter().zip(&scales).map(|(&x, &scale)| (x / scale).value()).collect();
    let std_errors = inverse_row_lengths(&r)
        .into_iter()
        .zip(&scales)
        .map(|(length, &scale)| (length * variance.sqrt() / scale).value())
        .collect();
    let y = exact(y);
    let mean = match intercept {
        Intercept::Included => y.iter().copied().sum::<DoubleDouble>() / DoubleDouble::from(rows as f64),
        Intercept::None => DoubleDouble::ZERO,
    };
    let total: DoubleDouble = y.iter().map(|&y| (y - mean) * (y - mean)).sum();
    let r_squared = if total.is_zero() { 1.0 } else { (DoubleDouble::from(1.0) - rss / total).value() };
    Ok(LinearFit {
        coefficients,
        std_errors,
        residuals: residual.iter().map(|x| x.value()).collect(),
        residual_std_dev: variance.sqrt().value(),
        r_squared,
        condition,
        promised_digits,
    })
}

pub(crate) fn check(columns: &[&[f64]], y: &[f64]) -> Result<(), OracleError> {
    for (number, column) in (1..).zip(columns) {
        if column.len() != y.len() {
            return Err(OracleError::Shape { column: number, found: column.len(), expected: y.len() });
        }
    }
    if columns.is_empty() || y.len() <= columns.len() {
        return Err(OracleError::TooFewRows { rows: y.len(), columns: columns.len() });
    }
    for column in columns.iter().copied().chain([y]) {
        if let Some(at) = column.iter().position(|x| !x.is_finite()) {
            return Err(OracleError::NotFinite { row: at + 1 });
        }
    }
    Ok(())
}

/// Upper triangle by rows (row i holds columns i, i+1, …), with the transformed right-hand side and its
/// residual.
struct Triangle {
    r: Vec<Vec<DoubleDouble>>,
    rhs: Vec<DoubleDouble>,
    residual: Vec<DoubleDouble>,
}

/// Orthogonalizes by modified Gram–Schmidt. The right-hand side is treated as one more column, which makes
/// the method backward stable.
fn orthogonalize(
    columns: Vec<Vec<DoubleDouble>>,
    y: Vec<DoubleDouble>,
    scales: &[DoubleDouble],
) -> Result<Triangle, OracleError> {
    let singular = || OracleError::IllConditioned { promised: 0.0, condition: f64::INFINITY };
    if scales.iter().any(|scale| scale.is_zero()) {
        return Err(singular());
    }
    let mut rest = columns;
    let mut residual = y;
    let (mut r, mut rhs) = (Vec::new(), Vec::new());
    while !rest.is_empty() {
        let column = rest.remove(0);
        let length = dot(&column, &column).sqrt();
        // Only rounding remains of a column that the others span.
        if length.value() < 1e3 * UNIT_ROUNDOFF {
            return Err(singular());
        }
        let unit: Vec<DoubleDouble> = column.into_iter().map(|x| x / length).collect();
        let project = |target: &mut Vec<DoubleDouble>| {
            let share = dot(&unit, target);
            for (x, &direction) in target.iter_mut().zip(&unit) {
                *x = *x - share * direction;
            }
            share
        };
        let row = std::iter::once(length).chain(rest.iter_mut().map(project)).collect();
        r.push(row);
        rhs.push(project(&mut residual));
    }
    Ok(Triangle { r, rhs, residual })
}

/// Solves R·x = b.
fn back_substitute(r: &[Vec<DoubleDouble>], b: &[DoubleDouble]) -> Vec<DoubleDouble> {
    // Unknowns are solved from the last to the first.
    let mut solved: Vec<DoubleDouble> = Vec::new();
    for (row, &right) in r.iter().zip(b).rev() {
        let known: DoubleDouble = row.iter().skip(1).zip(solved.iter().rev()).map(|(&r, &x)| r * x).sum();
        if let Some(&diagonal) = row.first() {
            solved.push((right - known) / diagonal);
        }
    }
    solved.reverse();
    solved
}

/// Returns the lengths of the rows of R⁻¹: standard errors in units of the residual's standard deviation.
fn inverse_row_lengths(r: &[Vec<DoubleDouble>]) -> Vec<DoubleDouble> {
    let size = r.len();
    let mut squares = vec![DoubleDouble::ZERO; size];
    for at in 0..size {
        let unit: Vec<DoubleDouble> =
            (0..size).map(|row| DoubleDouble::from(if row == at { 1.0 } else { 0.0 })).collect();
        for (square, x) in squares.iter_mut().zip(back_substitute(r, &unit)) {
            *square = *square + x * x;
        }
    }
    squares.into_iter().map(DoubleDouble::sqrt).collect()
}

/// Returns the ratio of the largest to the smallest singular value, by one-sided Jacobi rotations of R's
/// rows.
///
/// Plain doubles suffice: if the rows are graded, the rotations find even small singular values to relative
/// accuracy, and the condition number is not needed to more than one digit.
fn condition_number(r: &[Vec<DoubleDouble>]) -> f64 {
    let size = r.len();
    let mut rows: Vec<Vec<f64>> = r
        .iter()
        .enumerate()
        .map(|(at, row)| std::iter::repeat_n(0.0, at).chain(row.iter().map(|x| x.value())).collect())
        .collect();
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for _sweep in 0..60 {
        let mut largest = 0.0_f64;
        for first in 0..size {
            let (head, tail) = rows.split_at_mut(first + 1);
            let Some(a) = head.last_mut() else { continue };
            for b in tail {
                let (aa, bb, ab) = (inner(a, a), inner(b, b), inner(a, b));
                let cosine = ab / (aa * bb).sqrt();
                if cosine.is_nan() || cosine.abs() < 1e-15 {
                    continue;
                }
                largest = largest.max(cosine.abs());
                let zeta = (bb - aa) / (2.0 * ab);
                let t = zeta.signum() / (zeta.abs() + libm::hypot(zeta, 1.0));
                let c = 1.0 / libm::hypot(t, 1.0);
                let s = c * t;
                for (x, y) in a.iter_mut().zip(b.iter_mut()) {
                    (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
                }
            }
        }
        if largest < 1e-12 {
            break;
        }
    }
    let lengths: Vec<f64> = rows.iter().map(|row| inner(row, row).sqrt()).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    longest / shortest
}

/// Returns the digits that the forward-error bound leaves for the smallest coefficient that is not zero to
/// within the bound.
fn promise(
    condition: f64,
    tangent: f64,
    size: usize,
    scaled_coefficients: impl Iterator<Item = f64> + Clone,
) -> f64 {
    let bound = 10.0 * size as f64 * UNIT_ROUNDOFF * (condition + condition * condition * tangent);
    let norm = scaled_coefficients.clone().map(|x| x * x).sum::<f64>().sqrt();
    if norm == 0.0 {
        return (-libm::log10(bound)).min(MOST_DIGITS);
    }
    let worst = scaled_coefficients
        .map(|x| bound * norm / x.abs())
        .filter(|relative| *relative < 1.0)
        .fold(bound, f64::max);
    (-libm::log10(worst)).min(MOST_DIGITS)
}

#[cfg(test)]
mod tests {
    use super::{Intercept, least_squares, promise};
    use crate::double_double::UNIT_ROUNDOFF;
    use crate::error::OracleError;

    #[test]
    fn dependent_columns_are_refused() {
        let one = [1.0; 5];
        let two = [2.0; 5];
        let error = least_squares(&[&one, &two], &[1.0, 2.0, 3.0, 4.0, 5.0], Intercept::Included);
        assert!(matches!(error, Err(OracleError::IllConditioned { .. })), "{error:?}");
    }

    #[test]
    fn a_high_polynomial_with_residuals_is_refused_with_numbers() {
        let powers: Vec<Vec<f64>> =
            (0..24).map(|power| (0..60).map(|x| f64::from(x).powi(power)).collect()).collect();
        let columns: Vec<&[f64]> = powers.iter().map(Vec::as_slice).collect();
        let y: Vec<f64> = (0..60).map(|x| f64::from(x * 7919 % 101)).collect();
        let message = least_squares(&columns, &y, Intercept::Included).unwrap_err().to_string();
        assert!(message.contains("at least 4 are needed"), "{message}");
    }

    #[test]
    fn the_condition_number_of_two_columns_is_the_one_of_their_angle() {
        // Unit columns at an angle with cosine c: κ² = (1 + c)/(1 − c).
        let one = [1.0; 4];
        let t = [0.0, 1.0, 2.0, 3.0];
        let fit = least_squares(&[&one, &t], &[0.0, 1.0, 1.0, 2.0], Intercept::Included).unwrap();
        let c: f64 = 6.0 / (2.0 * 14_f64.sqrt());
        assert!((fit.condition - ((1.0 + c) / (1.0 - c)).sqrt()).abs() < 1e-12);
        assert!(fit.promised_digits > 15.0);
    }

    #[test]
    fn unusable_input_is_refused() {
        let one = [1.0, 1.0];
        assert_eq!(
            least_squares(&[&one, &one], &one, Intercept::None),
            Err(OracleError::TooFewRows { rows: 2, columns: 2 })
        );
        assert_eq!(
            least_squares(&[&[1.0, f64::NAN, 2.0]], &[1.0; 3], Intercept::None),
            Err(OracleError::NotFinite { row: 2 })
        );
        assert_eq!(
            least_squares(&[&one], &[1.0; 3], Intercept::None),
            Err(OracleError::Shape { column: 1, found: 2, expected: 3 })
        );
    }

    /// y = 1 + 2x + 3x² with residuals orthogonal to 1, x and x²: (−1, 3, −3, 1) on four even points.
    #[test]
    fn a_parabola_by_hand() {
        let x = [0.0, 1.0, 2.0, 3.0];
        let square: Vec<f64> = x.iter().map(|x| x * x).collect();
        let off = [-1.0, 3.0, -3.0, 1.0];
        let y: Vec<f64> = x.iter().zip(off).map(|(x, off)| 1.0 + 2.0 * x + 3.0 * x * x + off).collect();
        let fit = least_squares(&[&[1.0; 4], &x, &square], &y, Intercept::Included).unwrap();
        for (found, expected) in fit.coefficients.iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-15, "{fit:?}");
        }
        for (found, expected) in fit.residuals.iter().zip(off) {
            assert!((found - expected).abs() < 1e-14, "{fit:?}");
        }
        // One degree of freedom: σ² = 20. The diagonal of (XᵀX)⁻¹ is 19/20, 49/20, 1/4.
        assert!((fit.residual_std_dev - 20_f64.sqrt()).abs() < 1e-14);
        for (found, expected) in fit.std_errors.iter().zip([19_f64, 49.0, 5.0]) {
            assert!((found - expected.sqrt()).abs() < 1e-13, "{fit:?}");
        }
        // y = 0, 9, 14, 35 has the mean 14.5: Σ(y − ȳ)² = 661, Σy² = 1502.
        assert!((fit.r_squared - (1.0 - 20.0 / 661.0)).abs() < 1e-15);
        let about_zero = least_squares(&[&[1.0; 4], &x, &square], &y, Intercept::None).unwrap();
        assert!((about_zero.r_squared - (1.0 - 20.0 / 1502.0)).abs() < 1e-15);
        assert_eq!(about_zero.coefficients, fit.coefficients);
    }

    #[test]
    fn a_constant_is_met_whole() {
        let fit = least_squares(&[&[1.0; 3]], &[0.0; 3], Intercept::Included).unwrap();
        assert_eq!((fit.coefficients[0], fit.r_squared, fit.residual_std_dev), (0.0, 1.0, 0.0));
    }

    /// Singular values of a product do not depend on the order of the columns, and for orthogonal ones they
    /// are equal.
    #[test]
    fn condition_numbers_of_known_matrices() {
        let condition = |columns: &[&[f64]]| {
            let y: Vec<f64> = (0..columns[0].len()).map(|row| f64::from(u32::from(row == 0))).collect();
            least_squares(columns, &y, Intercept::None).unwrap().condition
        };
        let (a, b, c) = ([1.0, 1.0, 1.0, 1.0], [5.0, -5.0, 5.0, -5.0], [0.1, 0.1, -0.1, -0.1]);
        assert!((condition(&[&a, &b, &c]) - 1.0).abs() < 1e-12);
        // Three unit columns with the cosine c between any two: eigenvalues 1 + 2c and 1 − c.
        let cosine = 0.9_f64;
        let diagonal = |at: usize| {
            let (large, small) = ((1.0 + 2.0 * cosine).sqrt(), (1.0 - cosine).sqrt());
            let mean = (large - small) / 3.0;
            (0..4)
                .map(|row| if row == 3 { 0.0 } else { mean + if row == at { small } else { 0.0 } })
                .collect::<Vec<f64>>()
        };
        let columns = [diagonal(0), diagonal(1), diagonal(2)];
        let expected = ((1.0 + 2.0 * cosine) / (1.0 - cosine)).sqrt();
        for order in [[0, 1, 2], [2, 0, 1], [1, 0, 2]] {
            let found = condition(&order.map(|at: usize| columns[at].as_slice()));
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }

    /// Bound by its formula: ten times the size, u, and κ + κ²·tan θ, over the smallest share that exceeds
    /// it.
    #[test]
    fn the_promise_is_the_bound_s() {
        let digits = |condition, tangent, coefficients: &[f64]| {
            promise(condition, tangent, 7, coefficients.iter().copied())
        };
        let bound = 70.0 * UNIT_ROUNDOFF * (1e10 + 1e20 * 0.5);
        assert!((digits(1e10, 0.5, &[3.0]) + bound.log10()).abs() < 1e-12);
        // A coefficient of a hundredth of the norm has two digits fewer; one below the bound does not count.
        let two = digits(1e10, 0.5, &[1.0, 0.01]);
        assert!((two + bound.log10() - (-2.0 - 0.5 * 1.0001_f64.log10())).abs() < 1e-12, "{two}");
        assert_eq!(digits(1e10, 0.5, &[1.0, 1e-13]), digits(1e10, 0.5, &[1.0]));
        assert!((digits(1e10, 0.5, &[0.0, 0.0]) + bound.log10()).abs() < 1e-12);
        // No double has more digits.
        assert_eq!(digits(1.0, 0.0, &[1.0]), 15.65);
        assert_eq!(digits(1.0, 0.0, &[0.0]), 15.65);
    }

    /// Test of nearly equal columns: residuals cost the digits given by κ²·tan θ.
    #[test]
    fn residuals_cost_digits() {
        let near: Vec<f64> = (0..6).map(|x| 1.0 + 1e-9 * f64::from(x)).collect();
        let fit = |off: f64| {
            let y: Vec<f64> = (0..6).map(|x| f64::from(x) + off * f64::from(x * x % 3)).collect();
            least_squares(&[&[1.0; 6], &near], &y, Intercept::Included).unwrap()
        };
        let scattered = fit(1.0);
        let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
        let rest = square(&mut scattered.residuals.iter().copied());
        let all = square(&mut (0..6).map(|x| f64::from(x) + f64::from(x * x % 3)));
        let tangent = (rest / (all - rest)).sqrt();
        let bound = 80.0 * UNIT_ROUNDOFF * scattered.condition.powi(2) * tangent;
        // Both coefficients have the same size, and the norm is √2 times either.
        let expected = -(bound * 2_f64.sqrt()).log10();
        assert!((scattered.promised_digits - expected).abs() < 1e-3, "{scattered:?} {expected}");
        assert!(fit(0.0).promised_digits > expected + 2.0);
    }
}
