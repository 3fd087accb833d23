//! Shared parts of the linear routes: scaling, triangles, and the promise of digits.

use super::jacobi::{Decomposition, singular_values, transpose};
use super::vectors::{UNIT_ROUNDOFF, combine, dot, finite, length};
use super::{ClassicalFit, Reached};
use crate::FEWEST_DIGITS;
use crate::certified::check;
use crate::error::OracleError;
use envelope::Envelope;

/// Significant decimal digits of a double.
const MOST_DIGITS: f64 = 15.65;

/// Number of roundings in scaling the columns and scaling back.
const SCALING: f64 = 4.0;

/// Linear least-squares fit in plain double precision.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearSolution {
    /// Coefficients, in the order of the columns.
    pub coefficients: Vec<f64>,
    /// Standard errors of the coefficients, for independent residuals of one variance.
    pub std_errors: Vec<f64>,
    /// Standard deviation of the residuals, √(RSS / (rows − columns)).
    pub residual_std_dev: f64,
    /// Two-norm condition number of the design matrix with columns scaled to length one.
    pub condition: f64,
    /// Significant digits promised for every coefficient that is not zero to within its bound.
    pub promised_digits: f64,
}

/// Design matrix whose columns were divided by their lengths.
pub(super) struct Scaled {
    pub(super) columns: Vec<Vec<f64>>,
    pub(super) lengths: Vec<f64>,
}

/// Checks a problem and scales its columns to length one.
pub(super) fn scale(columns: &[&[f64]], y: &[f64]) -> Result<Scaled, OracleError> {
    check(columns, y)?;
    let lengths: Vec<f64> = columns.iter().map(|column| length(column)).collect();
    if lengths.iter().any(|length| *length == 0.0 || !length.is_finite()) {
        return Err(singular());
    }
    let columns = columns
        .iter()
        .zip(&lengths)
        .map(|(column, length)| column.iter().map(|x| x / length).collect())
        .collect();
    Ok(Scaled { columns, lengths })
}

pub(super) fn singular() -> OracleError {
    OracleError::IllConditioned { promised: 0.0, condition: f64::INFINITY }
}

/// Upper triangle R by columns: column j holds rows 0 to j.
#[derive(Debug, Clone)]
pub(super) struct Triangle(pub(super) Vec<Vec<f64>>);

impl Triangle {
    /// Returns `true` if a diagonal entry is zero.
    pub(super) fn is_singular(&self) -> bool {
        self.0.iter().any(|column| column.last().is_none_or(|diagonal| *diagonal == 0.0))
    }

    /// Solves R·x = b, with `b` as long as the number of columns of R.
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut rest = b.to_vec();
        let mut solution = Vec::with_capacity(rest.len());
        for column in self.0.iter().rev() {
            let (Some(right), Some((diagonal, above))) = (rest.pop(), column.split_last()) else {
                break;
            };
            let value = right / diagonal;
            for (rest, r) in rest.iter_mut().zip(above) {
                *rest -= value * r;
            }
            solution.push(value);
        }
        solution.reverse();
        solution
    }

    /// Solves Rᵀ·x = b.
    pub(super) fn solve_transposed(&self, b: &[f64]) -> Vec<f64> {
        let mut solution: Vec<f64> = Vec::with_capacity(b.len());
        for (column, right) in self.0.iter().zip(b) {
            if let Some((diagonal, above)) = column.split_last() {
                let value = (right - dot(above, &solution)) / diagonal;
                solution.push(value);
            }
        }
        solution
    }

    /// Returns the rows of the inverse: row i is R⁻ᵀ·eᵢ.
    pub(super) fn inverse_rows(&self) -> Vec<Vec<f64>> {
        super::vectors::diagonal(&vec![1.0; self.0.len()]).map(|unit| self.solve_transposed(&unit)).collect()
    }

    /// Returns the columns, including the zeros below the diagonal.
    pub(super) fn square(&self) -> Vec<Vec<f64>> {
        let size = self.0.len();
        self.0
            .iter()
            .map(|column| column.iter().copied().chain(std::iter::repeat(0.0)).take(size).collect())
            .collect()
    }

    /// Returns the two-norm condition number with columns scaled to length one; infinite if R is singular.
    pub(super) fn condition(&self) -> f64 {
        if self.is_singular() || !self.0.iter().all(|column| finite(column)) {
            return f64::INFINITY;
        }
        let mut columns = self.square();
        for column in &mut columns {
            let length = length(column);
            column.iter_mut().for_each(|x| *x /= length);
        }
        ratio(&singular_values(columns))
    }
}

/// Returns the ratio of the largest to the smallest value.
pub(super) fn ratio(values: &[f64]) -> f64 {
    let largest = values.iter().copied().fold(0.0, f64::max);
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    if smallest > 0.0 { largest / smallest } else { f64::INFINITY }
}

/// Effect of rounding errors.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Stability {
    /// Small relative changes of each column: orthogonal transformations, and centered sums.
    Orthogonal,
    /// Changes of the matrix of the normal equations.
    NormalEquations,
}

/// Solution of the scaled problem, with the data for its error bounds.
pub(super) struct Solved<'a> {
    pub(super) lengths: &'a [f64],
    /// Coefficients of the scaled columns.
    pub(super) scaled: Vec<f64>,
    /// Rows of a matrix M with M·Mᵀ = (AᵀA)⁻¹, A the scaled design matrix.
    pub(super) inverse_rows: Vec<Vec<f64>>,
    pub(super) condition: f64,
    pub(super) stability: Stability,
}

