//! Writing a file so that a crash leaves the old one or the new one.

use crate::error::RunError;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file: temporary file in the same folder, flush to disk, rename, flush of the folder.
///
/// A crash before the rename leaves what was there, and perhaps a file named `.tmp…`; after it, the new
/// content.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<(), RunError> {
    put(path, content, File::sync_all)?;
    sync_folder(path.parent().unwrap_or_else(|| Path::new(".")))
}

/// As [`write`], without waiting for the disk: a crash of the program leaves a whole file or none, a power cut
/// may take it. For what a seed gives again; ten thousand flushes take longer than making the files.
pub(crate) fn write_unflushed(path: &Path, content: &[u8]) -> Result<(), RunError> {
    put(path, content, |_| Ok(()))
}

/// Writes to a temporary file in the same folder, flushes it as asked, and renames it into place.
fn put(path: &Path, content: &[u8], flush: impl Fn(&File) -> std::io::Result<()>) -> Result<(), RunError> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let mut file = NamedTempFile::new_in(folder).map_err(RunError::io(path, "create"))?;
    file.write_all(content).map_err(RunError::io(path, "write"))?;
    allow_reading(file.as_file()).map_err(RunError::io(path, "set permissions of"))?;
    flush(file.as_file()).map_err(RunError::io(path, "flush"))?;
    file.persist(path).map_err(|error| RunError::io(path, "rename into place")(error.error))?;
    Ok(())
}

/// Makes a rename or a new file in a folder last through a power cut. Folders cannot be opened for that
/// on every system; there it is left to the system.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), RunError> {
    if cfg!(unix) {
        let handle = File::open(folder).map_err(RunError::io(folder, "open"))?;
        handle.sync_all().map_err(RunError::io(folder, "flush"))?;
    }
    Ok(())
}

/// Temporary files are made for their owner only; results are for everybody.
#[cfg(unix)]
fn allow_reading(file: &File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn allow_reading(_file: &File) -> std::io::Result<()> {
    Ok(())
}
