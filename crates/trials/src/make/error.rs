//! Why a case cannot be made.

use dynamics::DynamicsError;
use record::{Fault, RecordError};
use simulator::GenerationError;
use thiserror::Error;

/// Why a case cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrialError {
    /// A case beyond the plan's.
    #[error("there is no case {index}; the plan has {cases}, counted from 0")]
    NoSuchCase {
        /// The number asked for.
        index: usize,
        /// How many there are.
        cases: usize,
    },
    /// The system, its motion or its measurement chain is impossible.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A record could not be generated.
    #[error(transparent)]
    Generation(#[from] GenerationError),
    /// Remainder of the measurement chain that is no record.
    #[error("what is left is no record: {0}")]
    Fault(#[from] Fault),
    /// A file of a bank from outside cannot be read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// No size of an effect is as detectable as wanted.
    #[error(
        "{effect}: no size reaches a detectability of {wanted} in {attempts} draws of system and shape; lengthen the record (record.seconds) or leave that detectability out (trials.detectabilities)"
    )]
    OutOfReach {
        /// The effect's id, or the name of the law.
        effect: String,
        /// The detectability wanted.
        wanted: f64,
        /// How many were drawn.
        attempts: usize,
    },
    /// A pair of which one is no effect.
    #[error("there is no effect {id}: a pair names it")]
    NoEffect {
        /// The id.
        id: String,
    },
    /// Nothing to hide, or no size to hide it at.
    #[error(
        "{kinds} things to hide at {sizes} sizes: name a detectability (trials.detectabilities), or no case of this bank"
    )]
    NothingInTurn {
        /// Number of things that take turns.
        kinds: usize,
        /// Number of detectabilities.
        sizes: usize,
    },
    /// A recalibration without a unique answer: the record is too short for its period.
    #[error("the recalibration is singular: {samples} samples do not determine {unknowns} unknowns")]
    Singular {
        /// Number of samples.
        samples: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A file of a bank from outside that says what it must not.
    #[error("{path}: {problem}; {remedy}")]
    Outside {
        /// The file.
        path: String,
        /// What is wrong with it.
        problem: String,
        /// What to do.
        remedy: &'static str,
    },
}
