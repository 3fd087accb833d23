//! The folder of a run.

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

/// Folder of the checkpoints; a finished run has none.
const CHECKPOINTS: &str = "checkpoints";

/// Where run folders go unless another place is named, from the current folder.
#[must_use]
pub fn default_root() -> PathBuf {
    PathBuf::from("reports/runs")
}

/// The folder of one run.
#[derive(Debug, Clone)]
pub struct RunFolder {
    path: PathBuf,
    disk: Disk,
    /// Held by whoever made or resumed the run, and by the copies of its folder.
    _lock: Option<Arc<Lock>>,
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
    /// Makes a new folder `<root>/<name>-<UTC time>-<short random>`, and locks it as long as this or a copy lives.
    ///
    /// Characters of `name` that a file name should not have become `-`.
    ///
    /// # Errors
    /// [`RunError::Io`] where the system refuses.
    pub fn create(root: &Path, name: &str) -> Result<Self, RunError> {
        Self::create_on(&Disk::default(), root, name)
    }

    /// As [`RunFolder::create`], on a given disk.
    ///
    /// # Errors
    /// As [`RunFolder::create`].
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

    /// Makes exactly this folder, or takes it where it is there and empty, and locks it as long as this or a copy
    /// lives.
    ///
    /// # Errors
    /// [`RunError::Occupied`] where it holds something; [`RunError::Locked`] where another program works in it;
    /// [`RunError::Io`] where the system refuses.
    pub fn create_at(path: &Path) -> Result<Self, RunError> {
        Self::create_at_on(&Disk::default(), path)
    }

    /// As [`RunFolder::create_at`], on a given disk.
    ///
    /// # Errors
    /// As [`RunFolder::create_at`].
    pub fn create_at_on(disk: &Disk, path: &Path) -> Result<Self, RunError> {
        disk.make_folders(path).map_err(RunError::io(path, "create"))?;
        Self::check_free(path)?;
        let folder = Self::locked(disk, path.to_owned())?;
        // Another program may have come and gone between the two lines above.
        if is_empty(path)? { Ok(folder) } else { Err(RunError::Occupied { path: path.to_owned() }) }
    }

    /// Takes the folder of a run that was begun, to go on with it, or makes it where there is none; locks it as long
    /// as this or a copy lives, and takes away what a killed program was about to write.
    ///
    /// # Errors
    /// [`RunError::Locked`] where another program works in it; [`RunError::Io`] where the system refuses.
    pub fn resume_on(disk: &Disk, path: &Path) -> Result<Self, RunError> {
        disk.make_folders(path).map_err(RunError::io(path, "create"))?;
        Self::locked(disk, path.to_owned())?.cleaned()
    }

    /// Takes away what a killed program was about to write; the folder is this process's own.
    fn cleaned(self) -> Result<Self, RunError> {
        for place in [self.path.clone(), self.path.join(CHECKPOINTS), self.path.join("model")] {
            remove_temporary(&self.disk, &place)?;
        }
        Ok(self)
    }

    /// Makes this folder, or takes it as it is, and locks it as long as this or a copy lives; `None` where another
    /// program works in it. Of several programs that share the cases of one folder, each takes those that it can
    /// claim; what a killed one had claimed is free, and what it was about to write is taken away.
    ///
    /// # Errors
    /// [`RunError::Io`] where the system refuses.
    pub fn claim(path: &Path) -> Result<Option<Self>, RunError> {
        let disk = Disk::default();
        disk.make_folders(path).map_err(RunError::io(path, "create"))?;
        let lock = Lock::claim(&disk, &path.join(LOCK))?;
        lock.map(|lock| Self { path: path.to_owned(), disk, _lock: Some(Arc::new(lock)) }.cleaned())
            .transpose()
    }

    /// As [`RunFolder::claim`], once whoever works in the folder lets go.
    ///
    /// # Errors
    /// [`RunError::Io`] where the system refuses.
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

    /// Whether [`RunFolder::create_at`] would take this folder, before there is anything to put in it.
    ///
    /// # Errors
    /// [`RunError::Occupied`] where it holds something; [`RunError::Locked`] where another program works in it;
    /// [`RunError::Io`] where it is no folder.
    pub fn check_free(path: &Path) -> Result<(), RunError> {
        if !path.exists() {
            return Ok(());
        }
        Lock::check(path)?;
        if is_empty(path)? { Ok(()) } else { Err(RunError::Occupied { path: path.to_owned() }) }
    }

    /// A folder that is there already, not locked.
    #[must_use]
    pub fn open(path: &Path) -> Self {
        Self { path: path.to_owned(), disk: Disk::default(), _lock: None }
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
        atomic::write(&self.disk, &self.place(name)?, content)
    }

    /// As [`RunFolder::write`], for one of very many files that a seed gives again: whole or absent after a crash
    /// of the program, but not flushed to the disk.
    ///
    /// # Errors
    /// As [`RunFolder::write`].
    pub fn write_reproducible(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        atomic::write_unflushed(&self.disk, &self.place(name)?, content)
    }

