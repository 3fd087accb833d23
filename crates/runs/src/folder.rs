//! Folder of a run.

use crate::atomic;
use crate::disk::Disk;
use crate::disk::TEMPORARY;
use crate::error::RunError;
use crate::events::{EVENTS, Event, EventLog, readable};
use crate::lock::{LOCK, Lock};
use crate::sealed;
use jiff::Timestamp;
use serde::Serialize;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Subfolder of the checkpoints; a finished run has none.
const CHECKPOINTS: &str = "checkpoints";

/// Returns the default folder for runs, relative to the current folder.
#[must_use]
pub fn default_root() -> PathBuf {
    PathBuf::from("reports/runs")
}

/// Folder of one run.
#[derive(Debug, Clone)]
pub struct RunFolder {
    path: PathBuf,
    disk: Disk,
    /// Lock held by the process that created or resumed the run; copies of this value share it.
    _lock: Option<Arc<Lock>>,
}

/// Texts of a finished run from which a report is made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texts {
    /// Name of the folder.
    pub name: String,
    /// `config.toml`; for a diagnosis `repaired.toml`.
    pub config: String,
    /// `result.json`; for a diagnosis `diagnosis.json`.
    pub result: String,
    /// `trace.csv`; empty if nothing was trained.
    pub trace: String,
    /// `envelope.csv`; empty if the run has more than one envelope.
    pub envelope: String,
    /// `predictions.csv`; empty if nothing was predicted.
    pub predictions: String,
    /// `series.csv`; empty except for a diagnosis.
    pub series: String,
    /// `environment.json`.
    pub environment: String,
}

