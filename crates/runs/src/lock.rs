//! Lock of a run's folder: only one program at a time works in it.
//!
//! The lock is the operating system's lock on an open file, so a killed program leaves none behind. The
//! content of the file only serves the message to other programs.

use crate::disk::Disk;
use crate::error::RunError;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::time::Duration;

/// Name of the lock file, hidden because users do not need it.
pub(crate) const LOCK: &str = ".lock";

/// Number of attempts to get a lock, and the pause between them. A program that is killed while it starts
/// another process leaves that process a copy of its open file, and so the lock, for a few moments.
const TRIES: u32 = 25;
const PAUSE: Duration = Duration::from_millis(10);

/// Process that holds the folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Holder {
    pid: u32,
    host: String,
    since: String,
}

/// Lock of a folder, held until this value is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    file: File,
}

/// Unlocks explicitly. Closing the file is not enough: a process that another thread is about to start holds
/// a copy of it.
impl Drop for Lock {
    fn drop(&mut self) {
        // If this fails, the file is closed all the same.
        let _ = self.file.unlock();
    }
}

impl Lock {
    /// Takes the lock of a folder.
    ///
    /// # Errors
    /// [`RunError::Locked`] if another program, or this one, already holds it.
    pub(crate) fn take(disk: &Disk, folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(LOCK);
        let mut file = open(disk, &path)?;
        let mut taken = lock(&mut file, folder);
        for _ in 1..TRIES {
            if !matches!(taken, Err(RunError::Locked { .. })) {
                break;
            }
            std::thread::sleep(PAUSE);
            taken = lock(&mut file, folder);
        }
        taken?;
        Self::signed(disk, &path, file)
    }

    /// Waits for the lock of a folder and takes it; for work that takes only moments.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub(crate) fn wait(disk: &Disk, folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(LOCK);
        let file = open(disk, &path)?;
        file.lock().map_err(RunError::io(&path, "lock"))?;
        Self::signed(disk, &path, file)
    }

    /// Takes the lock on a file, which is created if missing; `None` if another program, or this one, already
    /// holds it.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub(crate) fn claim(disk: &Disk, path: &Path) -> Result<Option<Self>, RunError> {
        let file = open(disk, path)?;
        match file.try_lock() {
            Ok(()) => Self::signed(disk, path, file).map(Some),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) => Err(RunError::io(path, "lock")(error)),
        }
    }

    /// Takes a shared lock on a file, which is created if missing. A process that finds the file unlocked
    /// first runs `alone` under an exclusive lock.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses; the error of `alone`.
    pub(crate) fn share(
        disk: &Disk,
        path: &Path,
        alone: impl FnOnce() -> Result<(), RunError>,
    ) -> Result<Self, RunError> {
        let shared = Self { file: open(disk, path)? };
        match shared.file.try_lock() {
            Ok(()) => {
                alone()?;
                shared.file.unlock().map_err(RunError::io(path, "unlock"))?;
            }
            Err(TryLockError::WouldBlock) => (),
            Err(TryLockError::Error(error)) => return Err(RunError::io(path, "lock")(error)),
        }
        shared.file.lock_shared().map_err(RunError::io(path, "lock"))?;
        Ok(shared)
    }

    /// Writes the holder's name into a locked file.
    fn signed(disk: &Disk, path: &Path, mut file: File) -> Result<Self, RunError> {
        let holder = Holder { pid: std::process::id(), host: host(), since: Timestamp::now().to_string() };
        let text = serde_json::to_string(&holder)
            .map_err(|error| RunError::Encoding { name: LOCK.to_owned(), problem: error.to_string() })?;
        disk.shorten(&file, 0).map_err(RunError::io(path, "empty"))?;
        disk.write(&mut file, text.as_bytes()).map_err(RunError::io(path, "write"))?;
        Ok(Self { file })
    }

    /// Checks that no program holds the folder, without changing the folder.
    ///
    /// # Errors
    /// Same as [`Lock::take`].
    pub(crate) fn check(folder: &Path) -> Result<(), RunError> {
        match OpenOptions::new().read(true).write(true).open(folder.join(LOCK)) {
            Ok(mut file) => lock(&mut file, folder),
            // There is no lock file, or the folder is read-only.
            Err(_) => Ok(()),
        }
    }
}

fn open(disk: &Disk, path: &Path) -> Result<File, RunError> {
    disk.open_to_lock(path).map_err(RunError::io(path, "open"))
}

