//! The program that runs, for processes that it starts: trials and shares of a sweep.

use std::path::PathBuf;
use std::sync::OnceLock;

static STARTED_AS: OnceLock<PathBuf> = OnceLock::new();

/// Notes the file to start: inside an interpreter, the process's own file is the interpreter's.
pub(crate) fn started_as(path: PathBuf) {
    // A second call in a process would say the same.
    let _ = STARTED_AS.set(path);
}

/// Path of the program.
pub(crate) fn own_program() -> std::io::Result<PathBuf> {
    STARTED_AS.get().map_or_else(std::env::current_exe, |path| Ok(path.clone()))
}
