//! Shared parts of the tests: the program, scratch folders, the measured records.

use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Returns the root of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Runs the program from the root of the workspace.
pub(crate) fn trainer(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trainer")).args(arguments).current_dir(root()).output().unwrap()
}

/// Nominal simulator of an oscillator of 3.5 Hz, per unit of inertia.
pub(crate) const NOMINAL: &str = "inertia = 1.0\ndamping = 0.3\nstiffness = 484.0\nrest_angle = 0.0\n";

/// Simulates [`NOMINAL`] with the additional text of a configuration, into `made` below a folder. Returns a
/// function that gives the path of a file of the records.
pub(crate) fn simulated(folder: &Path, more: &str, overrides: &[&str]) -> impl Fn(&str) -> String + use<> {
    let (config, made) = (folder.join("simulated.toml"), folder.join("made"));
    std::fs::write(&config, format!("{NOMINAL}{more}")).unwrap();
    let mut arguments = vec!["simulate", config.to_str().unwrap()];
    arguments.extend(overrides);
    arguments.extend(["--quiet", "--out", made.to_str().unwrap()]);
    let output = trainer(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    move |name| made.join("records").join(name).to_str().unwrap().to_owned()
}

/// Runs an experiment into a scratch folder and returns exit code, result and folder, for any exit code.
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

/// Diagnosis of the shipped record by the program with its defaults, made once for all tests that read it.
pub(crate) struct Shipped {
    /// Text on standard output.
    pub(crate) said: String,
    files: Vec<(PathBuf, Vec<u8>)>,
}

impl Shipped {
    /// Name of its folder, which is the title of its page.
    const NAME: &str = "shipped";

    /// Returns the diagnosis.
    pub(crate) fn get() -> &'static Self {
        static MADE: LazyLock<Shipped> = LazyLock::new(|| {
            let shipped = root().join("experiments/default-record");
            let [record, nominal] =
                ["record.csv", "nominal.toml"].map(|name| shipped.join(name).display().to_string());
            let scratch = tempfile::tempdir().unwrap();
            let folder = scratch.path().join(Shipped::NAME);
            let out = folder.to_str().unwrap();
            let output = trainer(&["diagnose", &record, "--nominal", &nominal, "--out", out]);
            assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
            let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
            let files =
                files.map(|file| (file.file_name().into(), std::fs::read(file.path()).unwrap())).collect();
            Shipped { said: String::from_utf8(output.stdout).unwrap(), files }
        });
        &MADE
    }

    /// Returns the content of `diagnosis.json`.
    pub(crate) fn answer(&self) -> Value {
        let file = self.files.iter().find(|(name, _)| name == Path::new("diagnosis.json")).unwrap();
        serde_json::from_slice(&file.1).unwrap()
    }

    /// Copies the folder of the answer below another one, and returns its path there.
    pub(crate) fn copy_below(&self, above: &Path) -> PathBuf {
        let folder = above.join(Self::NAME);
        std::fs::create_dir_all(&folder).unwrap();
        for (name, bytes) in &self.files {
            std::fs::write(folder.join(name), bytes).unwrap();
        }
        folder
    }
}

/// Returns the path of a measured record beside the project. `None`, with a notice, if it is absent. The
/// notice bypasses the test harness, which hides the output of passing tests.
pub(crate) fn measured(name: &str) -> Option<String> {
    let relative = format!("../shared/data/{name}");
    if root().join(&relative).exists() {
        return Some(relative);
    }
    skipped(&format!("the measured record {relative} is not there"));
    None
}

/// Says that a test does nothing, past the test harness.
pub(crate) fn skipped(reason: &str) {
    std::io::stderr().write_all(format!("SKIPPED: {reason}\n").as_bytes()).unwrap();
}

/// Returns a JSON number by path, such as `/envelope/peaks`.
pub(crate) fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {path}"))
}

/// Files that depend on the time or the machine.
const OF_THE_MOMENT: &[&str] =
    &[".lock", "config.toml", "environment.json", "events.jsonl", "report.html", "tables.md", "table.tex"];

/// Returns every file of a run as text or digest, except those that depend on the time or the machine;
/// durations are removed from the others.
pub(crate) fn timeless_files(folder: &Path) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(place) = folders.pop() {
        for entry in std::fs::read_dir(place).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            if OF_THE_MOMENT.contains(&name.as_str()) {
                continue;
            }
            if name.ends_with(".json") {
                let mut value: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
                forget_durations(&mut value);
                found.insert(name, value.to_string());
            } else {
                found.insert(name, runs::digest(&std::fs::read(&path).unwrap()));
            }
        }
    }
    found
}

fn forget_durations(value: &mut Value) {
    match value {
        Value::Object(entries) => {
            entries.remove("seconds");
            entries.values_mut().for_each(forget_durations);
        }
        Value::Array(entries) => entries.iter_mut().for_each(forget_durations),
        _ => {}
    }
}
