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
    /// linfa refused.
    #[error("linfa-linear: {problem}")]
    Library {
        /// What it says.
        problem: String,
    },
}
