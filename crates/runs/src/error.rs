//! Why a run could not be kept or read.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a run could not be kept or read.
#[derive(Debug, Error)]
pub enum RunError {
    /// The system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// The folder for the results holds something already.
    #[error(
        "{} is not empty; results are never written over: name another folder or empty this one",
        path.display()
    )]
    Occupied {
        /// The folder.
        path: PathBuf,
    },
    /// Another program works in the folder.
    #[error(
        "{}: {holder} is working in it; wait until it is done, stop it, or name another folder",
        path.display()
    )]
    Locked {
        /// The folder.
        path: PathBuf,
        /// Process, machine and time, where they are known.
        holder: String,
    },
    /// A checkpoint is not what was written.
    #[error(
        "{}: the checkpoint is damaged: {problem}; nothing of it is used. Take the file away and resume again: \
         what it held is computed anew",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What does not add up.
        problem: String,
    },
    /// The log of events is not what was written.
    #[error(
        "{}:{line}: the line has been changed since it was written: {problem}; restore the file, or \
         start again in another folder",
        path.display()
    )]
    Log {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What does not add up.
        problem: String,
    },
    /// A table or result could not be put into text.
    #[error("{name}: {problem} (a fault of the program, please report it)")]
    Encoding {
        /// The file.
        name: String,
        /// What the encoder says.
        problem: String,
    },
}

impl RunError {
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, action, source }
    }
}
