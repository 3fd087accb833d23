//! What preparing a study can fail of.

use envelope::EnvelopeError;
use oracle::OracleError;
use record::RecordError;
use simulator::SimulationError;
use thiserror::Error;

/// Why a problem cannot be studied.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The record file cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The record has no envelope.
    #[error("{file}: {source}")]
    Envelope {
        /// The record's file.
        file: String,
        /// Why.
        source: EnvelopeError,
    },
    /// No line can be fitted to the envelope.
    #[error("{file}: {source}")]
    Oracle {
        /// The problem, by its key.
        file: String,
        /// Why.
        source: OracleError,
    },
    /// The problem cannot be simulated.
    #[error("problem.{problem}: {source}")]
    Simulation {
        /// Name of the problem.
        problem: String,
        /// Why.
        source: SimulationError,
    },
    /// Too few peaks to hold some out.
    #[error(
        "problem.{problem}: {peaks} peaks cannot be split: {missing}; lower predict.block_peaks or \
         predict.last_share, or give an envelope with more peaks"
    )]
    Split {
        /// Name of the problem.
        problem: String,
        /// Number of its peaks.
        peaks: usize,
        /// What the split needs.
        missing: &'static str,
    },
}