    /// The path of a file of the run, its subfolder made.
    fn place(&self, name: &str) -> Result<PathBuf, RunError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent() {
            self.disk.make_folders(folder).map_err(RunError::io(folder, "create"))?;
        }
        Ok(path)
    }

    /// Writes a value as a JSON file, indented, ending in a line break.
    ///
    /// # Errors
    /// As [`RunFolder::write`]; [`RunError::Encoding`] where the value has no JSON.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), RunError> {
        self.write(name, to_json(name, value)?.as_bytes())
    }

    /// Adds a line to `events.jsonl`: the time, the event's name, and what belongs to it.
    ///
    /// One write of one line, flushed to the disk; a crash can cut the last line short, never an earlier one.
    ///
    /// # Errors
    /// As [`RunFolder::write_json`]; [`RunError::Log`] where the lines before are not what was written.
    pub fn record_event(&self, event: &str, details: &impl Serialize) -> Result<(), RunError> {
        let details = serde_json::to_value(details)
            .map_err(|error| RunError::Encoding { name: EVENTS.to_owned(), problem: error.to_string() })?;
        let event = Event { time: Timestamp::now().to_string(), event: event.to_owned(), details };
        EventLog::append(&self.path.join(EVENTS), &self.disk, &event)
    }

    /// What happened so far; nothing where there is no log.
    ///
    /// # Errors
    /// [`RunError::Log`] where a line is not what was written; [`RunError::Io`] where it cannot be read.
    pub fn events(&self) -> Result<EventLog, RunError> {
        EventLog::read(&self.path.join(EVENTS))
    }

    /// Whether the folder holds no more than some of these files, and a lock.
    ///
    /// # Errors
    /// [`RunError::Io`] where it cannot be listed.
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

    /// Writes a checkpoint, as [`RunFolder::write`] any file, under its digest.
    ///
    /// # Errors
    /// As [`RunFolder::write`].
    pub fn write_checkpoint(&self, name: &str, bytes: &[u8]) -> Result<(), RunError> {
        sealed::write(&self.disk, &self.place(&format!("{CHECKPOINTS}/{name}"))?, bytes)
    }

    /// The checkpoint of a name; `None` where there is none.
    ///
    /// # Errors
    /// [`RunError::Damaged`] where it is not what was written; [`RunError::Io`] where it cannot be read.
    pub fn read_checkpoint(&self, name: &str) -> Result<Option<Vec<u8>>, RunError> {
        match sealed::read(&self.checkpoint_path(name)) {
            Err(RunError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => Ok(None),
            other => other.map(Some),
        }
    }

    /// Where the checkpoint of a name is kept.
    #[must_use]
    pub fn checkpoint_path(&self, name: &str) -> PathBuf {
        self.path.join(CHECKPOINTS).join(name)
    }

    /// Names of the checkpoints there are, sorted.
    ///
    /// # Errors
    /// [`RunError::Io`] where they cannot be listed.
    pub fn checkpoints(&self) -> Result<Vec<String>, RunError> {
        names(&self.path.join(CHECKPOINTS))
    }

    /// Takes a file of the run away that another one supersedes; one that is not there is no error.
    ///
    /// # Errors
    /// [`RunError::Io`] where the system refuses.
    pub fn remove(&self, name: &str) -> Result<(), RunError> {
        let path = self.path.join(name);
        if !path.exists() {
            return Ok(());
        }
        self.disk.remove_file(&path).map_err(RunError::io(&path, "take away"))
    }

    /// Takes all checkpoints away: the run is finished.
    ///
    /// # Errors
    /// [`RunError::Io`] where the system refuses.
    pub fn remove_checkpoints(&self) -> Result<(), RunError> {
        let path = self.path.join(CHECKPOINTS);
        if !path.exists() {
            return Ok(());
        }
        self.disk.remove_folder(&path).map_err(RunError::io(&path, "take away"))
    }

    /// When the run began and when it last recorded an event, in milliseconds since 1970, from `events.jsonl`.
    ///
    /// # Errors
    /// [`RunError::Io`] where there is no such file; [`RunError::Encoding`] where it tells no time.
    pub fn span_ms(&self) -> Result<(i64, i64), RunError> {
        let bytes = self.read(EVENTS)?;
        let time = |event: Event| Some(event.time.parse::<Timestamp>().ok()?.as_millisecond());
        let mut times = readable(&bytes).filter_map(time);
        // Of a log with one line its first is its last.
        let first = times.next();
        first.map(|first| (first, times.next_back().unwrap_or(first))).ok_or_else(|| RunError::Encoding {
            name: EVENTS.to_owned(),
            problem: "no line of it has a time".to_owned(),
        })
    }

    /// Reads what a report is made of. The tables may be absent: which of them a run has is its task's
    /// affair. A table of runs that no sweep made has neither a configuration nor an environment.
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
        let has = |name: &str| self.path.join(name).exists();
        let (config, result) = if has("rigs.json") {
            (String::new(), read("rigs.json")?)
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

/// Whether a folder holds nothing but perhaps a lock.
fn is_empty(path: &Path) -> Result<bool, RunError> {
    let mut entries = std::fs::read_dir(path).map_err(RunError::io(path, "list"))?;
    Ok(entries.all(|entry| entry.is_ok_and(|entry| entry.file_name() == LOCK)))
}

/// Takes away the temporary files of a folder in which no program is writing.
pub(crate) fn remove_temporary(disk: &Disk, folder: &Path) -> Result<(), RunError> {
    for name in names(folder)?.iter().filter(|name| name.starts_with(TEMPORARY)) {
        let path = folder.join(name);
        disk.remove_file(&path).map_err(RunError::io(&path, "take away"))?;
    }
    Ok(())
}

/// Names of what a folder holds, sorted; none where there is no such folder.
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

/// A value as the text of a JSON file, indented, ending in a line break; `name` is what messages call the file.
///
/// # Errors
/// [`RunError::Encoding`] where the value has no JSON.
pub fn to_json(name: &str, value: &impl Serialize) -> Result<String, RunError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| RunError::Encoding { name: name.to_owned(), problem: error.to_string() })?;
    Ok(text + "\n")
}
