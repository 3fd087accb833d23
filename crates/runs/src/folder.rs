//! The folder of a run.

use crate::atomic;
use crate::error::RunError;
use jiff::Timestamp;
use serde::Serialize;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Where run folders go unless another place is named, from the current folder.
#[must_use]
pub fn default_root() -> PathBuf {
    PathBuf::from("reports/runs")
}

/// The folder of one run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFolder {
    path: PathBuf,
}

/// The texts of a finished run that a report is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texts {
    /// The folder's own name.
    pub name: String,
    /// `config.toml`; of a diagnosis `repaired.toml`.
    pub config: String,
    /// `result.json`; of a diagnosis `diagnosis.json`.
    pub result: String,
    /// `trace.csv`; empty where nothing was trained.
    pub trace: String,
    /// `envelope.csv`; empty where a run has more than one envelope.
    pub envelope: String,
    /// `predictions.csv`; empty where nothing was predicted.
    pub predictions: String,
    /// `series.csv`; empty but for a diagnosis.
    pub series: String,
    /// `environment.json`.
    pub environment: String,
}

impl RunFolder {
    /// Makes a new folder `<root>/<name>-<UTC time>-<short random>`.
    ///
    /// Characters of `name` that a file name should not have become `-`.
    ///
    /// # Errors
    /// [`RunError::Io`] where the system refuses.
    pub fn create(root: &Path, name: &str) -> Result<Self, RunError> {
        std::fs::create_dir_all(root).map_err(RunError::io(root, "create"))?;
        let safe = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String = name.chars().map(safe).take(60).collect();
        let time = Timestamp::now().strftime("%Y%m%dT%H%M%SZ");
        let folder = tempfile::Builder::new()
            .prefix(&format!("{name}-{time}-"))
            .rand_bytes(6)
            .tempdir_in(root)
            .map_err(RunError::io(root, "create a folder in"))?;
        let path = folder.keep();
        share(&path)?;
        atomic::sync_folder(root)?;
        Ok(Self { path })
    }

    /// Makes exactly this folder, or takes it where it is there and empty.
    ///
    /// # Errors
    /// [`RunError::Occupied`] where it holds something; [`RunError::Io`] where the system refuses.
    pub fn create_at(path: &Path) -> Result<Self, RunError> {
        std::fs::create_dir_all(path).map_err(RunError::io(path, "create"))?;
        let mut entries = std::fs::read_dir(path).map_err(RunError::io(path, "list"))?;
        if entries.next().is_some() {
            return Err(RunError::Occupied { path: path.to_owned() });
        }
        Ok(Self { path: path.to_owned() })
    }

    /// Whether [`RunFolder::create_at`] would take this folder, before there is anything to put in it.
    ///
    /// # Errors
    /// [`RunError::Occupied`] where it holds something; [`RunError::Io`] where it is no folder.
    pub fn check_free(path: &Path) -> Result<(), RunError> {
        if !path.exists() {
            return Ok(());
        }
        let mut entries = std::fs::read_dir(path).map_err(RunError::io(path, "list"))?;
        if entries.next().is_some() { Err(RunError::Occupied { path: path.to_owned() }) } else { Ok(()) }
    }

    /// A folder that is there already.
    #[must_use]
    pub fn open(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file of the run; `name` may lead into a subfolder, as `model/weights.safetensors`.
    ///
    /// # Errors
    /// [`RunError::Io`] with the file and what was tried.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        atomic::write(&self.place(name)?, content)
    }

    /// As [`RunFolder::write`], for one of very many files that a seed gives again: whole or absent after a crash
    /// of the program, but not flushed to the disk.
    ///
    /// # Errors
    /// As [`RunFolder::write`].
    pub fn write_reproducible(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        atomic::write_unflushed(&self.place(name)?, content)
    }

