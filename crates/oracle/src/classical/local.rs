//! Least-squares problem at one point: residuals, Jacobian, and their orthogonality.

use super::Reached;
use super::problem::{LeastSquaresProblem, LeastSquaresSolution, Limits};
use super::qr::{Factor, factorize};
use super::vectors::{UNIT_ROUNDOFF, finite, length, times};
use crate::error::OracleError;

/// Condition number of the unit-column Jacobian above which orthogonality does not determine the parameters,
/// so that no search counts as converged.
const WORST_CONDITION: f64 = 1e12;

/// Rounding errors of residuals, in units of the roundoff of the data.
pub(super) const ROUNDING: f64 = 8.0;

/// Residuals and Jacobian at one point, with the Jacobian as Q·R·diag(lengths).
pub(super) struct Local {
    /// Length of the residuals.
    pub(super) size: f64,
    /// Lengths of the Jacobian's columns; 1 for a column of zeros.
    pub(super) lengths: Vec<f64>,
    /// Factors of the Jacobian with unit columns; the right-hand side is the residuals.
    pub(super) factor: Factor,
    /// Reference length of the orthogonality: the length of the residuals, plus rounding over tolerance.
    pub(super) reference: f64,
    /// Length of the residuals' part in the tangent space, over the reference.
    pub(super) orthogonality: f64,
    /// Condition number of the Jacobian with unit columns.
    pub(super) condition: f64,
}

impl Local {
    /// Evaluates a problem; `None` if a number is not finite.
    pub(super) fn evaluate(problem: &impl LeastSquaresProblem, at: &[f64], limits: &Limits) -> Option<Self> {
        let residuals = problem.residuals(at);
        let mut columns = problem.jacobian(at);
        if !finite(&residuals) || !columns.iter().all(|column| finite(column)) {
            return None;
        }
        let lengths: Vec<f64> = columns
            .iter()
            .map(|column| match length(column) {
                0.0 => 1.0,
                length => length,
            })
            .collect();
        for (column, length) in columns.iter_mut().zip(&lengths) {
            column.iter_mut().for_each(|x| *x /= length);
        }
        let size = length(&residuals);
        let factor = factorize(columns, residuals);
        let reference = size + ROUNDING * UNIT_ROUNDOFF * problem.data_length() / limits.tolerance;
        let condition = factor.triangle.condition();
        let offset = length(&factor.projected);
        let orthogonality = if offset == 0.0 { 0.0 } else { offset / reference };
        (size.is_finite() && orthogonality.is_finite()).then_some(Self {
            size,
            lengths,
            factor,
            reference,
            orthogonality,
            condition,
        })
    }

    /// Evaluates a problem at its start.
    pub(super) fn start(
        problem: &impl LeastSquaresProblem,
        at: &[f64],
        limits: &Limits,
    ) -> Result<Self, OracleError> {
        let residuals = problem.residuals(at);
        if let Some(row) = residuals.iter().position(|residual| !residual.is_finite()) {
            return Err(OracleError::NotFinite { row: row + 1 });
        }
        if residuals.len() < at.len() || at.is_empty() {
            return Err(OracleError::TooFewRows { rows: residuals.len(), columns: at.len() });
        }
        Self::evaluate(problem, at, limits).ok_or(OracleError::NotFinite { row: 1 })
    }

    /// Returns half the gradient of the sum of squares, Jᵀr.
    pub(super) fn gradient(&self) -> Vec<f64> {
        let products: Vec<f64> = self
            .factor
            .triangle
            .0
            .iter()
            .map(|column| super::vectors::dot(column, &self.factor.projected))
            .collect();
        times(&products, &self.lengths)
    }

    /// Returns `true` if an orthogonality counts as converged at this point.
    pub(super) fn is_stationary(&self, orthogonality: f64, limits: &Limits) -> bool {
        orthogonality <= limits.tolerance && self.condition < WORST_CONDITION
    }

    /// Returns the relative gain in the sum of squares below which it cannot be told from rounding.
    pub(super) fn flat(&self, problem: &impl LeastSquaresProblem) -> f64 {
        (4.0 * ROUNDING * UNIT_ROUNDOFF * problem.data_length() / self.size).clamp(1e-12, 0.1)
    }

    /// Returns the solution that a search reports from this point.
    pub(super) fn report(
        &self,
        parameters: Vec<f64>,
        steps: u64,
        reached: Reached,
        orthogonality: f64,
        limits: &Limits,
    ) -> LeastSquaresSolution {
        let rows = self.factor.projected.len() + self.factor.rest.len();
        let degrees = rows - parameters.len();
        let std_errors = (degrees > 0 && self.condition < WORST_CONDITION).then(|| {
            let deviation = self.size / (degrees as f64).sqrt();
            let inverse = self.factor.triangle.inverse_rows();
            inverse.iter().zip(&self.lengths).map(|(row, scale)| length(row) * deviation / scale).collect()
        });
        let state = format!("orthogonality {orthogonality:.1e} after {steps} steps");
        let because = match reached {
            Reached::Converged => format!("{state}, at most {:.0e} wanted", limits.tolerance),
            Reached::BudgetSpent => {
                format!("{state}, the budget; {:.0e} wanted. Raise the budget", limits.tolerance)
            }
            Reached::Stalled => format!(
                "{state} at condition number {:.1e} and no step gains; {:.0e} wanted. Try another start",
                self.condition, limits.tolerance
            ),
        };
        LeastSquaresSolution {
            parameters,
            sum_of_squares: self.size * self.size,
            std_errors,
            orthogonality,
            condition: self.condition,
            steps,
            reached,
            because,
        }
    }
}
