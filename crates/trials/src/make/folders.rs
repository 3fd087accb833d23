//! Folders of external banks and their contents.

use super::error::TrialError;
use dynamics::Nominal;
use std::path::{Path, PathBuf};

/// File with the residual that a diagnosis left of a measured record.
pub(crate) type ResidualFile = PathBuf;

/// Case that another program made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OutsideCase {
    /// Folder with records and nominal.toml.
    folder: PathBuf,
    /// File of the hidden truth.
    pub(crate) truth: PathBuf,
    /// Remedy if the folder cannot be used.
    remedy: &'static str,
}

/// Lists the entries of a folder, sorted by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let listing = std::fs::read_dir(folder).map_err(|error| format!("cannot be read: {error}"))?;
    let mut paths: Vec<PathBuf> = listing.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    Ok(paths)
}

/// Returns the last component of a path; empty for a path that ends in `..`.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Returns `true` if a file is named `PREFIX*.csv`.
fn is_table(path: &Path, prefix: &str) -> bool {
    let name = file_name(path);
    name.starts_with(prefix) && name.ends_with(".csv")
}

/// Lists the residual files of a folder.
pub(crate) fn residual_files(folder: &Path) -> Result<Vec<ResidualFile>, String> {
    let mut files = entries(folder)?;
    files.retain(|path| is_table(path, "residual-"));
    if files.is_empty() { Err("holds no residual-*.csv".to_owned()) } else { Ok(files) }
}

/// Lists the cases of a folder that a physics engine's script made.
pub(crate) fn engine_cases(folder: &Path) -> Result<Vec<OutsideCase>, String> {
    let cases = outside_cases(folder, &folder.join("hidden"), "make the records again")?;
    if cases.is_empty() {
        Err("holds no folder with nominal.toml that hidden/ has a truth for".to_owned())
    } else {
        Ok(cases)
    }
}

/// Lists the rigs of a folder, sorted by name.
pub(crate) fn rig_cases(folder: &Path) -> Result<Vec<OutsideCase>, String> {
    let remedy = "make the records again with experiments/rigs/records.py";
    let cases = outside_cases(&folder.join("cases"), &folder.join("truths"), remedy)?;
    if cases.is_empty() {
        Err("holds no cases/ID/nominal.toml that truths/ has a truth for".to_owned())
    } else {
        Ok(cases)
    }
}

/// Lists the subfolders that have a nominal simulator and a truth, sorted by name.
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
    /// Returns the record files, sorted by name.
    ///
    /// # Errors
    /// [`TrialError::Outside`] if there is none.
    pub(crate) fn records(&self) -> Result<Vec<PathBuf>, TrialError> {
        let refused = |problem: String| self.refused(&self.folder, problem);
        let mut paths = entries(&self.folder).map_err(refused)?;
        paths.retain(|path| is_table(path, "record-"));
        if paths.is_empty() { Err(refused("holds no record-*.csv".to_owned())) } else { Ok(paths) }
    }

    /// Reads the nominal simulator.
    ///
    /// # Errors
    /// [`TrialError::Outside`] if `nominal.toml` cannot be read or is no nominal simulator.
    pub(crate) fn nominal(&self) -> Result<Nominal, TrialError> {
        let path = self.folder.join("nominal.toml");
        toml::from_str(&self.text(&path)?).map_err(|error| TrialError::Outside {
            path: path.display().to_string(),
            problem: error.message().to_owned(),
            remedy: "write a nominal simulator",
        })
    }

    /// Reads the text of one of the case's files.
    ///
    /// # Errors
    /// [`TrialError::Outside`] if it cannot be read.
    pub(crate) fn text(&self, path: &Path) -> Result<String, TrialError> {
        std::fs::read_to_string(path).map_err(|error| self.refused(path, format!("cannot be read: {error}")))
    }

    /// Returns the error for a file that cannot be used.
    pub(crate) fn refused(&self, path: &Path, problem: String) -> TrialError {
        TrialError::Outside { path: path.display().to_string(), problem, remedy: self.remedy }
    }
}
