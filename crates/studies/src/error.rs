//! Errors of preparing a study.

use envelope::EnvelopeError;
use oracle::OracleError;
use record::RecordError;
use simulator::SimulationError;
use thiserror::Error;

/// Reason why a problem cannot be studied.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The record file cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// No envelope can be extracted from the record.
    #[error("{file}: {source}")]
    Envelope {
        /// Name of the record's file.
        file: String,
        /// Reason.
        source: EnvelopeError,
    },
    /// No line can be fitted to the envelope.
    #[error("problem.{problem}: {source}")]
    Oracle {
        /// Name of the problem.
        problem: String,
        /// Reason.
        source: OracleError,
    },
    /// The problem cannot be simulated.
    #[error("problem.{problem}: {source}")]
    Simulation {
        /// Name of the problem.
        problem: String,
        /// Reason.
        source: SimulationError,
    },
    /// There are too few peaks to hold some out.
    #[error(
        "problem.{problem}: {peaks} peaks cannot be split: {missing}; lower predict.block_peaks or \
         predict.last_share, or give an envelope with more peaks"
    )]
    Split {
        /// Name of the problem.
        problem: String,
        /// Number of its peaks.
        peaks: usize,
        /// Requirement of the split that is not met.
        missing: &'static str,
    },
}
