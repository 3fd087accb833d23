//! Checkpoints of a run: finished fits, and the state of unfinished ones.

use crate::error::ResumeError;
use crate::error::TrainerError;
use crate::folders::resume::started;
use experiment::CheckpointSettings;
use results::TraceRow;
use runs::{RunError, RunFolder, digest};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Prefix and suffix of the names of the two kinds of checkpoints.
const FINISHED: &str = "finished-";
const STATE: &str = ".state";

/// Checkpoints of a run.
///
/// A finished fit is stored at once if it took longer than the interval between checkpoints. Shorter fits are
/// collected until together they took that long, so that a thousand fits of a millisecond do not wait for the
/// disk a thousand times.
pub(crate) struct Ledger {
    folder: RunFolder,
    /// Digest of the inputs with which the run was begun; a checkpoint of another run is refused.
    run: String,
    pub(crate) settings: CheckpointSettings,
    /// Values that earlier processes finished, encoded, by name.
    finished: BTreeMap<String, Vec<u8>>,
    pending: Mutex<Pending>,
}

#[derive(Default)]
struct Pending {
    entries: Vec<(String, Vec<u8>)>,
    seconds: f64,
    /// Number of the next file.
    next: u64,
}

/// File of finished fits.
#[derive(Serialize, Deserialize)]
struct Finished {
    run: String,
    entries: Vec<(String, Vec<u8>)>,
}

/// Stored state of an unfinished fit.
#[derive(Serialize, Deserialize)]
struct InProgress {
    run: String,
    name: String,
    resumed: Resumed,
}

/// State from which a fit is resumed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Resumed {
    /// State of the estimator.
    pub(crate) state: Vec<u8>,
    /// All steps before.
    pub(crate) trace: Vec<TraceRow>,
    /// Time spent before, in seconds.
    pub(crate) seconds: f64,
}

impl Ledger {
    /// Opens the ledger of a run that has been begun, with all its checkpoints.
    ///
    /// Every checkpoint is read here, whether or not it is needed later, so that a damaged one is refused
    /// before anything is computed.
    pub(crate) fn open(folder: &RunFolder, settings: CheckpointSettings) -> Result<Self, TrainerError> {
        let begun = serde_json::to_string(&started(folder)?).unwrap_or_default();
        let mut ledger = Self {
            folder: folder.clone(),
            run: digest(begun.as_bytes()),
            settings,
            finished: BTreeMap::new(),
            pending: Mutex::default(),
        };
        let mut next = 0;
        for file in folder.checkpoints()? {
            if let Some(number) = file.strip_prefix(FINISHED) {
                let kept: Option<Finished> = ledger.read(&file)?;
                let kept = kept.filter(|kept| kept.run == ledger.run).ok_or_else(|| ledger.foreign(&file))?;
                ledger.finished.extend(kept.entries);
                next = next.max(number.parse::<u64>().map_or(0, |number| number.saturating_add(1)));
            } else if file.ends_with(STATE) {
                let kept: Option<InProgress> = ledger.read(&file)?;
                kept.filter(|kept| kept.run == ledger.run).ok_or_else(|| ledger.foreign(&file))?;
            }
        }
        ledger.pending = Mutex::new(Pending { next, ..Pending::default() });
        Ok(ledger)
    }

    /// Returns the value that an earlier process finished under a name; `None` if there is none.
    pub(crate) fn finished<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, TrainerError> {
        let Some(bytes) = self.finished.get(name) else { return Ok(None) };
        Ok(Some(decode(bytes).map_err(|problem| self.damaged(FINISHED, problem))?))
    }

    /// Stores a computed value; `seconds` is the time that it took.
    pub(crate) fn keep<T: Serialize>(&self, name: &str, value: &T, seconds: f64) -> Result<(), TrainerError> {
        let bytes = encode(name, value)?;
        let mut pending = self.pending.lock().unwrap_or_else(PoisonError::into_inner);
        pending.entries.push((name.to_owned(), bytes));
        pending.seconds += seconds;
        if pending.seconds >= self.settings.interval_s { self.write(&mut pending) } else { Ok(()) }
    }

    /// Writes all values that are still waiting.
    pub(crate) fn flush(&self) -> Result<(), TrainerError> {
        self.write(&mut self.pending.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn write(&self, pending: &mut Pending) -> Result<(), TrainerError> {
        if pending.entries.is_empty() {
            return Ok(());
        }
        let file = format!("{FINISHED}{:06}", pending.next);
        let kept = Finished { run: self.run.clone(), entries: std::mem::take(&mut pending.entries) };
        self.folder.write_checkpoint(&file, &encode(&file, &kept)?)?;
        pending.next = pending.next.saturating_add(1);
        pending.seconds = 0.0;
        Ok(())
    }

    /// Returns the state from which the fit with a name can be resumed; `None` if no state was stored.
    pub(crate) fn resumed(&self, name: &str) -> Result<Option<Resumed>, TrainerError> {
        let file = state_file(name);
        let Some(kept) = self.read::<InProgress>(&file)? else { return Ok(None) };
        if kept.name == name && kept.run == self.run {
            Ok(Some(kept.resumed))
        } else {
            Err(self.foreign(&file))
        }
    }

    /// Stores the state from which the fit with a name can be resumed.
    pub(crate) fn keep_state(&self, name: &str, resumed: Resumed) -> Result<(), TrainerError> {
        let kept = InProgress { run: self.run.clone(), name: name.to_owned(), resumed };
        Ok(self.folder.write_checkpoint(&state_file(name), &encode(name, &kept)?)?)
    }

    fn read<T: DeserializeOwned>(&self, file: &str) -> Result<Option<T>, TrainerError> {
        let Some(bytes) = self.folder.read_checkpoint(file)? else { return Ok(None) };
        Ok(Some(decode(&bytes).map_err(|problem| self.damaged(file, problem))?))
    }

    /// Builds the error for intact bytes that cannot be decoded: another build of the program wrote them.
    fn damaged(&self, file: &str, problem: String) -> TrainerError {
        RunError::Damaged { path: self.folder.checkpoint_path(file), problem }.into()
    }

    fn foreign(&self, file: &str) -> TrainerError {
        let file = self.folder.checkpoint_path(file).display().to_string();
        ResumeError::ForeignCheckpoint { file }.into()
    }
}

/// Returns the file name of a fit's state: the characters of the name that every system accepts, and a
/// digest, since names may differ in other characters only.
fn state_file(name: &str) -> String {
    let shown = name.replace(|c: char| !c.is_ascii_alphanumeric(), "-");
    let whole = digest(name.as_bytes());
    let digest: String = whole.trim_start_matches("sha256:").chars().take(16).collect();
    format!("{shown}-{digest}{STATE}")
}

fn encode<T: Serialize>(name: &str, value: &T) -> Result<Vec<u8>, TrainerError> {
    let refused =
        |error: postcard::Error| RunError::Encoding { name: name.to_owned(), problem: error.to_string() };
    Ok(postcard::to_allocvec(value).map_err(refused)?)
}

fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    match postcard::take_from_bytes(bytes) {
        Ok((value, [])) => Ok(value),
        Ok((_, rest)) => Err(format!("{} bytes too many", rest.len())),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::state_file;

    #[test]
    fn names_that_differ_in_punctuation_have_files_of_their_own() {
        let names = ["a b/1", "a-b/1", "a b 1", "a-b-1"];
        let files: std::collections::BTreeSet<String> = names.into_iter().map(state_file).collect();
        assert_eq!(files.len(), names.len());
        for file in files {
            assert!(file.starts_with("a-b-1-") && file.ends_with(".state"), "{file}");
        }
    }
}
