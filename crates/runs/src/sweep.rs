//! Folder of a sweep.
//!
//! | file | holds |
//! |---|---|
//! | `sweep.json` | the frozen list of runs ([`SweepManifest`]), with their states when it was written |
//! | `configs/NNNN.toml` | each run's resolved configuration |
//! | `config.toml`, `environment.json` | the configuration all runs start from; the environment of freezing |
//! | `state/<digest>.json` | one file for each run that has ended ([`SweepEnd`]) |
//! | `state/<digest>.lock` | the process that makes the run; only the system's lock on the file counts |
//! | `state/.lock` | shared by the processes that work on the sweep |
//! | `runs/NNNN-…/` | ordinary run folders |
//!
//! Every file is whole or absent, and `sweep.json` is written last when a sweep is frozen, so a crash leaves
//! either a sweep that was not begun or one that can be resumed. A killed run is resumed in its folder; a
//! failed run is made again in a new folder. Several processes may work on one sweep: each makes the runs
//! that it can claim ([`SweepFolder::claim`]), and only the files in `state/` say which runs are done.

use crate::atomic;
use crate::disk::Disk;
use crate::error::RunError;
use crate::folder::{RunFolder, remove_temporary};
use crate::lock::{LOCK, Lock};
use results::{SWEEP_SCHEMA, SweepEnd, SweepLine, SweepManifest, SweepState};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Name of the manifest.
const MANIFEST: &str = "sweep.json";
/// Folder of the runs' configurations; its lock is held while the sweep is frozen.
const CONFIGS: &str = "configs";
const STATE: &str = "state";
const RUNS: &str = "runs";
/// Maximum number of folders in which one run is attempted.
const MOST_ATTEMPTS: u32 = 10_000;

/// Reason why a sweep's folder cannot be used.
#[derive(Debug, Error)]
pub enum SweepFolderError {
    /// The operating system refused, or the folder is in use for something else.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The file is not a sweep manifest.
    #[error(
        "{}: cannot be read as a sweep's manifest: {problem}; restore it, or begin the sweep in another folder",
        path.display()
    )]
    Unreadable {
        /// Path of the manifest.
        path: PathBuf,
        /// Fault that was found in it.
        problem: String,
    },
}

/// Claim of this process on a run, or its membership in the processes that work on a sweep. It ends when this
/// value is dropped or the process ends, however it ends.
#[derive(Debug)]
pub struct Claim {
    _lock: Lock,
}

/// Folder of a sweep.
#[derive(Debug, Clone)]
pub struct SweepFolder {
    folder: RunFolder,
}

impl SweepFolder {
    /// Opens an existing folder.
    #[must_use]
    pub fn open(path: &Path) -> Self {
        Self { folder: RunFolder::open(path) }
    }

