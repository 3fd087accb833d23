//! Path of the running program, for the processes that it starts: trials and shares of a sweep.

use std::path::PathBuf;
use std::sync::OnceLock;

static STARTED_AS: OnceLock<PathBuf> = OnceLock::new();

/// Records the file to start: inside a Python interpreter, the process's own executable is the interpreter.
pub(crate) fn started_as(path: PathBuf) {
    // A second call in the same process would set the same path.
    let _ = STARTED_AS.set(path);
}

/// Returns the path of the program.
pub(crate) fn own_program() -> std::io::Result<PathBuf> {
    STARTED_AS.get().map_or_else(std::env::current_exe, |path| Ok(path.clone()))
}