impl<'a> Solved<'a> {
    /// Solves U·Σ·Vᵀ·x = `right` by x = V·Σ⁻¹·Uᵀ·`right`; `condition` is the ratio of Σ, and `lengths` are those of the
    /// columns before they were scaled.
    pub(super) fn by_singular_values(
        parts: &Decomposition,
        condition: f64,
        right: &[f64],
        lengths: &'a [f64],
    ) -> Self {
        let Decomposition { left, values, right: directions } = parts;
        let shares: Vec<f64> =
            left.iter().zip(values).map(|(left, value)| dot(left, right) / value).collect();
        let weighted: Vec<Vec<f64>> = directions
            .iter()
            .zip(values)
            .map(|(direction, value)| direction.iter().map(|x| x / value).collect())
            .collect();
        Self {
            lengths,
            scaled: combine(directions, &shares),
            inverse_rows: transpose(&weighted),
            condition,
            stability: Stability::Orthogonal,
        }
    }
}

/// Converts a solution of the scaled problem to one of the given problem, with its promise.
///
/// The error of each coefficient x of the scaled columns is at most c·u·(‖Mᵢ‖·‖x‖₁ + ‖(AᵀA)⁻¹ᵢ‖₁·‖r‖) for
/// orthogonal transformations, whose rounding is a relative change of c·u in each column. For the normal
/// equations it is at most c·u·‖(AᵀA)⁻¹ᵢ‖₁·(‖x‖₁ + ‖y‖). Here r are the residuals, and c = 1 + √rows models
/// the random walk of rounding errors. This is an upper bound on every one of NIST's linear sets and on
/// thousands of random ones (in the tests). It is not a theorem: the theorem has c proportional to
/// rows·columns.
///
/// Reference: Higham, Accuracy and Stability of Numerical Algorithms (2nd ed., SIAM 2002), section 20.
pub(super) fn finish(columns: &[&[f64]], y: &[f64], solved: Solved) -> Result<LinearSolution, OracleError> {
    let Solved { lengths, scaled, inverse_rows, condition, stability } = solved;
    let coefficients: Vec<f64> = scaled.iter().zip(lengths).map(|(x, length)| x / length).collect();
    let mut residuals = y.to_vec();
    for (column, coefficient) in columns.iter().zip(&coefficients) {
        for (residual, x) in residuals.iter_mut().zip(*column) {
            *residual = (-coefficient).mul_add(*x, *residual);
        }
    }
    let rest = length(&residuals);
    let sum: f64 = scaled.iter().map(|x| x.abs()).sum();
    let share = (1.0 + (y.len() as f64).sqrt()) * UNIT_ROUNDOFF;
    let bounds = inverse_rows.iter().map(|row| {
        let inverse_sum: f64 = inverse_rows.iter().map(|other| dot(row, other).abs()).sum();
        match stability {
            Stability::Orthogonal => share * (length(row) * sum + inverse_sum * rest),
            Stability::NormalEquations => share * inverse_sum * (sum + length(y)),
        }
    });
    let promised_digits = promise(&scaled, bounds);
    if promised_digits.is_nan() || promised_digits < FEWEST_DIGITS || !finite(&coefficients) {
        return Err(OracleError::IllConditioned { promised: promised_digits, condition });
    }
    let degrees = (y.len() - columns.len()) as f64;
    let residual_std_dev = rest / degrees.sqrt();
    let std_errors =
        inverse_rows.iter().zip(lengths).map(|(row, scale)| length(row) * residual_std_dev / scale).collect();
    Ok(LinearSolution { coefficients, std_errors, residual_std_dev, condition, promised_digits })
}

/// Returns the digits that the bounds leave: for the vector of coefficients as a whole, and for each
/// coefficient that exceeds its bound.
fn promise(scaled: &[f64], bounds: impl Iterator<Item = f64>) -> f64 {
    let norm = length(scaled);
    let worst = scaled
        .iter()
        .zip(bounds)
        .map(|(x, bound)| {
            let alone = bound / x.abs() + SCALING * UNIT_ROUNDOFF;
            let together = if norm > 0.0 { bound / norm } else { 0.0 };
            if alone < 1.0 { alone.max(together) } else { together }
        })
        .fold(UNIT_ROUNDOFF, |worst, share| if share.is_nan() { share } else { worst.max(share) });
    (-libm::log10(worst)).min(MOST_DIGITS)
}

/// Fits the line of an envelope by a linear route.
pub(super) fn fit_line(
    envelope: &Envelope,
    solve: impl Fn(&[&[f64]], &[f64]) -> Result<LinearSolution, OracleError>,
) -> Result<ClassicalFit, OracleError> {
    let ones = vec![1.0; envelope.len()];
    let solution = solve(&[&ones, envelope.times_s()], envelope.log_amplitudes())?;
    line_from(envelope, &solution)
}

/// Returns the decay for a line's constant and slope.
pub(super) fn line_from(envelope: &Envelope, solution: &LinearSolution) -> Result<ClassicalFit, OracleError> {
    let (&[log_amplitude, slope], &[_, std_error]) =
        (solution.coefficients.as_slice(), solution.std_errors.as_slice())
    else {
        return Err(OracleError::TooFewRows { rows: envelope.len(), columns: 2 });
    };
    Ok(ClassicalFit {
        decay_rate: -slope,
        log_amplitude,
        std_error: Some(std_error),
        promised_digits: Some(solution.promised_digits),
        steps: 1,
        reached: Reached::Converged,
        because: format!(
            "direct solution; {:.1} digits promised at condition number {:.1}",
            solution.promised_digits, solution.condition
        ),
    })
}