    /// The path of a file of the run, its subfolder made.
    fn place(&self, name: &str) -> Result<PathBuf, RunError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(RunError::io(folder, "create"))?;
        }
        Ok(path)
    }

    /// Writes a value as a JSON file, indented, ending in a line break.
    ///
    /// # Errors
    /// As [`RunFolder::write`]; [`RunError::Encoding`] where the value has no JSON.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), RunError> {
        let mut text = serde_json::to_string_pretty(value)
            .map_err(|error| RunError::Encoding { name: name.to_owned(), problem: error.to_string() })?;
        text.push('\n');
        self.write(name, text.as_bytes())
    }

    /// Adds a line to `events.jsonl`: the time, the event's name, and what belongs to it.
    ///
    /// One write of one line; a crash can cut the last line short, never an earlier one.
    ///
    /// # Errors
    /// As [`RunFolder::write_json`].
    pub fn record_event(&self, event: &str, details: &impl Serialize) -> Result<(), RunError> {
        #[derive(Serialize)]
        struct Line<'a, T> {
            time: String,
            event: &'a str,
            details: &'a T,
        }
        let name = "events.jsonl";
        let line = Line { time: Timestamp::now().to_string(), event, details };
        let mut text = serde_json::to_string(&line)
            .map_err(|error| RunError::Encoding { name: name.to_owned(), problem: error.to_string() })?;
        text.push('\n');
        let path = self.path.join(name);
        let mut file =
            OpenOptions::new().create(true).append(true).open(&path).map_err(RunError::io(&path, "open"))?;
        file.write_all(text.as_bytes()).map_err(RunError::io(&path, "write"))
    }

    /// When the run began and when it last recorded an event, in milliseconds since 1970, from `events.jsonl`.
    ///
    /// # Errors
    /// [`RunError::Io`] where there is no such file; [`RunError::Encoding`] where it tells no time.
    pub fn span_ms(&self) -> Result<(i64, i64), RunError> {
        #[derive(serde::Deserialize)]
        struct Line {
            time: String,
        }
        let name = "events.jsonl";
        let path = self.path.join(name);
        let text = std::fs::read_to_string(&path).map_err(RunError::io(&path, "read"))?;
        // A crash can have cut the last line short.
        let times = text.lines().filter_map(|line| serde_json::from_str::<Line>(line).ok());
        let times: Vec<i64> = times
            .filter_map(|line| line.time.parse::<Timestamp>().ok())
            .map(Timestamp::as_millisecond)
            .collect();
        times.first().copied().zip(times.last().copied()).ok_or_else(|| RunError::Encoding {
            name: name.to_owned(),
            problem: "no line of it has a time".to_owned(),
        })
    }

    /// Reads what a report is made of. The tables may be absent: which of them a run has is its task's
    /// affair.
    ///
    /// # Errors
    /// [`RunError::Io`] with the file that is missing.
    pub fn texts(&self) -> Result<Texts, RunError> {
        let read = |name: &str| {
            let path = self.path.join(name);
            std::fs::read_to_string(&path).map_err(RunError::io(&path, "read"))
        };
        let table = |name: &str| match read(name) {
            Err(RunError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => Ok(String::new()),
            other => other,
        };
        // `.` and `..` have a name only once resolved.
        let resolved = self.path.canonicalize().map_err(RunError::io(&self.path, "find"))?;
        let name = resolved.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let diagnosis = self.path.join("diagnosis.json").exists();
        let (config, result) = if diagnosis {
            (table("repaired.toml")?, read("diagnosis.json")?)
        } else {
            (read("config.toml")?, read("result.json")?)
        };
        Ok(Texts {
            name,
            config,
            result,
            trace: table("trace.csv")?,
            envelope: table("envelope.csv")?,
            predictions: table("predictions.csv")?,
            series: table("series.csv")?,
            environment: read("environment.json")?,
        })
    }
}

/// Temporary folders are made for their owner only; runs are for everybody.
#[cfg(unix)]
fn share(path: &Path) -> Result<(), RunError> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))
        .map_err(RunError::io(path, "set permissions of"))
}

#[cfg(not(unix))]
fn share(_path: &Path) -> Result<(), RunError> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::RunFolder;
    use crate::error::RunError;

    #[test]
    fn two_runs_never_share_a_folder() {
        let root = tempfile::tempdir().unwrap();
        let one = RunFolder::create(root.path(), "a/b c").unwrap();
        let other = RunFolder::create(root.path(), "a/b c").unwrap();
        assert_ne!(one, other);
        let name = one.path().file_name().unwrap().to_string_lossy().into_owned();
        assert!(name.starts_with("a-b-c-2"), "{name}");
    }

    #[test]
    fn a_folder_with_something_in_it_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let folder = RunFolder::create_at(&root.path().join("new")).unwrap();
        folder.write("model/x.bin", b"1").unwrap();
        let again = RunFolder::create_at(folder.path());
        assert!(matches!(again, Err(RunError::Occupied { .. })));
        assert!(matches!(RunFolder::check_free(folder.path()), Err(RunError::Occupied { .. })));
        assert!(RunFolder::check_free(&root.path().join("absent")).is_ok());
        assert_eq!(std::fs::read(folder.path().join("model/x.bin")).unwrap(), b"1");
    }

    #[test]
    fn a_file_in_the_way_is_an_error_with_its_name() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("file");
        std::fs::write(&file, "x").unwrap();
        let message = RunFolder::create_at(&file).unwrap_err().to_string();
        assert!(message.contains("file: cannot create"), "{message}");
    }

    #[test]
    fn a_run_spans_its_events_and_a_line_cut_short_is_none() {
        let root = tempfile::tempdir().unwrap();
        let line = |second: u8| format!("{{\"time\":\"2026-01-01T00:00:{second:02}.5Z\",\"event\":\"x\"}}\n");
        std::fs::write(root.path().join("events.jsonl"), line(1) + &line(3) + "{\"time\":").unwrap();
        let (began, ended) = RunFolder::open(root.path()).span_ms().unwrap();
        assert_eq!((began, ended - began), (1_767_225_601_500, 2000));
        std::fs::write(root.path().join("events.jsonl"), "").unwrap();
        assert!(matches!(RunFolder::open(root.path()).span_ms(), Err(RunError::Encoding { .. })));
    }

    #[test]
    fn events_are_lines() {
        let root = tempfile::tempdir().unwrap();
        let folder = RunFolder::create_at(root.path()).unwrap();
        folder.record_event("one", &1).unwrap();
        folder.record_event("two", &"a\nb").unwrap();
        let text = std::fs::read_to_string(root.path().join("events.jsonl")).unwrap();
        assert_eq!(text.lines().count(), 2);
    }
}
