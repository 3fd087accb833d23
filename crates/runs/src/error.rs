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
