//! Errors of trials.

use thiserror::Error;
use trials::TrialError;
use truth::SealError;

/// Reason why trials gave no score.
#[derive(Debug, Error)]
pub(crate) enum TrialsError {
    #[error(
        "{folder}: trials were started here; continue them with --resume, or name another folder with --out"
    )]
    Begun { folder: String },
    #[error(
        "{folder}: there are no trials in it: manifest.json is missing; name the folder that `trainer trials` made"
    )]
    NoTrials { folder: String },
    #[error(
        "{file}: these trials were started with another configuration: {difference}; resume with the configuration that they \
         were started with, or start new ones with another --out"
    )]
    Edited { file: String, difference: String },
    #[error(
        "{folder}: the truths are open, and {missing} answers are missing: no answer given now would be blind; move this \
         folder away (it is made again), then resume"
    )]
    Open { folder: String, missing: usize },
    #[error("{file}: case {id} made again has another digest, {found} instead of {stated}; {remedy}")]
    MadeOtherwise { file: String, id: String, stated: String, found: String, remedy: &'static str },
    #[error("{file}: cannot be read: {problem}")]
    Unreadable { file: String, problem: String },
    #[error("{file}: {source}")]
    Seal { file: String, source: SealError },
    #[error(
        "{file}: has the digest {found}, not {stated} as manifest.json says; it was changed after it was made"
    )]
    Changed { file: String, stated: String, found: String },
    #[error(
        "{file}: this answer is for other records (digests {found}, not {stated}); delete it and resume the trials"
    )]
    OtherRecords { file: String, stated: String, found: String },
    #[error("{file}: case {number}: {source}")]
    Case { file: String, number: usize, source: TrialError },
    #[error("the diagnosis of {group} could not be started or failed: {problem}")]
    Process { group: String, problem: String },
}
