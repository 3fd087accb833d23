//! Comparison of the files of two runs. Times of day and durations are ignored.

use crate::error::TrainerError;
use runs::{RunError, digest};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

/// Files that are not compared: they record the machine and the time, or are checked or derived otherwise.
/// The configuration is checked by its digest, and the pages are rebuilt from the other files.
const NOT_COMPARED: &[&str] =
    &[".lock", "config.toml", "environment.json", "events.jsonl", "report.html", "tables.md", "table.tex"];

/// Subfolder that `trainer export` adds to a run's folder, which is not part of the run.
const EXPORTED: &str = "tensorboard/";

/// Key of every duration in a result.
const DURATION: &str = "seconds";

/// Value that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Difference {
    pub(super) file: String,
    /// Dotted key, line and column, or the compared property of the file.
    pub(super) place: String,
    pub(super) kept: String,
    pub(super) again: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, place, kept, again } = self;
        write!(f, "{file}: {place}: {kept} kept, {again} made again")
    }
}

/// Returns every difference between the files below two folders.
pub(super) fn differences(kept: &Path, again: &Path) -> Result<Vec<Difference>, TrainerError> {
    let mut names = files(kept, "")?;
    names.extend(files(again, "")?);
    let mut found = Vec::new();
    let is_compared = |name: &str| !NOT_COMPARED.contains(&name) && !name.starts_with(EXPORTED);
    for name in names.iter().filter(|name| is_compared(name)) {
        let bytes = [kept, again].map(|folder| std::fs::read(folder.join(name)).ok());
        let texts = bytes.each_ref().map(|bytes| str::from_utf8(bytes.as_ref()?).ok());
        let before = found.len();
        let mut add = |place: String, kept: String, again: String| {
            found.push(Difference { file: name.clone(), place, kept, again });
        };
        match (texts, name.rsplit('.').next()) {
            ([Some(kept), Some(again)], Some("json")) => {
                let values = [kept, again].map(serde_json::from_str::<Value>);
                if let [Ok(kept), Ok(again)] = values {
                    in_values("", &kept, &again, &mut add);
                    continue;
                }
            }
            ([Some(kept), Some(again)], Some("csv")) => in_tables(kept, again, &mut add),
            _ => {}
        }
        // The file is not text, or differs in a part that was not compared as text.
        if found.len() == before && bytes.first() != bytes.last() {
            let shown = bytes.map(|bytes| bytes.map_or_else(|| "absent".to_owned(), |bytes| digest(&bytes)));
            let [kept, again] = shown;
            found.push(Difference { file: name.clone(), place: "digest".to_owned(), kept, again });
        }
    }
    Ok(found)
}

/// Returns the names of all files below a folder, relative to it.
fn files(folder: &Path, prefix: &str) -> Result<BTreeSet<String>, TrainerError> {
    let mut names = BTreeSet::new();
    let refused = |source| RunError::Io { path: folder.to_owned(), action: "list", source };
    for entry in std::fs::read_dir(folder).map_err(refused)? {
        let entry = entry.map_err(refused)?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            names.extend(files(&entry.path(), &format!("{name}/"))?);
        } else {
            names.insert(name);
        }
    }
    Ok(names)
}

fn in_values(place: &str, kept: &Value, again: &Value, add: &mut impl FnMut(String, String, String)) {
    let below = |key: &str| if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
    let absent = || "absent".to_owned();
    match (kept, again) {
        (Value::Object(kept), Value::Object(again)) => {
            for (key, value) in kept.iter().filter(|(key, _)| *key != DURATION) {
                match again.get(key) {
                    Some(other) => in_values(&below(key), value, other, add),
                    None => add(below(key), value.to_string(), absent()),
                }
            }
            for (key, value) in again.iter().filter(|(key, _)| !kept.contains_key(*key)) {
                add(below(key), absent(), value.to_string());
            }
        }
        (Value::Array(kept), Value::Array(again)) => {
            if kept.len() != again.len() {
                add(below("length"), kept.len().to_string(), again.len().to_string());
            }
            for (at, (kept, again)) in kept.iter().zip(again).enumerate() {
                in_values(&below(&at.to_string()), kept, again, add);
            }
        }
        _ if kept == again => {}
        _ => add(place.to_owned(), kept.to_string(), again.to_string()),
    }
}

/// Compares two tables cell by cell; columns are named by the header of the original table.
fn in_tables(kept: &str, again: &str, add: &mut impl FnMut(String, String, String)) {
    let rows = |text: &str| -> Vec<csv::StringRecord> {
        let reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        reader.into_records().map_while(Result::ok).collect()
    };
    let (kept, again) = (rows(kept), rows(again));
    if kept.len() != again.len() {
        add("lines".to_owned(), kept.len().to_string(), again.len().to_string());
    }
    for (at, (one, other)) in kept.iter().zip(&again).enumerate() {
        for column in 0..one.len().max(other.len()) {
            let cells = [one, other].map(|row| row.get(column).unwrap_or("absent").to_owned());
            let [kept_cell, again_cell] = cells;
            if kept_cell != again_cell {
                let name = kept.first().and_then(|header| header.get(column)).unwrap_or("more");
                add(format!("line {}, {name}", at + 1), kept_cell, again_cell);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::differences;
    use std::path::Path;

    fn write(folder: &Path, files: &[(&str, &[u8])]) {
        for (name, content) in files {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        }
    }

    #[test]
    fn every_difference_is_told_with_file_place_and_both_values() {
        let (kept, again) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        write(
            kept.path(),
            &[
                ("result.json", br#"{"seconds": 1.5, "seeds": [{"zeta": 0.1, "seconds": 2}], "only": null}"#),
                ("trace.csv", b"step,loss\n0,1.0\n1,0.5\n"),
                ("model/weights.safetensors", b"\xff\x00"),
                ("report.html", b"old"),
                ("extra.txt", b"x"),
                ("tensorboard/events.out.tfevents.1.ringdown", b"x"),
            ],
        );
        write(
            again.path(),
            &[
                (
                    "result.json",
                    br#"{"seconds": 9.5, "seeds": [{"zeta": 0.10000000000000002, "seconds": 3}], "new": 1}"#,
                ),
                ("trace.csv", b"step,loss\n0,1.0\n1,0.25\n2,0.1\n"),
                ("model/weights.safetensors", b"\xff\x01"),
                ("report.html", b"new"),
            ],
        );
        let found: Vec<String> =
            differences(kept.path(), again.path()).unwrap().iter().map(ToString::to_string).collect();
        assert_eq!(found.len(), 7, "{found:#?}");
        for expected in [
            "result.json: seeds.0.zeta: 0.1 kept, 0.10000000000000002 made again",
            "result.json: only: null kept, absent made again",
            "result.json: new: absent kept, 1 made again",
            "trace.csv: lines: 3 kept, 4 made again",
            "trace.csv: line 3, loss: 0.5 kept, 0.25 made again",
        ] {
            assert!(found.iter().any(|line| line == expected), "{expected} {found:#?}");
        }
        assert!(found.iter().any(|line| line.starts_with("model/weights.safetensors: digest: sha256:")));
        assert!(
            found
                .iter()
                .any(|line| line.starts_with("extra.txt: digest: sha256:") && line.contains("absent"))
        );
        assert!(differences(kept.path(), kept.path()).unwrap().is_empty());
    }
}
