//! Errors of a simulated record.

use dynamics::DynamicsError;
use record::Fault;
use thiserror::Error;
use truth::SealError;

/// Error for a record that cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GenerationError {
    /// The system, its motion or its measurement chain is impossible.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// The samples that the measurement chain leaves do not form a record.
    #[error("the remaining samples are not a record: {0}")]
    Record(#[from] Fault),
    /// The sampling is invalid.
    #[error("the sampling's {what} is {value}; expected {expected}")]
    Sampling {
        /// Name of the wrong number.
        what: &'static str,
        /// Value of that number.
        value: f64,
        /// Admissible values.
        expected: &'static str,
    },
    /// The system has no record with this number.
    #[error("a system has no record {record}; numbers run from 0 to one below simulate.records")]
    NoSuchRecord {
        /// Number requested.
        record: usize,
    },
    /// The truth could not be sealed.
    #[error(transparent)]
    Seal(#[from] SealError),
}
