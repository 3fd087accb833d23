//! Record files in a folder.

use crate::error::WorkflowError;
use record::Fault;
use std::path::{Path, PathBuf};

/// Log in memory.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Log {
    /// Name in messages and results.
    pub name: String,
    /// Bytes of the file.
    pub bytes: Vec<u8>,
    /// Remark on the folder of the log; only the first log of a folder has one.
    pub note: Option<String>,
}

impl Log {
    /// Reads the [`logs`] at a path.
    ///
    /// # Errors
    /// Those of [`logs`], and [`WorkflowError::Record`] for a file that cannot be read.
    pub fn read(path: &Path) -> Result<Vec<Self>, WorkflowError> {
        let read = |path: &PathBuf| {
            let name = path.display().to_string();
            let bytes = std::fs::read(path).map_err(|error| {
                WorkflowError::Record(Fault::Unreadable { problem: error.to_string() }.in_file(&name))
            })?;
            Ok(Self { name, bytes, note: None })
        };
        let mut found = logs(path)?.iter().map(read).collect::<Result<Vec<_>, WorkflowError>>()?;
        if let Some(first) = found.first_mut() {
            first.note = left_out(path);
        }
        Ok(found)
    }
}

/// Extensions of files that hold samples.
const TABLES: &[&str] = &["csv", "tsv", "lvm", "npy", "npz", "mat", "wav"];
/// Extensions of text files that may hold a table.
const TEXTS: &[&str] = &["txt", "log", "dat"];
/// Extensions of documents that seldom hold a table.
const DOCUMENTS: &[&str] = &["json", "jsonl", "ndjson"];
/// Beginnings of the names of the file with the samples in an export of phyphox. Beside it there may be tables
/// that the app computed from the samples.
const RAW: &[&str] = &["raw data", "rohdaten"];

/// Returns `true` if a file is a log by its name: one with an ending of [`logs`], except JSON, in which programs
/// write much else.
#[must_use]
pub fn is_log(path: &Path) -> bool {
    path.is_file() && (ends_in(path, TABLES) || ends_in(path, TEXTS))
}

/// Returns `true` if a folder belongs to a finished run or diagnosis.
#[must_use]
pub fn is_run(folder: &Path) -> bool {
    ["result.json", "diagnosis.json"].iter().any(|file| folder.join(file).is_file())
}

/// Returns the logs at a path: a file itself, or the logs in a folder, sorted by name.
///
/// In a folder these are the files that end in `.csv`, `.tsv`, `.lvm`, `.npy`, `.npz`, `.mat` or `.wav`; if
/// there are none, those that end in `.txt`, `.log` or `.dat`, or else in `.json`, `.jsonl` or `.ndjson`. Beside
/// raw data of phyphox, the results that the app computed from them are skipped ([`left_out`]), as are hidden
/// files and subfolders.
///
/// # Errors
/// [`WorkflowError::NoLogs`] for a folder without a log, and for the folder of a finished run, whose tables
/// are not records.
pub fn logs(path: &Path) -> Result<Vec<PathBuf>, WorkflowError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let folder = path.display().to_string();
    let none =
        |problem: String, remedy: String| WorkflowError::NoLogs { folder: folder.clone(), problem, remedy };
    if is_run(path) {
        return Err(none(
            "is the folder of a finished run, whose tables are no records".to_owned(),
            format!("name the records themselves; `trainer report {folder}` makes its report again"),
        ));
    }
    let entries = entries(path).map_err(|error| {
        none(format!("cannot be listed: {error}"), "name the records themselves".to_owned())
    })?;
    let found = among(&entries);
    if found.is_empty() {
        let endings = [TABLES, TEXTS, DOCUMENTS].concat().join(", .");
        let problem = format!("holds no log: no file in it has one of the endings .{endings}");
        return Err(none(problem, elsewhere(&folder, &entries)));
    }
    Ok(found)
}

/// Returns a sentence on the results of phyphox that [`logs`] skips in a folder, if there are some.
#[must_use]
pub fn left_out(path: &Path) -> Option<String> {
    let tables = of(&entries(path).ok()?, TABLES);
    let name = |path: &PathBuf| Some(path.file_name()?.to_string_lossy().into_owned());
    let (raw, others): (Vec<&PathBuf>, Vec<&PathBuf>) = tables.iter().partition(|path| is_raw(path));
    let [raw, others] =
        [raw, others].map(|files| files.into_iter().filter_map(name).collect::<Vec<_>>().join(", "));
    (!raw.is_empty() && !others.is_empty()).then(|| {
        format!(
            "only {raw} was read, since the tables beside it are computed from it: {others}; to read one of those, name the file"
        )
    })
}

