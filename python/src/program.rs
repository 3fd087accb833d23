//! The command `ringdown`.

use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Runs the command line, the program's name first, in this process, and returns its exit code.
#[pyfunction]
pub(crate) fn program(py: Python<'_>, line: Vec<OsString>, started_as: Option<PathBuf>) -> u8 {
    py.detach(|| trainer::main_from(line, started_as))
}