impl RunFolder {
    /// Creates a new folder `<root>/<name>-<UTC time>-<short random>` and locks it until this value and its
    /// copies are dropped.
    ///
    /// Characters of `name` that are not allowed in file names are replaced by `-`.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn create(root: &Path, name: &str) -> Result<Self, RunError> {
        Self::create_on(&Disk::default(), root, name)
    }

    /// Creates a folder as [`RunFolder::create`] does, on the given disk.
    ///
    /// # Errors
    /// Same as [`RunFolder::create`].
    pub fn create_on(disk: &Disk, root: &Path, name: &str) -> Result<Self, RunError> {
        disk.make_folders(root).map_err(RunError::io(root, "create"))?;
        let safe = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String = name.chars().map(safe).take(60).collect();
        let time = Timestamp::now().strftime("%Y%m%dT%H%M%SZ");
        let path = disk
            .make_unique_folder(root, &format!("{name}-{time}-"))
            .map_err(RunError::io(root, "create a folder in"))?;
        disk.share(&path, 0o755).map_err(RunError::io(&path, "set permissions of"))?;
        disk.flush_folder(root).map_err(RunError::io(root, "flush"))?;
        Self::locked(disk, path)
    }

    /// Creates a folder at exactly this path, or takes an existing empty folder, and locks it until this
    /// value and its copies are dropped.
    ///
    /// # Errors
    /// [`RunError::Occupied`] if the folder is not empty; [`RunError::Locked`] if another program works in
    /// it; [`RunError::Io`] if the operating system refuses.
    pub fn create_at(path: &Path) -> Result<Self, RunError> {
        Self::create_at_on(&Disk::default(), path)
    }

    /// Creates a folder as [`RunFolder::create_at`] does, on the given disk.
    ///
    /// # Errors
    /// Same as [`RunFolder::create_at`].
    pub fn create_at_on(disk: &Disk, path: &Path) -> Result<Self, RunError> {
        disk.make_folders(path).map_err(RunError::io(path, "create"))?;
        Self::check_free(path)?;
        let folder = Self::locked(disk, path.to_owned())?;
        // Another program may have worked in the folder between the two lines above.
        if is_empty(path)? { Ok(folder) } else { Err(RunError::Occupied { path: path.to_owned() }) }
    }

    /// Opens the folder of an unfinished run to resume it, or creates the folder if there is none. Locks it
    /// until this value and its copies are dropped, and removes the temporary files of a killed program.
    ///
    /// # Errors
    /// [`RunError::Locked`] if another program works in the folder; [`RunError::Io`] if the operating system
    /// refuses.
    pub fn resume_on(disk: &Disk, path: &Path) -> Result<Self, RunError> {
        disk.make_folders(path).map_err(RunError::io(path, "create"))?;
        Self::locked(disk, path.to_owned())?.cleaned()
    }

    /// Removes the temporary files of a killed program. The caller must hold the folder's lock.
    fn cleaned(self) -> Result<Self, RunError> {
        for place in [self.path.clone(), self.path.join(CHECKPOINTS), self.path.join("model")] {
            remove_temporary(&self.disk, &place)?;
        }
        Ok(self)
    }

    /// Creates this folder, or takes it as it is, and locks it until this value and its copies are dropped;
    /// returns `None` if another program works in it. If several programs share the cases of one folder, each
    /// takes those that it can claim. The claim of a killed program is free again, and its temporary files
    /// are removed.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn claim(path: &Path) -> Result<Option<Self>, RunError> {
        let disk = Disk::default();
        disk.make_folders(path).map_err(RunError::io(path, "create"))?;
        let lock = Lock::claim(&disk, &path.join(LOCK))?;
        lock.map(|lock| Self { path: path.to_owned(), disk, _lock: Some(Arc::new(lock)) }.cleaned())
            .transpose()
    }

    /// Claims a folder as [`RunFolder::claim`] does, but waits until no other program works in it.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn wait(path: &Path) -> Result<Self, RunError> {
        let disk = Disk::default();
        disk.make_folders(path).map_err(RunError::io(path, "create"))?;
        let lock = Lock::wait(&disk, path)?;
        Ok(Self { path: path.to_owned(), disk, _lock: Some(Arc::new(lock)) })
    }

    pub(crate) fn locked(disk: &Disk, path: PathBuf) -> Result<Self, RunError> {
        let lock = Lock::take(disk, &path)?;
        Ok(Self { path, disk: disk.clone(), _lock: Some(Arc::new(lock)) })
    }

    /// Checks that [`RunFolder::create_at`] would accept this folder, before there is anything to write.
    ///
    /// # Errors
    /// [`RunError::Occupied`] if the folder is not empty; [`RunError::Locked`] if another program works in
    /// it; [`RunError::Io`] if it is not a folder.
    pub fn check_free(path: &Path) -> Result<(), RunError> {
        if !path.exists() {
            return Ok(());
        }
        Lock::check(path)?;
        if is_empty(path)? { Ok(()) } else { Err(RunError::Occupied { path: path.to_owned() }) }
    }

    /// Opens an existing folder without locking it.
    #[must_use]
    pub fn open(path: &Path) -> Self {
        Self { path: path.to_owned(), disk: Disk::default(), _lock: None }
    }

    /// Returns the path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file of the run; `name` may contain a subfolder, as in `model/weights.safetensors`.
    ///
    /// # Errors
    /// [`RunError::Io`] with the file and the operation that failed.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        atomic::write(&self.disk, &self.place(name)?, content)
    }

    /// Writes a file as [`RunFolder::write`] does, without flushing it to disk: after a crash of the program
    /// it is whole or absent. Meant for very many files that a seed can reproduce.
    ///
    /// # Errors
    /// Same as [`RunFolder::write`].
    pub fn write_reproducible(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        atomic::write_unflushed(&self.disk, &self.place(name)?, content)
    }

    /// Returns the path of a file of the run, and creates its subfolder.
    fn place(&self, name: &str) -> Result<PathBuf, RunError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent() {
            self.disk.make_folders(folder).map_err(RunError::io(folder, "create"))?;
        }
        Ok(path)
    }

    /// Writes a value as a JSON file, indented, with a line break at the end.
    ///
    /// # Errors
    /// Same as [`RunFolder::write`]; [`RunError::Encoding`] if the value has no JSON form.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), RunError> {
        self.write(name, to_json(name, value)?.as_bytes())
    }

    /// Appends an event to `events.jsonl`: the time, the event's name, and its data.
    ///
    /// The line is written at once and flushed to disk; a crash can cut the last line short, never an earlier
    /// one.
    ///
    /// # Errors
    /// Same as [`RunFolder::write_json`]; [`RunError::Log`] if the earlier lines differ from what was
    /// written.
    pub fn record_event(&self, event: &str, details: &impl Serialize) -> Result<(), RunError> {
        let details = serde_json::to_value(details)
            .map_err(|error| RunError::Encoding { name: EVENTS.to_owned(), problem: error.to_string() })?;
        let event = Event { time: Timestamp::now().to_string(), event: event.to_owned(), details };
        EventLog::append(&self.path.join(EVENTS), &self.disk, &event)
    }

    /// Reads the events so far; empty if there is no log.
    ///
    /// # Errors
    /// [`RunError::Log`] if a line differs from what was written; [`RunError::Io`] if the log cannot be read.
    pub fn events(&self) -> Result<EventLog, RunError> {
        EventLog::read(&self.path.join(EVENTS))
    }

    /// Returns `true` if the folder holds no file other than the expected ones and a lock.
    ///
    /// # Errors
    /// [`RunError::Io`] if the folder cannot be listed.
    pub fn holds_only(&self, expected: &[&str]) -> Result<bool, RunError> {
        Ok(names(&self.path)?.iter().all(|name| name == LOCK || expected.contains(&name.as_str())))
    }

    /// Reads a file of the run.
    ///
    /// # Errors
    /// [`RunError::Io`] with the file.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, RunError> {
        let path = self.path.join(name);
        std::fs::read(&path).map_err(RunError::io(&path, "read"))
    }

    /// Writes a checkpoint atomically, as [`RunFolder::write`] does, with its digest.
    ///
    /// # Errors
    /// Same as [`RunFolder::write`].
    pub fn write_checkpoint(&self, name: &str, bytes: &[u8]) -> Result<(), RunError> {
        sealed::write(&self.disk, &self.place(&format!("{CHECKPOINTS}/{name}"))?, bytes)
    }

    /// Reads the checkpoint with the given name; `None` if there is none.
    ///
    /// # Errors
    /// [`RunError::Damaged`] if the checkpoint differs from what was written; [`RunError::Io`] if it cannot
    /// be read.
    pub fn read_checkpoint(&self, name: &str) -> Result<Option<Vec<u8>>, RunError> {
        match sealed::read(&self.checkpoint_path(name)) {
            Err(RunError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => Ok(None),
            other => other.map(Some),
        }
    }

    /// Returns the path of the checkpoint with the given name.
    #[must_use]
    pub fn checkpoint_path(&self, name: &str) -> PathBuf {
        self.path.join(CHECKPOINTS).join(name)
    }

    /// Returns the names of the existing checkpoints, sorted.
    ///
    /// # Errors
    /// [`RunError::Io`] if they cannot be listed.
    pub fn checkpoints(&self) -> Result<Vec<String>, RunError> {
        names(&self.path.join(CHECKPOINTS))
    }

    /// Deletes a file of the run that another file supersedes; a missing file is not an error.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn remove(&self, name: &str) -> Result<(), RunError> {
        let path = self.path.join(name);
        if !path.exists() {
            return Ok(());
        }
        self.disk.remove_file(&path).map_err(RunError::io(&path, "take away"))
    }

    /// Deletes all checkpoints of a finished run.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn remove_checkpoints(&self) -> Result<(), RunError> {
        let path = self.path.join(CHECKPOINTS);
        if !path.exists() {
            return Ok(());
        }
        self.disk.remove_folder(&path).map_err(RunError::io(&path, "take away"))
    }

    /// Returns the times of the first and the last event in `events.jsonl`, in milliseconds since 1970.
    ///
    /// # Errors
    /// [`RunError::Io`] if there is no such file; [`RunError::Encoding`] if it contains no time.
    pub fn span_ms(&self) -> Result<(i64, i64), RunError> {
        let bytes = self.read(EVENTS)?;
        let time = |event: Event| Some(event.time.parse::<Timestamp>().ok()?.as_millisecond());
        let mut times = readable(&bytes).filter_map(time);
        // In a log with one line, the first event is also the last.
        let first = times.next();
        first.map(|first| (first, times.next_back().unwrap_or(first))).ok_or_else(|| RunError::Encoding {
            name: EVENTS.to_owned(),
            problem: "no line of it has a time".to_owned(),
        })
    }

    /// Reads the texts from which a report is made. Tables may be missing: which of them a run has depends on
    /// its task. A table of runs that no sweep made has neither a configuration nor an environment.
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
        // `.` and `..` have a name only after resolution.
        let resolved = self.path.canonicalize().map_err(RunError::io(&self.path, "find"))?;
        let name = resolved.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let has = |name: &str| self.path.join(name).exists();
        let of_several = ["joints.json", "rigs.json"].into_iter().find(|name| has(name));
        let (config, result) = if let Some(name) = of_several {
            (String::new(), read(name)?)
        } else if has("diagnosis.json") {
            (table("repaired.toml")?, read("diagnosis.json")?)
        } else if has("table.csv") {
            (table("config.toml")?, read("result.json")?)
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
            environment: if has("table.csv") {
                table("environment.json")?
            } else {
                read("environment.json")?
            },
        })
    }
}

