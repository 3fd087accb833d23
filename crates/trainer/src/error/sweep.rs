//! What a sweep can fail of as a whole; what a run fails of is its row.

use experiment::sweep::SweepError;
use record::RecordError;
use runs::SweepFolderError;
use thiserror::Error;

/// Why there is no sweep.
#[derive(Debug, Error)]
pub(crate) enum SweepCommandError {
    #[error(transparent)]
    Plan(#[from] SweepError),
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
        "{path}: the record has changed since the sweep was frozen, from {then} to {now}; restore it, or begin another \
         sweep: runs on different records do not belong in one table"
    )]
    OtherRecord { path: String, then: String, now: String },
}
