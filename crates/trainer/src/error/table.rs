//! Errors of comparing runs in a table.

use thiserror::Error;

/// Reason why there is no table.
#[derive(Debug, Error)]
pub(crate) enum TableError {
    #[error("{path}: there is no such folder; name run folders, sweep folders, or a quoted pattern")]
    Absent { path: String },
    #[error("{pattern}: nothing matches the pattern; `trainer list runs` shows what there is")]
    NoMatch { pattern: String },
    #[error("{pattern}: not a pattern: {problem}")]
    BadPattern { pattern: String, problem: String },
    #[error(
        "trainer list {what} takes no folder ({folder}); runs lie in folders: trainer list runs {folder}"
    )]
    NoFolder { what: &'static str, folder: String },
    #[error("--sort {key}: no such column; there are {known}")]
    NoColumn { key: String, known: String },
}
