//! What a run would lose if it were killed: finished fits, and the state of those in progress.

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

/// Beginning and end of the names of the two kinds of checkpoints.
const FINISHED: &str = "finished-";
const STATE: &str = ".state";

/// The checkpoints of a run.
///
/// A finished fit is kept at once where it took longer than the interval between checkpoints; shorter ones are
/// gathered until together they did, so that a thousand fits of a millisecond do not wait for the disk a
/// thousand times.
pub(crate) struct Ledger {
    folder: RunFolder,
    /// Digest of what the run was begun with: a checkpoint of another run is refused.
    run: String,
    pub(crate) settings: CheckpointSettings,
    /// What was finished before this program went on, encoded, by name.
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

/// A file of finished fits.
#[derive(Serialize, Deserialize)]
struct Finished {
    run: String,
    entries: Vec<(String, Vec<u8>)>,
}

/// A fit in progress, as it is kept.
#[derive(Serialize, Deserialize)]
struct InProgress {
    run: String,
    name: String,
    resumed: Resumed,
}

/// What a fit goes on from.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Resumed {
    /// The estimator's own state.
    pub(crate) state: Vec<u8>,
    /// Every step before.
    pub(crate) trace: Vec<TraceRow>,
    /// Time spent before.
    pub(crate) seconds: f64,
}

impl Ledger {
    /// The ledger of a run that has been begun, with what it holds.
    ///
    /// Every checkpoint is read here, whether it is going to be needed or not: one that is damaged is refused before
    /// anything is computed.
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

    /// What was finished under a name before this program went on.
    pub(crate) fn finished<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, TrainerError> {
        let Some(bytes) = self.finished.get(name) else { return Ok(None) };
        Ok(Some(decode(bytes).map_err(|problem| self.damaged(FINISHED, problem))?))
    }

    /// Keeps what took some time to compute.
    pub(crate) fn keep<T: Serialize>(&self, name: &str, value: &T, seconds: f64) -> Result<(), TrainerError> {
        let bytes = encode(name, value)?;
        let mut pending = self.pending.lock().unwrap_or_else(PoisonError::into_inner);
        pending.entries.push((name.to_owned(), bytes));
        pending.seconds += seconds;
        if pending.seconds >= self.settings.interval_s { self.write(&mut pending) } else { Ok(()) }
    }

    /// Keeps at once what is still waiting for it.
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

    /// What a fit of a name goes on from, where its state was kept.
    pub(crate) fn resumed(&self, name: &str) -> Result<Option<Resumed>, TrainerError> {
        let file = state_file(name);
        let Some(kept) = self.read::<InProgress>(&file)? else { return Ok(None) };
        if kept.name == name && kept.run == self.run {
            Ok(Some(kept.resumed))
        } else {
            Err(self.foreign(&file))
        }
    }

    /// Keeps what a fit of a name would go on from.
    pub(crate) fn keep_state(&self, name: &str, resumed: Resumed) -> Result<(), TrainerError> {
        let kept = InProgress { run: self.run.clone(), name: name.to_owned(), resumed };
        Ok(self.folder.write_checkpoint(&state_file(name), &encode(name, &kept)?)?)
    }

    fn read<T: DeserializeOwned>(&self, file: &str) -> Result<Option<T>, TrainerError> {
        let Some(bytes) = self.folder.read_checkpoint(file)? else { return Ok(None) };
        Ok(Some(decode(&bytes).map_err(|problem| self.damaged(file, problem))?))
    }

    /// Whole bytes that mean nothing: written by another build of the program.
    fn damaged(&self, file: &str, problem: String) -> TrainerError {
        RunError::Damaged { path: self.folder.checkpoint_path(file), problem }.into()
    }

    fn foreign(&self, file: &str) -> TrainerError {
        let file = self.folder.checkpoint_path(file).display().to_string();
        ResumeError::ForeignCheckpoint { file }.into()
    }
}

/// The file of a fit's state: what of the name every system takes, and a digest, since names may differ in
/// the rest alone.
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
