//! Why the oracle does not answer.

use crate::FEWEST_DIGITS;
use thiserror::Error;

/// Why the oracle does not answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OracleError {
    /// The conditioning leaves too few digits.
    #[error(
        "least squares can promise {promised:.1} digits here (condition number {condition:.1e}); at \
         least {FEWEST_DIGITS} are needed. Remove columns that are nearly combinations of others, or \
         shift and scale them"
    )]
    IllConditioned {
        /// Digits that can be promised.
        promised: f64,
        /// Condition number of the column-scaled design matrix.
        condition: f64,
    },
    /// Fewer rows than columns, or just as many: no residual is left to tell an error from.
    #[error("{rows} points do not determine {columns} coefficients and their errors")]
    TooFewRows {
        /// Rows of the design matrix.
        rows: usize,
        /// Columns of the design matrix.
        columns: usize,
    },
    /// Columns of different lengths, or none.
    #[error("column {column} has {found} entries; expected {expected}")]
    Shape {
        /// Number of the column, from 1.
        column: usize,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },
    /// A number that is infinite or no number.
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
        /// The weight.
        weight: f64,
    },
    /// Bounds with nothing between them, or not one pair for each parameter.
    #[error("parameter {parameter} has no room between its bounds {low} and {high}")]
    Bounds {
        /// Number of the parameter, from 1.
        parameter: usize,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// linfa refused.
    #[error("linfa-linear: {problem}")]
    Library {
        /// What it says.
        problem: String,
    },
}
