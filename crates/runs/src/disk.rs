//! What writing asks of the system: every operation in one place, so that a test can make any of them fail.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Beginning of the names of temporary files. Who is killed while writing leaves one; resuming takes it away.
pub(crate) const TEMPORARY: &str = ".tmp";

/// The disk that runs are kept on.
///
/// The program's own is [`Disk::default`], the system's as it is. With the feature `faults`, which tests alone turn on,
/// there are disks whose k-th operation fails.
#[derive(Debug, Clone, Default)]
pub struct Disk {
    #[cfg(any(test, feature = "faults"))]
    faults: Option<std::sync::Arc<crate::faults::Faults>>,
}

#[cfg(any(test, feature = "faults"))]
impl Disk {
    /// A disk that fails as told.
    #[must_use]
    pub fn failing(faults: std::sync::Arc<crate::faults::Faults>) -> Self {
        Self { faults: Some(faults) }
    }

    /// Whether the next operation may happen; of a write, how many of its bytes.
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

    /// Makes a folder and those above it, each flushed in the one that holds it.
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

    /// Makes a folder of a name that nobody else has.
    pub(crate) fn make_unique_folder(&self, root: &Path, prefix: &str) -> Result<PathBuf> {
        self.allow()?;
        Ok(tempfile::Builder::new().prefix(prefix).rand_bytes(6).tempdir_in(root)?.keep())
    }

    /// A temporary file; it is gone when it is dropped.
    pub(crate) fn temporary_in(&self, folder: &Path) -> Result<NamedTempFile> {
        self.allow()?;
        tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(folder)
    }

    /// A file to be written from its end on.
    pub(crate) fn open_to_append(&self, path: &Path) -> Result<File> {
        self.allow()?;
        OpenOptions::new().create(true).append(true).open(path)
    }

    /// A file to be written and locked, its content left alone.
    pub(crate) fn open_to_lock(&self, path: &Path) -> Result<File> {
        self.allow()?;
        OpenOptions::new().create(true).truncate(false).read(true).write(true).open(path)
    }

    pub(crate) fn write(&self, file: &mut File, bytes: &[u8]) -> Result<()> {
        let (count, permitted) = self.permit(bytes.len());
        // A full disk takes what it can and refuses the rest.
        file.write_all(bytes.get(..count).unwrap_or(bytes))?;
        permitted
    }

    /// Takes away what stands in a file behind its first bytes, of which there are so many.
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

    /// As [`Disk::rename`], to a name that nothing has; `false` where something does.
    pub(crate) fn rename_new(&self, file: NamedTempFile, path: &Path) -> Result<bool> {
        self.allow()?;
        match file.persist_noclobber(path) {
            Ok(_) => Ok(true),
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(error.error),
        }
    }

    /// Makes a rename or a new file in a folder last through a power cut. Folders cannot be opened for that
    /// on every system; there it is left to the system.
    pub(crate) fn flush_folder(&self, folder: &Path) -> Result<()> {
        if cfg!(unix) {
            self.allow()?;
            File::open(folder)?.sync_all()?;
        }
        Ok(())
    }

    /// Takes a file away that nothing needs any more.
    #[expect(
        clippy::disallowed_methods,
        reason = "temporary files of a killed program, and superseded checkpoints"
    )]
    pub(crate) fn remove_file(&self, path: &Path) -> Result<()> {
        self.allow()?;
        std::fs::remove_file(path)
    }

    /// Takes a folder away that nothing needs any more.
    #[expect(clippy::disallowed_methods, reason = "the checkpoints of a finished run")]
    pub(crate) fn remove_folder(&self, path: &Path) -> Result<()> {
        self.allow()?;
        std::fs::remove_dir_all(path)
    }

    /// Temporary files are made for their owner only; results are for everybody.
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

    /// As the default place of runs is, from the current folder.
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
