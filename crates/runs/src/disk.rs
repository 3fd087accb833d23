//! File system operations for writing, all in one place, so that a test can make any of them fail.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Prefix of the names of temporary files. A program that is killed while writing leaves one; resuming
/// removes it.
pub(crate) const TEMPORARY: &str = ".tmp";

/// Disk on which runs are stored.
///
/// The program uses [`Disk::default`], the system's disk without changes. With the feature `faults`, which
/// only tests enable, there are disks whose k-th operation fails.
#[derive(Debug, Clone, Default)]
pub struct Disk {
    #[cfg(any(test, feature = "faults"))]
    faults: Option<std::sync::Arc<crate::faults::Faults>>,
}

#[cfg(any(test, feature = "faults"))]
impl Disk {
    /// Creates a disk that fails as `faults` specifies.
    #[must_use]
    pub fn failing(faults: std::sync::Arc<crate::faults::Faults>) -> Self {
        Self { faults: Some(faults) }
    }

    /// Decides about the next operation: number of bytes that a write may write, and the result of the
    /// operation.
    fn permit(&self, bytes: usize) -> (usize, Result<()>) {
        self.faults.as_ref().map_or((bytes, Ok(())), |faults| faults.next(bytes))
    }
}

#[cfg(not(any(test, feature = "faults")))]
impl Disk {
    #[expect(clippy::unused_self, reason = "the disk of tests asks itself")]
    fn permit(&self, bytes: usize) -> (usize, Result<()>) {
        (bytes, Ok(()))
    }
}

impl Disk {
    fn allow(&self) -> Result<()> {
        self.permit(0).1
    }

    /// Creates a folder and its missing parents, and flushes each to disk in its parent.
    pub(crate) fn make_folders(&self, path: &Path) -> Result<()> {
        let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.is_dir();
        let missing: Vec<&Path> = path.ancestors().take_while(is_missing).collect();
        if missing.is_empty() {
            return Ok(());
        }
        self.allow()?;
        std::fs::create_dir_all(path)?;
        for made in missing {
            let above = made.parent().filter(|above| !above.as_os_str().is_empty());
            self.flush_folder(above.unwrap_or_else(|| Path::new(".")))?;
        }
        Ok(())
    }

    /// Creates a folder with a unique name.
    pub(crate) fn make_unique_folder(&self, root: &Path, prefix: &str) -> Result<PathBuf> {
        self.allow()?;
        Ok(tempfile::Builder::new().prefix(prefix).rand_bytes(6).tempdir_in(root)?.keep())
    }

    /// Creates a temporary file, which is deleted when it is dropped.
    pub(crate) fn temporary_in(&self, folder: &Path) -> Result<NamedTempFile> {
        self.allow()?;
        tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(folder)
    }

    /// Opens a file for appending; creates it if it does not exist.
    pub(crate) fn open_to_append(&self, path: &Path) -> Result<File> {
        self.allow()?;
        OpenOptions::new().create(true).append(true).open(path)
    }

    /// Opens a file for writing and locking without changing its content; creates it if it does not exist.
    pub(crate) fn open_to_lock(&self, path: &Path) -> Result<File> {
        self.allow()?;
        OpenOptions::new().create(true).truncate(false).read(true).write(true).open(path)
    }

    pub(crate) fn write(&self, file: &mut File, bytes: &[u8]) -> Result<()> {
        let (count, permitted) = self.permit(bytes.len());
        // A full disk writes as many bytes as fit and refuses the rest.
        file.write_all(bytes.get(..count).unwrap_or(bytes))?;
        permitted
    }

    /// Truncates a file to its first `bytes` bytes.
    pub(crate) fn shorten(&self, file: &File, bytes: u64) -> Result<()> {
        self.allow()?;
        file.set_len(bytes)
    }

    pub(crate) fn flush(&self, file: &File) -> Result<()> {
        self.allow()?;
        file.sync_all()
    }

    pub(crate) fn rename(&self, file: NamedTempFile, path: &Path) -> Result<()> {
        self.allow()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    }

    /// Renames a file as [`Disk::rename`] does, but only to an unused name; returns `false` if the name is in
    /// use.
    pub(crate) fn rename_new(&self, file: NamedTempFile, path: &Path) -> Result<bool> {
        self.allow()?;
        match file.persist_noclobber(path) {
            Ok(_) => Ok(true),
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(error.error),
        }
    }

    /// Makes a rename or a new file in a folder survive a power cut. Not every system can open folders for
    /// flushing; on those, this does nothing.
    pub(crate) fn flush_folder(&self, folder: &Path) -> Result<()> {
        if cfg!(unix) {
            self.allow()?;
            File::open(folder)?.sync_all()?;
        }
        Ok(())
    }

    /// Deletes a file that is no longer needed.
    #[expect(
        clippy::disallowed_methods,
        reason = "temporary files of a killed program, and superseded checkpoints"
    )]
    pub(crate) fn remove_file(&self, path: &Path) -> Result<()> {
        self.allow()?;
        std::fs::remove_file(path)
    }

    /// Deletes a folder that is no longer needed.
    #[expect(clippy::disallowed_methods, reason = "the checkpoints of a finished run")]
    pub(crate) fn remove_folder(&self, path: &Path) -> Result<()> {
        self.allow()?;
        std::fs::remove_dir_all(path)
    }

    /// Sets the permissions of a file. Temporary files are created for their owner only; results are for
    /// everybody.
    #[cfg(unix)]
    pub(crate) fn share(&self, path: &Path, mode: u32) -> Result<()> {
        use std::os::unix::fs::PermissionsExt;
        self.allow()?;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode))
    }

    #[cfg(not(unix))]
    pub(crate) fn share(&self, _path: &Path, _mode: u32) -> Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Disk;
    use std::path::Path;

    /// A relative path, as that of the default folder for runs is.
    #[test]
    fn a_relative_folder_is_made_in_the_current_one() {
        let name = format!(".made-by-test-{}", std::process::id());
        let path = Path::new(&name).join("runs");
        Disk::default().make_folders(&path).unwrap();
        assert!(path.is_dir());
        Disk::default().make_folders(&path).unwrap();
        std::fs::remove_dir_all(&name).unwrap();
    }
}
