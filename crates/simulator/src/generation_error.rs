//! Why a record could not be simulated.

use dynamics::DynamicsError;
use record::Fault;
use thiserror::Error;
use truth::SealError;

/// Why a record could not be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GenerationError {
    /// The system, its motion or its measuring chain is impossible.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// Remainder of the measurement chain that is no record.
    #[error("what is left is no record: {0}")]
    Record(#[from] Fault),
    /// A sampling that is none.
    #[error("the sampling's {what} is {value}; expected {expected}")]
    Sampling {
        /// Which of its numbers.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is admitted.
        expected: &'static str,
    },
    /// A record beyond those of a system.
    #[error("a system has no record {record}; numbers run from 0 to one below simulate.records")]
    NoSuchRecord {
        /// The number asked for.
        record: usize,
    },
    /// The truth could not be sealed.
    #[error(transparent)]
    Seal(#[from] SealError),
}