/// Returns `true` if a folder holds nothing except perhaps a lock.
fn is_empty(path: &Path) -> Result<bool, RunError> {
    let mut entries = std::fs::read_dir(path).map_err(RunError::io(path, "list"))?;
    Ok(entries.all(|entry| entry.is_ok_and(|entry| entry.file_name() == LOCK)))
}

/// Deletes the temporary files of a folder in which no program is writing.
pub(crate) fn remove_temporary(disk: &Disk, folder: &Path) -> Result<(), RunError> {
    for name in names(folder)?.iter().filter(|name| name.starts_with(TEMPORARY)) {
        let path = folder.join(name);
        disk.remove_file(&path).map_err(RunError::io(&path, "take away"))?;
    }
    Ok(())
}

/// Returns the names of the entries of a folder, sorted; empty if there is no such folder.
fn names(path: &Path) -> Result<Vec<String>, RunError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let mut names = Vec::new();
    for entry in std::fs::read_dir(path).map_err(RunError::io(path, "list"))? {
        let entry = entry.map_err(RunError::io(path, "list"))?;
        names.push(entry.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests;

/// Encodes a value as the text of a JSON file, indented, with a line break at the end; `name` is the file's
/// name in messages.
///
/// # Errors
/// [`RunError::Encoding`] if the value has no JSON form.
pub fn to_json(name: &str, value: &impl Serialize) -> Result<String, RunError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| RunError::Encoding { name: name.to_owned(), problem: error.to_string() })?;
    Ok(text + "\n")
}