    /// Returns `true` if a folder holds a frozen sweep.
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        path.join(MANIFEST).is_file()
    }

    /// Returns the folder for the files of the sweep as a whole.
    #[must_use]
    pub fn folder(&self) -> &RunFolder {
        &self.folder
    }

    /// Returns the path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Reads the frozen list, with the state of each run from `state/`; `None` if nothing has been frozen
    /// yet.
    ///
    /// # Errors
    /// [`SweepFolderError::Unreadable`] if the file is not a manifest; [`RunError::Io`] if the operating
    /// system refuses.
    pub fn manifest(&self) -> Result<Option<SweepManifest>, SweepFolderError> {
        let path = self.path().join(MANIFEST);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(RunError::io(&path, "read")(error).into()),
        };
        let unreadable = |problem: String| SweepFolderError::Unreadable { path: path.clone(), problem };
        let mut manifest: SweepManifest =
            serde_json::from_str(&text).map_err(|error| unreadable(error.to_string()))?;
        if manifest.schema != SWEEP_SCHEMA {
            return Err(unreadable(format!("its schema is {}, not {SWEEP_SCHEMA}", manifest.schema)));
        }
        self.note(&mut manifest)?;
        Ok(Some(manifest))
    }

    /// Freezes the list of runs. `configs` holds the texts of the runs' configurations, in the list's order,
    /// and `beside` the files of the sweep as a whole by name. The manifest is written last: if it exists, so
    /// do all the others.
    ///
    /// Waits for another process that is freezing the sweep. Returns `false`, and writes nothing, if another
    /// process has frozen one.
    ///
    /// # Errors
    /// [`RunError`] if something cannot be written.
    pub fn freeze(
        &self,
        manifest: &SweepManifest,
        configs: &[String],
        beside: &[(&str, Vec<u8>)],
    ) -> Result<bool, RunError> {
        let place = self.path().join(CONFIGS);
        Disk::default().make_folders(&place).map_err(RunError::io(&place, "create"))?;
        let _freezing = Lock::wait(&Disk::default(), &place)?;
        if Self::is_one(self.path()) {
            return Ok(false);
        }
        for (line, config) in manifest.runs.iter().zip(configs) {
            // Flushing ten thousand files takes minutes; the digests in the manifest reveal a lost one.
            self.folder.write_reproducible(&line.config, config.as_bytes())?;
        }
        for (name, content) in beside {
            self.folder.write(name, content)?;
        }
        let path = self.path().join(MANIFEST);
        atomic::write_new(&Disk::default(), &path, &text_of(manifest)?)
    }

    /// Adds runs to a frozen list. Their configurations are written first: if the manifest names a run, its
    /// configuration exists.
    ///
    /// The caller must hold the list ([`claim`](Self::claim) under a name of its own), so that no other
    /// process extends it at the same time.
    ///
    /// # Errors
    /// [`RunError`] if something cannot be written.
    pub fn extend(
        &self,
        manifest: &mut SweepManifest,
        lines: Vec<SweepLine>,
        configs: &[String],
    ) -> Result<(), RunError> {
        for (line, config) in lines.iter().zip(configs) {
            self.folder.write_reproducible(&line.config, config.as_bytes())?;
        }
        manifest.runs.extend(lines);
        self.refresh(manifest)
    }

    /// Registers this process as working on the sweep until the returned claim is dropped or the process
    /// ends, however it ends. If no other process works on it, the temporary files of killed processes are
    /// removed.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn enter(&self) -> Result<Claim, RunError> {
        let disk = Disk::default();
        let (configs, state) = (self.path().join(CONFIGS), self.path().join(STATE));
        disk.make_folders(&state).map_err(RunError::io(&state, "create"))?;
        let clean =
            || [self.path(), &configs, &state].iter().try_for_each(|place| remove_temporary(&disk, place));
        Ok(Claim { _lock: Lock::share(&disk, &state.join(LOCK), clean)? })
    }

    /// Claims a run for this process; `None` if another process has claimed it.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn claim(&self, digest: &str) -> Result<Option<Claim>, RunError> {
        let place = self.path().join(STATE);
        Disk::default().make_folders(&place).map_err(RunError::io(&place, "create"))?;
        let path = place.join(format!("{}.lock", plain(digest)));
        Ok(Lock::claim(&Disk::default(), &path)?.map(|lock| Claim { _lock: lock }))
    }

    /// Returns the end of a run; `None` if it has not ended or its file cannot be read.
    #[must_use]
    pub fn end_of(&self, digest: &str) -> Option<SweepEnd> {
        let bytes = std::fs::read(self.path().join(STATE).join(state_name(digest))).ok()?;
        serde_json::from_slice(&bytes).ok().filter(|end: &SweepEnd| end.digest == digest)
    }

    /// Creates a new folder for a run, locked until it is dropped: `runs/<label>`, with a number appended if
    /// that run was begun before. Returns its path relative to the sweep's folder, and the folder.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn begin_run(&self, label: &str) -> Result<(String, RunFolder), RunError> {
        let root = self.path().join(RUNS);
        std::fs::create_dir_all(&root).map_err(RunError::io(&root, "create"))?;
        for attempt in 1..MOST_ATTEMPTS {
            let name = attempt_name(label, attempt);
            let path = root.join(&name);
            match std::fs::create_dir(&path) {
                Ok(()) => {
                    let flushed = Disk::default().flush_folder(&root);
                    flushed.map_err(RunError::io(&root, "flush"))?;
                    return Ok((format!("{RUNS}/{name}"), RunFolder::locked(&Disk::default(), path)?));
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => (),
                Err(error) => return Err(RunError::io(&path, "create")(error)),
            }
        }
        Err(RunError::Occupied { path: root.join(label) })
    }

    /// Returns the folder in which a run with this label was last begun, relative to the sweep's folder;
    /// `None` if it was never begun.
    #[must_use]
    pub fn last_begun(&self, label: &str) -> Option<String> {
        let names = (1..MOST_ATTEMPTS).map(|attempt| format!("{RUNS}/{}", attempt_name(label, attempt)));
        names.take_while(|name| self.path().join(name).is_dir()).last()
    }

    /// Records the end of a run in one small file, written atomically.
    ///
    /// # Errors
    /// [`RunError`] if the file cannot be written.
    pub fn end_run(&self, end: &SweepEnd) -> Result<(), RunError> {
        self.folder.write_json(&format!("{STATE}/{}", state_name(&end.digest)), end)
    }

    /// Writes `sweep.json` again with the states from `state/`, until no state has changed during the write:
    /// the last of several processes leaves it complete.
    ///
    /// # Errors
    /// [`RunError`] if something cannot be read or written.
    pub fn refresh(&self, manifest: &mut SweepManifest) -> Result<(), RunError> {
        loop {
            self.note(manifest)?;
            self.folder.write(MANIFEST, &text_of(manifest)?)?;
            let written = manifest.clone();
            self.note(manifest)?;
            if *manifest == written {
                return Ok(());
            }
        }
    }

    /// Updates the states of a manifest. A state file that cannot be read counts as missing: its run is made
    /// again.
    fn note(&self, manifest: &mut SweepManifest) -> Result<(), RunError> {
        let mut ends = self.ends()?;
        for line in &mut manifest.runs {
            let end = ends.remove(&line.digest);
            line.state = end.as_ref().map_or(SweepState::Pending, |end| end.state);
            (line.run, line.message) = end.map_or((None, None), |end| (end.run, end.message));
        }
        Ok(())
    }

    fn ends(&self) -> Result<BTreeMap<String, SweepEnd>, RunError> {
        let folder = self.path().join(STATE);
        let entries = match std::fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(BTreeMap::new()),
            Err(error) => return Err(RunError::io(&folder, "list")(error)),
        };
        let read = |entry: std::io::Result<std::fs::DirEntry>| -> Option<SweepEnd> {
            let path = entry.ok()?.path();
            let end: SweepEnd = serde_json::from_slice(&std::fs::read(&path).ok()?).ok()?;
            (path.file_name()?.to_str()? == state_name(&end.digest)).then_some(end)
        };
        Ok(entries.filter_map(read).map(|end| (end.digest.clone(), end)).collect())
    }
}

