//! Folders of banks that come from outside: what stands in them.

use super::error::TrialError;
use dynamics::Nominal;
use std::path::{Path, PathBuf};

/// A file with what a diagnosis left over of a measured record.
pub(crate) type ResidualFile = PathBuf;

/// A case that another program made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OutsideCase {
    /// Folder with records and nominal.toml.
    folder: PathBuf,
    /// The hidden truth.
    pub(crate) truth: PathBuf,
    /// What to do where the folder cannot be used.
    remedy: &'static str,
}

/// Entries of a folder in the order of their names.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let listing = std::fs::read_dir(folder).map_err(|error| format!("cannot be read: {error}"))?;
    let mut paths: Vec<PathBuf> = listing.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    Ok(paths)
}

/// The last part of a path.
pub(crate) fn file_name(path: &Path) -> String {
    // Only a path that ends in `..` has none, and no entry of a folder does.
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Returns whether a file is named `PREFIX*.csv`.
fn is_table(path: &Path, prefix: &str) -> bool {
    let name = file_name(path);
    name.starts_with(prefix) && name.ends_with(".csv")
}

/// The residual files of a folder.
pub(crate) fn residual_files(folder: &Path) -> Result<Vec<ResidualFile>, String> {
    let mut files = entries(folder)?;
    files.retain(|path| is_table(path, "residual-"));
    if files.is_empty() { Err("holds no residual-*.csv".to_owned()) } else { Ok(files) }
}

/// The cases of a folder that a physics engine's script made.
pub(crate) fn engine_cases(folder: &Path) -> Result<Vec<OutsideCase>, String> {
    let cases = outside_cases(folder, &folder.join("hidden"), "make the records again")?;
    if cases.is_empty() {
        Err("holds no folder with nominal.toml that hidden/ has a truth for".to_owned())
    } else {
        Ok(cases)
    }
}

/// The rigs of a folder, by name.
pub(crate) fn rig_cases(folder: &Path) -> Result<Vec<OutsideCase>, String> {
    let remedy = "make the records again with experiments/rigs/records.py";
    let cases = outside_cases(&folder.join("cases"), &folder.join("truths"), remedy)?;
    if cases.is_empty() {
        Err("holds no cases/ID/nominal.toml that truths/ has a truth for".to_owned())
    } else {
        Ok(cases)
    }
}

/// Folders with a nominal simulator that a folder of truths has a file for, by name.
fn outside_cases(folder: &Path, truths: &Path, remedy: &'static str) -> Result<Vec<OutsideCase>, String> {
    let case = |path: PathBuf| OutsideCase {
        truth: truths.join(format!("{}.json", file_name(&path))),
        folder: path,
        remedy,
    };
    let is_whole = |case: &OutsideCase| case.truth.is_file() && case.folder.join("nominal.toml").is_file();
    Ok(entries(folder)?.into_iter().map(case).filter(is_whole).collect())
}

impl OutsideCase {
    /// Its record files in the order of their names.
    ///
    /// # Errors
    /// [`TrialError::Outside`] where there is none.
    pub(crate) fn records(&self) -> Result<Vec<PathBuf>, TrialError> {
        let refused = |problem: String| self.refused(&self.folder, problem);
        let mut paths = entries(&self.folder).map_err(refused)?;
        paths.retain(|path| is_table(path, "record-"));
        if paths.is_empty() { Err(refused("holds no record-*.csv".to_owned())) } else { Ok(paths) }
    }

    /// What is believed of the system.
    ///
    /// # Errors
    /// [`TrialError::Outside`] where `nominal.toml` cannot be read or is no nominal simulator.
    pub(crate) fn nominal(&self) -> Result<Nominal, TrialError> {
        let path = self.folder.join("nominal.toml");
        toml::from_str(&self.text(&path)?).map_err(|error| TrialError::Outside {
            path: path.display().to_string(),
            problem: error.message().to_owned(),
            remedy: "write a nominal simulator",
        })
    }

    /// The text of one of its files.
    ///
    /// # Errors
    /// [`TrialError::Outside`] where it cannot be read.
    pub(crate) fn text(&self, path: &Path) -> Result<String, TrialError> {
        std::fs::read_to_string(path).map_err(|error| self.refused(path, format!("cannot be read: {error}")))
    }

    /// The error of a file that cannot be used.
    pub(crate) fn refused(&self, path: &Path, problem: String) -> TrialError {
        TrialError::Outside { path: path.display().to_string(), problem, remedy: self.remedy }
    }
}
