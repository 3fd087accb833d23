//! Errors of commands, and their exit codes.

mod kept;
mod kind;
mod launch;
mod learn;
mod new;
mod resume;
mod serve;
mod sweep;
mod table;
mod trials;

use estimator::FitError;
use oracle::OracleError;
use record::RecordError;
use report::ReportError;
use runs::RunError;
use settings::{Origin, SettingsError};
use simulator::GenerationError;
use studies::StudyError;
use thiserror::Error;
use tracking::TrackingError;
use workflow::WorkflowError;
use workflow::estimate::EstimateError;

pub(crate) use kept::KeptError;
pub(crate) use launch::LaunchError;
pub(crate) use learn::LearnCommandError;
pub(crate) use new::NewError;
pub(crate) use resume::ResumeError;
pub(crate) use serve::ServeError;
pub(crate) use sweep::SweepCommandError;
pub(crate) use table::TableError;
pub(crate) use trials::TrialsError;

/// Reason why a command gave no result.
#[derive(Debug, Error)]
pub(crate) enum TrainerError {
    /// Neither a configuration nor a command was named.
    #[error("name a configuration, for example configs/pinn.toml, or a command; --help shows both")]
    NoConfig,
    /// The configuration file could not be read.
    #[error("{file}: cannot be read: {problem}; expected a TOML file, for example configs/pinn.toml")]
    Config { file: String, problem: String },
    #[error(transparent)]
    Settings(SettingsError),
    #[error(
        "{origin}: this is a configuration for the task \"{task}\", which `trainer {file}` runs; `trainer {wanted}` needs one \
         for the task \"{wanted}\", for example {example}"
    )]
    OtherTask { origin: Origin, file: String, task: String, wanted: &'static str, example: &'static str },
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The record is missing, and the configuration states where it can be obtained.
    #[error(
        "{error}. It does not come with this project: get it from {source_of}, and name it with data.path=FILE"
    )]
    AbsentRecord { error: RecordError, source_of: String },
    /// The truth file belongs to another record than the one beside it.
    #[error(
        "{file} states the truth of a record {stated}, but {record} is {found}; remove it, or state the truth of this record"
    )]
    OtherTruth { file: String, record: String, stated: String, found: String },
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    #[error("{estimator}, seed {seed}: {source}")]
    Fit { estimator: &'static str, seed: u64, source: FitError },
    #[error("{method}, seed {seed}: {source}")]
    Classical { method: &'static str, seed: u64, source: OracleError },
    #[error(
        "{estimator}, seed {seed}: the estimate is not finite; lower the estimator's start values or steps"
    )]
    NotFinite { estimator: &'static str, seed: u64 },
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error(transparent)]
    Tracking(#[from] TrackingError),
    #[error("predict.methods and predict.problems leave nothing to fit")]
    NothingToFit,
    #[error("{file}: system {system}, record {record}: {source}")]
    Generation { file: String, system: usize, record: usize, source: GenerationError },
    #[error(
        "{record}: nothing to compare it with: name the nominal simulator with --nominal FILE; if there is \
         none, `trainer init {record}` makes a first guess of one and prints the command to continue with"
    )]
    NoNominal { record: String },
    #[error("{folder} is not empty; nothing that exists is overwritten: name another folder with --out")]
    InitOccupied { folder: String },
    #[error(transparent)]
    Workflow(#[from] WorkflowError),
    #[error(transparent)]
    Learn(#[from] LearnCommandError),
    #[error(transparent)]
    New(#[from] NewError),
    #[error(transparent)]
    Kept(#[from] KeptError),
    #[error("{folder}: cannot be listed: {problem}; expected a folder with a folder for each case")]
    Cases { folder: String, problem: String },
    #[error(
        "{folder}: there is no case in it; expected a folder for each, holding record-*.csv and nominal.toml"
    )]
    NoCases { folder: String },
    #[error("{file}: {problem}; expected lines such as joint = \"elbow\", robot = \"r7\", date = 2026-11-23")]
    Labels { file: String, problem: String },
    #[error("{folder}: {problem}; expected the folder of a rig, holding record-*.csv and nominal.toml")]
    NoRig { folder: String, problem: String },
    #[error(
        "--rigs {rig}: a single rig has nothing to be compared with; name several, or diagnose it with \
         `trainer diagnose RECORD --nominal FILE`"
    )]
    OneRig { rig: String },
    #[error("the seeds from {seed} on do not fit a 64-bit whole number; lower seed or fit.seeds")]
    TooManySeeds { seed: u64 },
    #[error(transparent)]
    Trials(#[from] TrialsError),
    #[error(transparent)]
    Resume(#[from] ResumeError),
    #[error(transparent)]
    Serve(#[from] ServeError),
    #[error(transparent)]
    Sweep(#[from] SweepCommandError),
    #[error(transparent)]
    Launch(#[from] LaunchError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Report(#[from] ReportError),
    #[error("{folder}: is not a finished run: {problem}; expected a run's folder, as below reports/runs")]
    NoRun { folder: String, problem: String },
    /// The result could not be written to standard output.
    #[error("the result cannot be written to standard output: {problem}")]
    Unprinted { problem: String },
    /// Threads or signal handlers could not be set up.
    #[error("cannot set up {what}: {problem}")]
    System { what: &'static str, problem: String },
}

impl From<runs::SweepFolderError> for TrainerError {
    fn from(error: runs::SweepFolderError) -> Self {
        Self::Sweep(SweepCommandError::Folder(error))
    }
}

impl TrainerError {
    /// Returns the exit code: 2 for wrong input or usage, 1 for a failure that is not the user's.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::NoConfig
            | Self::Config { .. }
            | Self::Settings(_)
            | Self::OtherTask { .. }
            | Self::Record(_)
            | Self::AbsentRecord { .. }
            | Self::OtherTruth { .. }
            | Self::Estimate(_)
            | Self::Classical { .. }
            | Self::Study(_)
            | Self::Tracking(_)
            | Self::NothingToFit
            | Self::Generation { .. }
            | Self::NoNominal { .. }
            | Self::InitOccupied { .. }
            | Self::Workflow(_)
            | Self::Kept(_)
            | Self::Learn(_)
            | Self::New(_)
            | Self::Cases { .. }
            | Self::NoCases { .. }
            | Self::Labels { .. }
            | Self::NoRig { .. }
            | Self::OneRig { .. }
            | Self::TooManySeeds { .. }
            | Self::Trials(_)
            | Self::Sweep(_)
            | Self::Launch(_)
            | Self::Table(_)
            | Self::Resume(_)
            | Self::Serve(_)
            | Self::NoRun { .. }
            | Self::Run(_)
            | Self::Report(_)
            | Self::Unprinted { .. } => 2,
            Self::Fit { source: FitError::Backend { .. }, .. } => 1,
            Self::Fit { .. } => 2,
            Self::NotFinite { .. } | Self::System { .. } => 1,
        }
    }
}
