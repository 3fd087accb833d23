//! What the tests share: the program, scratch folders, the measured records.

use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// The workspace's root.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Runs the program from the workspace's root.
pub(crate) fn trainer(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trainer")).args(arguments).current_dir(root()).output().unwrap()
}

/// Runs an experiment into a scratch folder and gives its result, whatever the exit code.
pub(crate) fn result(arguments: &[&str]) -> (i32, Value, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let mut all = arguments.to_vec();
    let out = folder.path().to_str().unwrap().to_owned();
    all.extend(["--json", "--out", &out]);
    let output = trainer(&all);
    let text = String::from_utf8(output.stdout).unwrap();
    let value = serde_json::from_str(&text)
        .unwrap_or_else(|error| panic!("{error}: {text} {}", String::from_utf8_lossy(&output.stderr)));
    (output.status.code().unwrap(), value, folder)
}

/// A measured record beside the project, or `None`, said loudly: the test harness hides what a passing
/// test prints, so this goes around it.
pub(crate) fn measured(name: &str) -> Option<String> {
    let relative = format!("../shared/data/{name}");
    if root().join(&relative).exists() {
        return Some(relative);
    }
    let line = format!("SKIPPED: the measured record {relative} is not there\n");
    std::io::stderr().write_all(line.as_bytes()).unwrap();
    None
}

/// A JSON number by path, such as `/envelope/peaks`.
pub(crate) fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {path}"))
}