/// Returns the folder name of an attempt at a run.
fn attempt_name(label: &str, attempt: u32) -> String {
    if attempt == 1 { label.to_owned() } else { format!("{label}-{attempt}") }
}

fn state_name(digest: &str) -> String {
    format!("{}.json", plain(digest))
}

/// Returns a digest without its prefix `sha256:`.
fn plain(digest: &str) -> &str {
    digest.strip_prefix("sha256:").unwrap_or(digest)
}

fn text_of(manifest: &SweepManifest) -> Result<Vec<u8>, RunError> {
    let mut text = serde_json::to_vec_pretty(manifest)
        .map_err(|error| RunError::Encoding { name: MANIFEST.to_owned(), problem: error.to_string() })?;
    text.push(b'\n');
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::{SweepFolder, SweepFolderError};
    use crate::disk::Disk;
    use crate::error::RunError;
    use crate::folder::RunFolder;
    use results::{SWEEP_SCHEMA, SweepEnd, SweepLine, SweepManifest, SweepState};
    use std::path::Path;

    fn manifest(runs: usize) -> SweepManifest {
        let line = |number: usize| SweepLine {
            number,
            digest: format!("sha256:{number:064}"),
            overrides: vec![format!("seed={number}")],
            config: format!("configs/{number:04}.toml"),
            state: SweepState::Pending,
            run: None,
            message: None,
        };
        SweepManifest {
            schema: SWEEP_SCHEMA.into(),
            name: "a".into(),
            config: "a.toml".into(),
            version: "0".into(),
            axes: vec![],
            records: vec![],
            search: None,
            runs: (1..=runs).map(line).collect(),
        }
    }

    fn frozen(path: &Path, runs: usize) -> SweepFolder {
        let sweep = SweepFolder::open(path);
        assert!(!SweepFolder::is_one(path) && sweep.manifest().unwrap().is_none());
        let texts: Vec<String> = (1..=runs).map(|number| format!("seed = {number}\n")).collect();
        assert!(sweep.freeze(&manifest(runs), &texts, &[]).unwrap());
        sweep
    }

    fn done(number: usize, run: &str) -> SweepEnd {
        SweepEnd {
            digest: format!("sha256:{number:064}"),
            state: SweepState::Done,
            run: Some(run.into()),
            message: None,
        }
    }

    #[test]
    fn a_list_is_frozen_once() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 2);
        assert_eq!(sweep.manifest().unwrap().unwrap(), manifest(2));
        let others = vec!["seed = 7\n".to_owned(); 3];
        assert!(!sweep.freeze(&manifest(3), &others, &[("config.toml", b"x".to_vec())]).unwrap());
        assert_eq!(sweep.manifest().unwrap().unwrap().runs.len(), 2);
        let config = std::fs::read_to_string(root.path().join("configs/0002.toml")).unwrap();
        assert_eq!(config, "seed = 2\n");
        assert!(!root.path().join("configs/0003.toml").exists() && !root.path().join("config.toml").exists());
    }

    /// The files that belong to the manifest are all those of the process that wrote the manifest.
    #[test]
    fn of_several_that_freeze_at_once_one_does_and_nothing_is_of_another() {
        for _ in 0..10 {
            let root = tempfile::tempdir().unwrap();
            let sweep = SweepFolder::open(root.path());
            let together = std::sync::Barrier::new(4);
            let freeze = &|share: usize| {
                let manifest = SweepManifest { name: share.to_string(), ..manifest(20) };
                let texts = vec![share.to_string(); 20];
                together.wait();
                sweep.freeze(&manifest, &texts, &[("config.toml", share.to_string().into_bytes())]).unwrap()
            };
            let won = std::thread::scope(|scope| {
                let shares = [0, 1, 2, 3].map(|share| scope.spawn(move || freeze(share)));
                shares.map(|share| share.join().unwrap())
            });
            assert_eq!(won.iter().filter(|won| **won).count(), 1);
            let manifest = sweep.manifest().unwrap().unwrap();
            assert!(won[manifest.name.parse::<usize>().unwrap()]);
            let names = manifest.runs.iter().map(|line| line.config.as_str()).chain(["config.toml"]);
            for name in names {
                let text = std::fs::read_to_string(root.path().join(name)).unwrap();
                assert_eq!(text, manifest.name, "{name}");
            }
        }
    }

    #[test]
    fn what_became_of_a_run_is_read_from_its_own_file() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 3);
        sweep.end_run(&done(2, "runs/x")).unwrap();
        // The manifest has not been written since, so the state is read from `state/`.
        let mut read = sweep.manifest().unwrap().unwrap();
        let states = |manifest: &SweepManifest| -> Vec<&str> {
            manifest.runs.iter().map(|line| line.state.name()).collect()
        };
        assert_eq!(states(&read), ["pending", "done", "pending"]);
        assert_eq!(read.runs[1].run.as_deref(), Some("runs/x"));
        // Another process finishes a run; the next refresh by any process sees it.
        sweep.end_run(&done(3, "runs/y")).unwrap();
        sweep.refresh(&mut read).unwrap();
        let text = std::fs::read_to_string(root.path().join("sweep.json")).unwrap();
        assert_eq!(states(&serde_json::from_str(&text).unwrap()), ["pending", "done", "done"]);
    }

    #[test]
    fn a_state_file_that_is_none_leaves_its_run_to_be_made_again() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 1);
        for text in [
            "",
            "{\"digest\": \"sha256:",
            "{\"digest\":\"sha256:1\",\"state\":\"done\",\"run\":null,\"message\":null}",
        ] {
            std::fs::create_dir_all(root.path().join("state")).unwrap();
            std::fs::write(root.path().join(format!("state/{:064}.json", 1)), text).unwrap();
            assert_eq!(sweep.manifest().unwrap().unwrap().runs[0].state, SweepState::Pending);
        }
    }

    #[test]
    fn a_run_begun_again_gets_another_folder() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 1);
        assert_eq!(sweep.last_begun("0001-seed-1"), None);
        let expected = ["runs/0001-seed-1", "runs/0001-seed-1-2", "runs/0001-seed-1-3"];
        for name in expected {
            assert_eq!(sweep.begin_run("0001-seed-1").unwrap().0, name);
            assert_eq!(sweep.last_begun("0001-seed-1").as_deref(), Some(name));
        }
    }

    #[test]
    fn a_run_is_in_one_pair_of_hands_and_its_folder_too() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 1);
        let digest = done(1, "").digest;
        let claim = sweep.claim(&digest).unwrap().unwrap();
        assert!(sweep.claim(&digest).unwrap().is_none());
        let (name, folder) = sweep.begin_run("0001").unwrap();
        let resumed = RunFolder::resume_on(&Disk::default(), &root.path().join(&name));
        assert!(matches!(resumed, Err(RunError::Locked { .. })));
        drop((claim, folder));
        assert!(sweep.claim(&digest).unwrap().is_some());
        // A lock file beside the state files does not count as a state.
        assert_eq!(sweep.end_of(&digest), None);
        assert_eq!(sweep.manifest().unwrap().unwrap().runs[0].state, SweepState::Pending);
        sweep.end_run(&done(1, &name)).unwrap();
        assert_eq!(sweep.end_of(&digest), Some(done(1, &name)));
    }

    /// Another live process may be writing, so only the first process to enter removes temporary files.
    #[test]
    fn what_killed_processes_were_writing_is_taken_away_when_none_is_left() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 1);
        let places = [".tmpX", "configs/.tmpX", "state/.tmpX"].map(|name| root.path().join(name));
        let first = sweep.enter().unwrap();
        for place in &places {
            std::fs::write(place, "half a fi").unwrap();
        }
        let second = sweep.enter().unwrap();
        drop(first);
        assert!(places.iter().all(|place| place.exists()));
        drop(second);
        let _third = sweep.enter().unwrap();
        assert!(!places.iter().any(|place| place.exists()));
        assert!(root.path().join("configs/0001.toml").exists() && sweep.manifest().unwrap().is_some());
    }

    #[test]
    fn a_manifest_that_is_none_is_named() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 1);
        let path = root.path().join("sweep.json");
        for (text, says) in [
            ("{\"schema\"", "EOF"),
            (
                "{\"schema\":\"other/1\",\"name\":\"\",\"config\":\"\",\"version\":\"\",\"axes\":[],\"records\":[],\"runs\":[]}",
                "other/1",
            ),
        ] {
            std::fs::write(&path, text).unwrap();
            let refused = sweep.manifest().unwrap_err();
            assert!(matches!(refused, SweepFolderError::Unreadable { .. }));
            let message = refused.to_string();
            assert!(message.contains("sweep.json") && message.contains(says), "{message}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_not_taken_for_absent() {
        let root = tempfile::tempdir().unwrap();
        let sweep = frozen(root.path(), 1);
        assert_eq!(sweep.folder().path(), root.path());
        let refused = sweep.begin_run(&"x".repeat(5000)).unwrap_err();
        assert!(matches!(refused, RunError::Io { .. }), "{refused}");
        std::fs::write(root.path().join("state"), "a file").unwrap();
        assert!(matches!(sweep.manifest(), Err(SweepFolderError::Run(RunError::Io { .. }))));
        let path = root.path().join("sweep.json");
        std::fs::remove_file(&path).unwrap();
        std::fs::create_dir(&path).unwrap();
        assert!(matches!(sweep.manifest(), Err(SweepFolderError::Run(RunError::Io { .. }))));
    }
}
