//! Errors of the oracle.

use crate::FEWEST_DIGITS;
use thiserror::Error;

/// Reason why the oracle gives no answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OracleError {
    /// The conditioning leaves too few digits.
    #[error(
        "least squares can promise {promised:.1} digits here (condition number {condition:.1e}); at \
         least {FEWEST_DIGITS} are needed. Remove columns that are nearly combinations of others, or \
         shift and scale them"
    )]
    IllConditioned {
        /// Number of digits that can be promised.
        promised: f64,
        /// Condition number of the column-scaled design matrix.
        condition: f64,
    },
    /// At most as many rows as columns: no residual is left to estimate errors from.
    #[error("{rows} points do not determine {columns} coefficients and their errors")]
    TooFewRows {
        /// Number of rows of the design matrix.
        rows: usize,
        /// Number of columns of the design matrix.
        columns: usize,
    },
    /// Columns of different lengths, or none.
    #[error("column {column} has {found} entries; expected {expected}")]
    Shape {
        /// Number of the column, from 1.
        column: usize,
        /// Number of entries found.
        found: usize,
        /// Number of entries expected.
        expected: usize,
    },
    /// A number is infinite or NaN.
    #[error("row {row} holds a number that is not finite")]
    NotFinite {
        /// Number of the row, from 1.
        row: usize,
    },
    /// A weight that is not positive and finite.
    #[error("row {row} has weight {weight}; weights must be positive and finite. Leave the row out instead")]
    Weight {
        /// Number of the row, from 1.
        row: usize,
        /// Value of the weight.
        weight: f64,
    },
    /// Bounds have nothing between them, or there is not one pair for each parameter.
    #[error("parameter {parameter} has no room between its bounds {low} and {high}")]
    Bounds {
        /// Number of the parameter, from 1.
        parameter: usize,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// linfa returned an error.
    #[error("linfa-linear: {problem}")]
    Library {
        /// Message of linfa.
        problem: String,
    },
}