fn lock(file: &mut File, folder: &Path) -> Result<(), RunError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(RunError::locked(folder, holder(file).as_ref())),
        Err(TryLockError::Error(error)) => Err(RunError::io(&folder.join(LOCK), "lock")(error)),
    }
}

/// Reads the holder of the lock; `None` if the file has just been emptied.
fn holder(file: &mut File) -> Option<Holder> {
    let mut text = String::new();
    file.seek(SeekFrom::Start(0)).ok()?;
    file.read_to_string(&mut text).ok()?;
    serde_json::from_str(&text).ok()
}

impl RunError {
    fn locked(folder: &Path, holder: Option<&Holder>) -> Self {
        let holder = holder.map_or_else(
            || "another program".to_owned(),
            |Holder { pid, host, since }| format!("process {pid} on {host} since {since}"),
        );
        Self::Locked { path: folder.to_owned(), holder }
    }
}

/// Returns the name of this machine, if the system provides one.
fn host() -> String {
    ["/proc/sys/kernel/hostname", "/etc/hostname"]
        .iter()
        .find_map(|path| std::fs::read_to_string(path).ok())
        .map(|name| name.trim().to_owned())
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| "this machine".to_owned())
}

#[cfg(test)]
mod tests {
    use super::{LOCK, Lock, RunError};
    use crate::disk::Disk;

    #[test]
    fn the_second_is_refused_by_the_firsts_name_until_that_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        Lock::check(folder.path()).unwrap();
        assert!(!folder.path().join(LOCK).exists());
        let first = Lock::take(&Disk::default(), folder.path()).unwrap();
        for refused in [Lock::take(&Disk::default(), folder.path()).map(|_| ()), Lock::check(folder.path())] {
            let message = refused.unwrap_err().to_string();
            assert!(message.contains(&format!("process {} on ", std::process::id())), "{message}");
            assert!(message.contains(" since 20"), "{message}");
        }
        drop(first);
        Lock::check(folder.path()).unwrap();
        Lock::take(&Disk::default(), folder.path()).unwrap();
    }

    #[test]
    fn a_claim_is_refused_at_once_and_free_again_with_its_holder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.lock");
        let disk = Disk::default();
        let first = Lock::claim(&disk, &path).unwrap().unwrap();
        assert!(Lock::claim(&disk, &path).unwrap().is_none());
        drop(first);
        assert!(Lock::claim(&disk, &path).unwrap().is_some());
        let absent = Lock::claim(&disk, &folder.path().join("absent/case.lock")).map(|_| ()).unwrap_err();
        assert!(matches!(absent, RunError::Io { action: "open", .. }), "{absent}");
    }

    #[test]
    fn the_first_of_those_who_share_has_it_alone_for_a_moment() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shared");
        let disk = Disk::default();
        let mut alone = 0;
        let mut share = || {
            Lock::share(&disk, &path, || {
                alone += 1;
                Ok(())
            })
            .unwrap()
        };
        let (first, second) = (share(), share());
        drop(first);
        let third = share();
        drop((second, third));
        drop(share());
        assert_eq!(alone, 2);
    }

    #[test]
    fn a_lock_that_is_let_go_in_a_moment_is_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let first = Lock::take(&Disk::default(), folder.path()).unwrap();
        let soon = std::thread::spawn(move || {
            std::thread::sleep(3 * super::PAUSE);
            drop(first);
        });
        assert!(Lock::take(&Disk::default(), folder.path()).is_ok());
        soon.join().unwrap();
    }

    #[test]
    fn what_stands_in_the_file_decides_nothing() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(LOCK), "process 1 for ever, ".repeat(100)).unwrap();
        let lock = Lock::take(&Disk::default(), folder.path()).unwrap();
        // No part of the old content remains after the new holder's name.
        let message = Lock::check(folder.path()).unwrap_err().to_string();
        assert!(message.contains(&format!("process {} on ", std::process::id())), "{message}");
        std::fs::write(folder.path().join(LOCK), "").unwrap();
        let message = Lock::check(folder.path()).unwrap_err().to_string();
        assert!(message.contains("another program is working in it"), "{message}");
        drop(lock);
    }

    #[test]
    #[cfg(unix)]
    fn the_machine_has_the_name_that_the_system_gives_it() {
        let told = std::process::Command::new("uname").arg("-n").output().unwrap();
        assert_eq!(super::host(), String::from_utf8(told.stdout).unwrap().trim());
    }
}
