//! Temporary folder.

use crate::error::RunError;
use std::path::Path;
use tempfile::TempDir;

/// Folder in the system's place for temporary files; deleted with all its content when this value is dropped.
#[derive(Debug)]
pub struct Scratch(TempDir);

impl Scratch {
    /// Creates a temporary folder.
    ///
    /// # Errors
    /// [`RunError::Io`] if the operating system refuses.
    pub fn new() -> Result<Self, RunError> {
        let place = std::env::temp_dir();
        let refused = RunError::io(&place, "create a folder in");
        tempfile::Builder::new().prefix("ringdown-").tempdir().map(Self).map_err(refused)
    }

    /// Returns the path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
    }
}

#[cfg(test)]
mod tests {
    use super::Scratch;

    #[test]
    fn it_is_a_folder_while_it_lives() {
        let (one, other) = (Scratch::new().unwrap(), Scratch::new().unwrap());
        let path = one.path().to_owned();
        assert!(path.is_dir() && path != other.path());
        std::fs::write(path.join("a"), "x").unwrap();
        drop(one);
        assert!(!path.exists() && other.path().is_dir());
    }
}
