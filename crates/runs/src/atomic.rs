//! Writing a file so that a crash leaves the old one or the new one.

use crate::disk::Disk;
use crate::error::RunError;
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file: temporary file in the same folder, flush to disk, rename, flush of the folder.
///
/// A crash before the rename leaves what was there, and perhaps a file named `.tmp…`; after it, the new
/// content. Where the last flush fails the new content is there and may not last through a power cut.
pub(crate) fn write(disk: &Disk, path: &Path, content: &[u8]) -> Result<(), RunError> {
    let file = fill(disk, path, content)?;
    disk.flush(file.as_file()).map_err(RunError::io(path, "flush"))?;
    disk.rename(file, path).map_err(RunError::io(path, "rename into place"))?;
    disk.flush_folder(folder_of(path)).map_err(RunError::io(path, "flush the folder of"))
}

/// Writes one file outside of a run's folder, in place of one that is there: whole, or not at all.
///
/// # Errors
/// [`RunError::Io`] with the file and what was tried.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), RunError> {
    write(&Disk::default(), path, content)
}

/// As [`write`] where there is no such file yet; `false`, and nothing changed, where there is one.
pub(crate) fn write_new(disk: &Disk, path: &Path, content: &[u8]) -> Result<bool, RunError> {
    let file = fill(disk, path, content)?;
    disk.flush(file.as_file()).map_err(RunError::io(path, "flush"))?;
    if !disk.rename_new(file, path).map_err(RunError::io(path, "rename into place"))? {
        return Ok(false);
    }
    disk.flush_folder(folder_of(path)).map_err(RunError::io(path, "flush the folder of"))?;
    Ok(true)
}

/// As [`write`], without waiting for the disk: a crash of the program leaves a whole file or none, a power cut
/// may take it. For what a seed gives again; ten thousand flushes take longer than making the files.
pub(crate) fn write_unflushed(disk: &Disk, path: &Path, content: &[u8]) -> Result<(), RunError> {
    let file = fill(disk, path, content)?;
    disk.rename(file, path).map_err(RunError::io(path, "rename into place"))
}

/// A temporary file in the same folder, with the content.
fn fill(disk: &Disk, path: &Path, content: &[u8]) -> Result<NamedTempFile, RunError> {
    let mut file = disk.temporary_in(folder_of(path)).map_err(RunError::io(path, "create"))?;
    disk.write(file.as_file_mut(), content).map_err(RunError::io(path, "write"))?;
    disk.share(file.path(), 0o644).map_err(RunError::io(path, "set permissions of"))?;
    Ok(file)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        // A bare name has an empty parent.
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
        // No system takes a name so long.
        let refused = write_new(&disk, &folder.path().join("x".repeat(5000)), b"").unwrap_err();
        assert!(matches!(refused, RunError::Io { .. }), "{refused}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
