//! A folder for what is thrown away.

use crate::error::RunError;
use std::path::Path;
use tempfile::TempDir;

/// A folder in the system's place for temporary files, gone with all that is in it when this is dropped.
#[derive(Debug)]
pub struct Scratch(TempDir);

impl Scratch {
    /// A new one.
    ///
    /// # Errors
    /// [`RunError::Io`] where the system refuses.
    pub fn new() -> Result<Self, RunError> {
        let place = std::env::temp_dir();
        let refused = RunError::io(&place, "create a folder in");
        tempfile::Builder::new().prefix("ringdown-").tempdir().map(Self).map_err(refused)
    }

    /// Where it is.
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
