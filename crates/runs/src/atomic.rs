//! Atomic file writes: a crash leaves either the old file or the new one.

use crate::disk::Disk;
use crate::error::RunError;
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file: temporary file in the same folder, flush to disk, rename, flush of the folder.
///
/// A crash before the rename leaves the old content, and perhaps a file named `.tmp…`; a crash after it
/// leaves the new content. If the last flush fails, the new content is in place but may not survive a power
/// cut.
pub(crate) fn write(disk: &Disk, path: &Path, content: &[u8]) -> Result<(), RunError> {
    let file = fill(disk, path, content)?;
    disk.flush(file.as_file()).map_err(RunError::io(path, "flush"))?;
    disk.rename(file, path).map_err(RunError::io(path, "rename into place"))?;
    disk.flush_folder(folder_of(path)).map_err(RunError::io(path, "flush the folder of"))
}

/// Writes one file outside a run's folder atomically, replacing any existing file.
///
/// # Errors
/// [`RunError::Io`] with the file and the operation that failed.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), RunError> {
    write(&Disk::default(), path, content)
}

/// Writes a file as [`write`] does, but only if it does not exist yet. Returns `false`, and changes nothing,
/// if it exists.
pub(crate) fn write_new(disk: &Disk, path: &Path, content: &[u8]) -> Result<bool, RunError> {
    let file = fill(disk, path, content)?;
    disk.flush(file.as_file()).map_err(RunError::io(path, "flush"))?;
    if !disk.rename_new(file, path).map_err(RunError::io(path, "rename into place"))? {
        return Ok(false);
    }
    disk.flush_folder(folder_of(path)).map_err(RunError::io(path, "flush the folder of"))?;
    Ok(true)
}

/// Writes a file as [`write`] does, without waiting for the disk: a crash of the program leaves a whole file
/// or none, a power cut may lose it. Meant for files that a seed can reproduce, because ten thousand flushes
/// take longer than computing the files.
pub(crate) fn write_unflushed(disk: &Disk, path: &Path, content: &[u8]) -> Result<(), RunError> {
    let file = fill(disk, path, content)?;
    disk.rename(file, path).map_err(RunError::io(path, "rename into place"))
}

/// Creates a temporary file with the content in the folder of `path`.
fn fill(disk: &Disk, path: &Path, content: &[u8]) -> Result<NamedTempFile, RunError> {
    let mut file = disk.temporary_in(folder_of(path)).map_err(RunError::io(path, "create"))?;
    disk.write(file.as_file_mut(), content).map_err(RunError::io(path, "write"))?;
    disk.share(file.path(), 0o644).map_err(RunError::io(path, "set permissions of"))?;
    Ok(file)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        // A bare file name has an empty parent.
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::write_new;
    use crate::disk::Disk;
    use crate::error::RunError;

    #[test]
    fn a_new_file_gives_way_to_one_that_is_there_and_to_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.json");
        let disk = Disk::default();
        assert!(write_new(&disk, &path, b"first").unwrap());
        assert!(!write_new(&disk, &path, b"second").unwrap());
        assert_eq!(std::fs::read(&path).unwrap(), b"first");
        // No file system accepts a name this long.
        let refused = write_new(&disk, &folder.path().join("x".repeat(5000)), b"").unwrap_err();
        assert!(matches!(refused, RunError::Io { .. }), "{refused}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
