//! Errors in making a case.

use dynamics::DynamicsError;
use record::{Fault, RecordError};
use simulator::GenerationError;
use thiserror::Error;

/// Reason why a case cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrialError {
    /// The number is beyond the plan's cases.
    #[error("there is no case {index}; the plan has {cases}, counted from 0")]
    NoSuchCase {
        /// Requested number.
        index: usize,
        /// Number of cases.
        cases: usize,
    },
    /// The system, its motion or its measurement chain is impossible.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A record could not be generated.
    #[error(transparent)]
    Generation(#[from] GenerationError),
    /// The output of the measurement chain is no valid record.
    #[error("the remaining samples are not a record: {0}")]
    Fault(#[from] Fault),
    /// An external file of a bank cannot be read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// No size of an effect reaches the wanted detectability.
    #[error(
        "{effect}: no size reaches a detectability of {wanted} in {attempts} draws of system and shape; lengthen the record (record.seconds) or leave that detectability out (trials.detectabilities)"
    )]
    OutOfReach {
        /// Identifier of the effect, or name of the law.
        effect: String,
        /// Wanted detectability.
        wanted: f64,
        /// Number of draws of system and shape.
        attempts: usize,
    },
    /// One half of a pair is no effect of the vocabulary.
    #[error("there is no effect {id}: a pair names it")]
    NoEffect {
        /// Unknown identifier.
        id: String,
    },
    /// There is nothing to hide, or no detectability to hide it at.
    #[error(
        "{kinds} things to hide at {sizes} sizes: name a detectability (trials.detectabilities), or no case of this bank"
    )]
    NothingInTurn {
        /// Number of different things to hide.
        kinds: usize,
        /// Number of detectabilities.
        sizes: usize,
    },
    /// A recalibration has no unique answer: the record is too short for its period.
    #[error("the recalibration is singular: {samples} samples do not determine {unknowns} unknowns")]
    Singular {
        /// Number of samples.
        samples: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// An external file of a bank has contents that it must not have.
    #[error("{path}: {problem}; {remedy}")]
    Outside {
        /// Path of the file.
        path: String,
        /// Fault of the file.
        problem: String,
        /// Remedy.
        remedy: &'static str,
    },
}
