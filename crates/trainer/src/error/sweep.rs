//! Errors of a sweep as a whole; errors of single runs are recorded in their rows.

use experiment::sweep::SweepError;
use record::RecordError;
use runs::SweepFolderError;
use thiserror::Error;

/// Reason why a sweep cannot be made.
#[derive(Debug, Error)]
pub(crate) enum SweepCommandError {
    #[error(transparent)]
    Plan(SweepError),
    #[error("combination {number}{overrides}: {source}")]
    Record { number: usize, overrides: String, source: RecordError },
    #[error(transparent)]
    Folder(#[from] SweepFolderError),
    #[error(
        "{folder}: a sweep was started there already; --resume continues it, another --out starts a new one"
    )]
    Begun { folder: String },
    #[error("{folder}: there is no sweep to resume; name a configuration to start one")]
    NoSweep { folder: String },
    #[error(
        "{folder}: the sweep was frozen with other runs: {difference}; give the command that began it, leave the \
         configuration out to resume what is frozen, or start another sweep in another folder"
    )]
    Edited { folder: String, difference: String },
    #[error(
        "{file}: the frozen configuration is missing or was changed (its digest should be {digest}); restore it, or \
         give the configuration and the axes that the sweep began with"
    )]
    Lost { file: String, digest: String },
    #[error(
        "--search draws from ranges and choices, and there are none: give some, as 'lstm.learning_rate={{from=1e-4,to=1e-2,\
         scale=\"log\"}}' lstm.layers=1..3 estimator=pinn,lstm, or write them into the file"
    )]
    NoSpace,
    #[error(
        "--halving stops trials by the results of others, and a search with tpe proposes by results: take --search random \
         for halving, or tpe without it"
    )]
    HalvedTpe,
    #[error(
        "--halving pauses the training of one method, and task = \"compare\" fits many; search over one of them, \
         estimator=NAME"
    )]
    HalvedCompare,
    #[error(
        "--halving compares trainings that are not finished, which have no score on the test part ({measure}); take \
         --minimize validation.over_noise"
    )]
    HalvedTest { measure: String },
    #[error(
        "{what} chooses by the results of all trials, so it cannot be split into shares beforehand; leave \
         out --shard and --launcher and give --threads N, or take --search random without --halving, whose \
         points are known beforehand"
    )]
    Shares { what: &'static str },
    #[error(
        "{folder}: another process is working on this search; wait for it, or start another one in another folder"
    )]
    Searching { folder: String },
    #[error("result.json has no number at {measure}{nearest}; it has {known}")]
    NoMeasure { measure: String, nearest: String, known: String },
    #[error(
        "{path}: the record has changed since the sweep was frozen, from {then} to {now}; restore it, or begin another \
         sweep: runs on different records do not belong in one table"
    )]
    OtherRecord { path: String, then: String, now: String },
}