fn is_raw(path: &Path) -> bool {
    path.file_name().is_some_and(|name| {
        let name = name.to_string_lossy().to_lowercase();
        RAW.iter().any(|raw| name.starts_with(raw))
    })
}

/// Returns the entries of a folder that are not hidden, sorted by name.
fn entries(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        if !entry.file_name().to_string_lossy().starts_with('.') {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}

/// Selects the logs among the entries of a folder.
fn among(entries: &[PathBuf]) -> Vec<PathBuf> {
    let kinds = [TABLES, TEXTS, DOCUMENTS].into_iter().map(|endings| of(entries, endings));
    let Some(mut found) = kinds.into_iter().find(|found| !found.is_empty()) else { return Vec::new() };
    if found.iter().any(|path| is_raw(path)) {
        found.retain(|path| is_raw(path));
    }
    found
}

/// Returns the files with certain endings among the entries of a folder.
fn of(entries: &[PathBuf], endings: &[&str]) -> Vec<PathBuf> {
    entries.iter().filter(|path| path.is_file() && ends_in(path, endings)).cloned().collect()
}

/// Suggests what to name in place of a folder that holds no log.
fn elsewhere(folder: &str, entries: &[PathBuf]) -> String {
    if entries.iter().any(|path| path.join("nominal.toml").is_file()) {
        return format!(
            "its folders are cases with a nominal.toml each, which `trainer diagnose --batch {folder} --out ANSWERS` takes"
        );
    }
    if entries.iter().any(|path| ends_in(path, &["xlsx", "xls", "ods"])) {
        return "save the sheets of its workbooks as CSV".to_owned();
    }
    let holds_some =
        |path: &&PathBuf| path.is_dir() && self::entries(path).is_ok_and(|within| !among(&within).is_empty());
    match entries.iter().find(holds_some) {
        Some(within) => format!("there are some in {}", within.display()),
        None => "name the records themselves".to_owned(),
    }
}

fn ends_in(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|own| endings.contains(&own.to_string_lossy().to_lowercase().as_str()))
}

#[cfg(test)]
mod tests {
    use super::{left_out, logs};
    use std::path::Path;

    fn names(folder: &Path) -> Vec<String> {
        let found = logs(folder).unwrap();
        found.iter().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
    }

    #[test]
    fn a_folder_stands_for_its_logs() {
        let scratch = tempfile::tempdir().unwrap();
        let within = |folder: &str, files: &[&str]| {
            let folder = scratch.path().join(folder);
            std::fs::create_dir_all(&folder).unwrap();
            files.iter().for_each(|file| std::fs::write(folder.join(file), "").unwrap());
            folder
        };
        assert_eq!(names(&within("texts", &["notes.txt", "a.LOG", "x.png"])), ["a.LOG", "notes.txt"]);
        let tables = ["b.CSV", "a.csv", "c.tsv", ".hidden.csv", "nominal.toml", "notes.txt"];
        assert_eq!(names(&within("tables", &tables)), ["a.csv", "b.CSV", "c.tsv"]);
        let phone = within("phone", &["Raw Data.csv", "Autocorrelation.csv", "Resonance.csv"]);
        assert_eq!(names(&phone), ["Raw Data.csv"]);
        let said = left_out(&phone).unwrap();
        assert!(said.contains("only Raw Data.csv was read"), "{said}");
        assert!(said.contains("Autocorrelation.csv, Resonance.csv"), "{said}");
        assert_eq!(left_out(&scratch.path().join("tables")), None);
        for file in ["a.lvm", "a.npy", "a.npz", "a.mat", "a.wav", "a.json", "a.jsonl", "a.ndjson"] {
            assert_eq!(names(&within(file.trim_start_matches("a."), &[file])), [file]);
        }
        let file = scratch.path().join("x.csv");
        assert_eq!(logs(&file).unwrap(), [file], "a file stands for itself");
        let refused = |folder: &Path, expected: &str| {
            let message = logs(folder).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        };
        refused(&within("none", &["x.png"]), "name the records themselves");
        refused(&within("sheets", &["Versuch 1.xlsx"]), "save the sheets of its workbooks as CSV");
        within("outer/inner", &["a.csv"]);
        refused(&scratch.path().join("outer"), "there are some in ");
        within("cases/one", &["record-000.csv", "nominal.toml"]);
        refused(&scratch.path().join("cases"), "--batch");
        refused(&within("run", &["series.csv", "diagnosis.json"]), "trainer report ");
    }
}
