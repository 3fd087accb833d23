//! Labels of a case for the report on a fleet, from `case.toml` or from columns of its record.

use crate::error::TrainerError;
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the label file in a case's folder.
const FILE: &str = "case.toml";

/// Columns of a record that label it, if they hold one value throughout.
const COLUMNS: [&str; 3] = ["robot", "joint", "date"];

/// Reads labels by name from a case's folder and its first record. Labels of `case.toml` override those of
/// the record's columns.
pub(super) fn read(folder: &Path, record: &Path) -> Result<BTreeMap<String, String>, TrainerError> {
    let mut labels = columns(record);
    let path = folder.join(FILE);
    if !path.exists() {
        return Ok(labels);
    }
    let refused = |problem: String| TrainerError::Labels {
        file: path.display().to_string(),
        problem: problem.trim().to_owned(),
    };
    let text = std::fs::read_to_string(&path).map_err(|error| refused(error.to_string()))?;
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| refused(error.to_string()))?;
    for (key, value) in table {
        let word = match value {
            toml::Value::String(word) => word,
            toml::Value::Array(_) | toml::Value::Table(_) => {
                return Err(refused(format!("`{key}` is a list or a table")));
            }
            other => other.to_string(),
        };
        labels.insert(key, word);
    }
    Ok(labels)
}

/// Reads the labels in a record's columns. A record that cannot be parsed has none; reading it as a record
/// reports the error.
fn columns(path: &Path) -> BTreeMap<String, String> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let header = text.lines().next().unwrap_or_default();
    let separator = [b',', b';', b'\t'].into_iter().find(|separator| header.contains(char::from(*separator)));
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator.unwrap_or(b','))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let header = reader.headers().cloned().unwrap_or_default();
    let place = |name: &str| header.iter().position(|column| column.eq_ignore_ascii_case(name));
    let mut found: Vec<(&str, usize, Option<String>)> =
        COLUMNS.iter().filter_map(|name| Some((*name, place(name)?, None))).collect();
    if found.is_empty() {
        return BTreeMap::new();
    }
    for row in reader.records().map_while(Result::ok) {
        found.retain_mut(|(_, at, value)| match (row.get(*at), value.as_deref()) {
            (Some(cell), None) => {
                *value = Some(cell.to_owned());
                !cell.is_empty()
            }
            (cell, known) => cell == known,
        });
    }
    found.into_iter().filter_map(|(name, _, value)| Some((name.to_owned(), value?))).collect()
}

#[cfg(test)]
mod tests {
    use super::read;

    fn labels(record: &str, toml: Option<&str>) -> Result<String, String> {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("record-000.csv", record);
        if let Some(toml) = toml {
            write("case.toml", toml);
        }
        let labels =
            read(folder.path(), &folder.path().join("record-000.csv")).map_err(|error| error.to_string())?;
        Ok(labels.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(" "))
    }

    #[test]
    fn a_case_is_labeled_by_its_file_and_by_columns_of_one_value() {
        let record = "time_s;Robot;joint;angle_rad\n0;r7;elbow;1\n1;r7;wrist;2\n";
        assert_eq!(labels(record, None).unwrap(), "robot=r7");
        let toml = "robot = \"r8\"\ndate = 2026-11-23\nrun = 4\n";
        assert_eq!(labels(record, Some(toml)).unwrap(), "date=2026-11-23 robot=r8 run=4");
        assert_eq!(labels("time_s,angle_rad\n0,1\n", None).unwrap(), "");
    }

    #[test]
    fn what_is_no_label_is_refused_with_its_file() {
        for (toml, says) in [("robot = ", "case.toml: "), ("robot = [1]", "`robot` is a list or a table")] {
            let refused = labels("time_s,angle_rad\n0,1\n", Some(toml)).unwrap_err();
            assert!(refused.contains(says) && refused.contains("expected lines such as"), "{refused}");
        }
    }
}
