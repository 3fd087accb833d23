//! Errors of the calls in this crate.

use envelope::EnvelopeError;
use estimator::FitError;
use learn::LearnError;
use oracle::OracleError;
use report::ReportError;
use runs::RunError;
use settings::SettingsError;
use simulator::GenerationError;
use thiserror::Error;
use workflow::WorkflowError;

/// Reason why a call gave no answer, with the message of the command line: the problem, its place and the
/// remedy.
///
/// Messages name options of the command line (`--unit deg`); the field of [`Reading`](crate::Reading) or
/// [`Arrays`](crate::Arrays) has the same name.
///
/// ```
/// use ringdown_lab::{Error, Reading, Record};
///
/// let error = Record::parse("log.csv", b"time_s,angle_rad\n0.0,0.1\n0.1,oops\n", &Reading::default()).unwrap_err();
/// assert!(matches!(error, Error::Record(_)));
/// assert!(error.to_string().starts_with("log.csv"));
/// ```
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A record that cannot be read, or that does not belong to the nominal system.
    #[error(transparent)]
    Record(WorkflowError),
    /// A nominal simulator or an option with a wrong value.
    #[error("{0}")]
    Config(String),
    /// A record that carries no information about the nominal system.
    #[error(transparent)]
    Diagnosis(WorkflowError),
    /// A record without an envelope.
    #[error("{record}: {source}")]
    Envelope {
        /// Name of the record.
        record: String,
        /// The fault found.
        source: EnvelopeError,
    },
    /// An envelope for which least squares has no solution.
    #[error("{record}: {source}")]
    LeastSquares {
        /// Name of the record.
        record: String,
        /// The fault found.
        source: OracleError,
    },
    /// A method that gives no estimate.
    #[error("{method}, seed {seed}: {source}")]
    Fit {
        /// Name of the method.
        method: String,
        /// Seed of the method's random draws.
        seed: u64,
        /// The fault found.
        source: FitError,
    },
    /// An estimate that is not a finite number.
    #[error("{method}, seed {seed}: the estimate is not finite; lower the estimator's start values or steps")]
    NotFinite {
        /// Name of the method.
        method: String,
        /// Seed of the method's random draws.
        seed: u64,
    },
    /// A system that cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] GenerationError),
    /// Records that nothing can be learned from.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// A page that cannot be made.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A file that cannot be written.
    #[error(transparent)]
    File(#[from] RunError),
}

impl From<WorkflowError> for Error {
    fn from(error: WorkflowError) -> Self {
        use WorkflowError as E;
        match error {
            E::Settings(_) | E::Nominal { .. } | E::NominalIsConfiguration { .. } | E::Robot(_) => {
                Self::Config(error.to_string())
            }
            E::Diagnosis { .. } => Self::Diagnosis(error),
            E::Record(_)
            | E::NoLogs { .. }
            | E::MissingInput { .. }
            | E::StandsStill { .. }
            | E::Exchanged { .. }
            | E::UnknownGain { .. }
            | E::OtherUnit { .. }
            | E::SameRecord { .. }
            | E::LooksLikeDegrees { .. }
            | E::Identify { .. } => Self::Record(error),
        }
    }
}

impl From<SettingsError> for Error {
    fn from(error: SettingsError) -> Self {
        Self::Config(error.to_string())
    }
}
