//! Errors of answers that are already stored.

use thiserror::Error;

/// Reason why an existing answer is not the one that was asked for.
#[derive(Debug, Error)]
pub(crate) enum KeptError {
    #[error(
        "{folder}: was started with another {what}: {kept}, now {asked}; use the same one, or name another folder with \
         --out"
    )]
    AnotherQuestion { folder: String, what: String, kept: String, asked: String },
    #[error(
        "{record}: is not the record that was diagnosed: the answer in {answer} is on one with the digest {kept}, this one \
         has {found}. Answers are never written over: name another folder with --out"
    )]
    AnotherRecord { record: String, answer: String, kept: String, found: String },
    #[error(
        "{nominal}: is not the simulator that was diagnosed: the answer in {answer} is for one with the digest {kept}, this \
         one has {found}. Answers are never written over: name another folder with --out"
    )]
    AnotherNominal { nominal: String, answer: String, kept: String, found: String },
    #[error("{answer}: is not a diagnosis: {problem}; remove it, or name another folder with --out")]
    NoDiagnosis { answer: String, problem: String },
}
