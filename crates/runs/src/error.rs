//! Errors of writing and reading runs.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reason why a run could not be written or read.
#[derive(Debug, Error)]
pub enum RunError {
    /// The operating system refused an operation.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// Operation that failed.
        action: &'static str,
        /// Error reported by the system.
        source: std::io::Error,
    },
    /// The folder for the results is not empty.
    #[error(
        "{} is not empty; results are never written over: name another folder or empty this one",
        path.display()
    )]
    Occupied {
        /// Path of the folder.
        path: PathBuf,
    },
    /// Another program is working in the folder.
    #[error(
        "{}: {holder} is working in it; wait until it is done, stop it, or name another folder",
        path.display()
    )]
    Locked {
        /// Path of the folder.
        path: PathBuf,
        /// Process, machine and time, as far as known.
        holder: String,
    },
    /// A checkpoint differs from what was written.
    #[error(
        "{}: the checkpoint is damaged: {problem}; nothing of it is used. Remove the file and resume again: \
         its contents are computed again",
        path.display()
    )]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// Mismatch that was found.
        problem: String,
    },
    /// The log of events differs from what was written.
    #[error(
        "{}:{line}: the line has been changed since it was written: {problem}; restore the file, or \
         start again in another folder",
        path.display()
    )]
    Log {
        /// Path of the file.
        path: PathBuf,
        /// Line number, counted from 1.
        line: usize,
        /// Mismatch that was found.
        problem: String,
    },
    /// A table or result could not be encoded as text.
    #[error("{name}: {problem} (a fault of the program, please report it)")]
    Encoding {
        /// Name of the file.
        name: String,
        /// Error reported by the encoder.
        problem: String,
    },
}

impl RunError {
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, action, source }
    }
}
