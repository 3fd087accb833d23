//! Finished run as trackers show it: parameters, curves by step, numbers of the result, tags.

use runs::{RunError, RunFolder, Texts};
use serde_json::Value;
use settings::{Document, SettingsError};
use std::path::Path;
use thiserror::Error;

/// Reason why a run cannot be exported to a tracker.
#[derive(Debug, Error)]
pub enum TrackingError {
    /// The folder is not a finished run.
    #[error("{folder}: is not a finished run: {problem}; expected a run's folder, as below reports/runs")]
    NoRun {
        /// Path of the folder.
        folder: String,
        /// Fault that was found in it.
        problem: String,
    },
    /// A file of the run cannot be read.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The run's configuration cannot be read.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// Finished run.
#[derive(Debug)]
pub struct Finished {
    /// Name of the run's folder.
    pub name: String,
    /// `true` if the run was completed, `false` if it was stopped.
    pub is_complete: bool,
    /// Start time, in milliseconds since 1970.
    pub began_ms: i64,
    /// End time, in milliseconds since 1970.
    pub ended_ms: i64,
    /// Resolved configuration, by dotted key.
    pub parameters: Vec<(String, String)>,
    /// Values recorded during training.
    pub curves: Vec<Curve>,
    /// Numbers of the result, by dotted name.
    pub metrics: Vec<(String, f64)>,
    /// Texts of the result, such as the task.
    pub tags: Vec<(String, String)>,
    /// Files that a tracker shows beside the numbers.
    pub files: Vec<(&'static str, String)>,
}

/// Files of a run that show its configuration and its result.
const SHOWN: [&str; 5] = ["config.toml", "result.json", "diagnosis.json", "trace.csv", "report.html"];

/// Values by step.
#[derive(Debug)]
pub struct Curve {
    /// Column of `trace.csv`.
    pub name: String,
    /// Step and value, in the order of the table.
    pub points: Vec<(i64, f64)>,
}

impl Finished {
    /// Reads a run's folder; `is_complete` states whether its log ends with the end of the run.
    ///
    /// # Errors
    /// [`TrackingError`] if a file of the run is missing or cannot be read.
    pub fn read(path: &Path, is_complete: bool) -> Result<Self, TrackingError> {
        let refused = |problem: String| TrackingError::NoRun { folder: path.display().to_string(), problem };
        let folder = RunFolder::open(path);
        let (began_ms, ended_ms) = folder.span_ms()?;
        let texts = folder.texts()?;
        let result: Value =
            serde_json::from_str(&texts.result).map_err(|error| refused(format!("the result: {error}")))?;
        let shown = |name| Some((name, std::fs::read_to_string(path.join(name)).ok()?));
        let (mut metrics, mut tags) = (Vec::new(), Vec::new());
        flatten("", &result, &mut metrics, &mut tags);
        Ok(Self {
            is_complete,
            files: SHOWN.into_iter().filter_map(shown).collect(),
            began_ms,
            ended_ms,
            parameters: parameters(&texts)?,
            curves: curves(&texts.trace).map_err(|error| refused(format!("trace.csv: {error}")))?,
            metrics,
            tags,
            name: texts.name,
        })
    }
}

fn parameters(texts: &Texts) -> Result<Vec<(String, String)>, TrackingError> {
    let document = Document::parse("config.toml", &texts.config)?;
    let text = |value: &toml::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    Ok(document.leaves().iter().map(|leaf| (leaf.key.clone(), text(&leaf.value))).collect())
}

/// Returns a curve for each numeric column beside `step`; empty for a table without steps.
fn curves(trace: &str) -> Result<Vec<Curve>, csv::Error> {
    let mut reader = csv::Reader::from_reader(trace.as_bytes());
    let names: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let Some(step) = names.iter().position(|name| name == "step") else { return Ok(Vec::new()) };
    let rows = reader.records().collect::<Result<Vec<_>, _>>()?;
    let column = |at: usize| -> Option<Vec<(i64, f64)>> {
        rows.iter().map(|row| Some((row.get(step)?.parse().ok()?, row.get(at)?.parse().ok()?))).collect()
    };
    let others = names.into_iter().enumerate().filter(|(at, _)| *at != step);
    Ok(others.filter_map(|(at, name)| Some(Curve { name, points: column(at)? })).collect())
}

/// Collects the numbers and texts of a result by dotted name. Rows of a list are named by their `id`; other
/// lists are skipped.
fn flatten(prefix: &str, value: &Value, numbers: &mut Vec<(String, f64)>, texts: &mut Vec<(String, String)>) {
    let dotted = |name: &str| if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") };
    match value {
        Value::Object(table) => {
            for (name, below) in table {
                flatten(&dotted(name), below, numbers, texts);
            }
        }
        Value::Array(rows) => {
            for row in rows {
                if let Some(id) = row.get("id").and_then(Value::as_str) {
                    flatten(&dotted(id), row, numbers, texts);
                }
            }
        }
        Value::Number(number) => numbers.extend(number.as_f64().map(|number| (prefix.to_owned(), number))),
        Value::Bool(holds) => numbers.push((prefix.to_owned(), f64::from(u8::from(*holds)))),
        Value::String(text) => texts.push((prefix.to_owned(), text.clone())),
        Value::Null => {}
    }
}

#[cfg(test)]
mod tests {
    use super::{curves, flatten};
    use serde_json::json;

    #[test]
    fn columns_of_numbers_become_curves() {
        let found = curves("step,phase,loss\n0,\"a, b\",2.5\n3,c,NaN\n").unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].name.as_str(), found[0].points[0]), ("loss", (0, 2.5)));
        assert!(found[0].points[1].1.is_nan() && found[0].points[1].0 == 3);
        assert!(curves("").unwrap().is_empty());
        assert!(curves("time,loss\n1,2\n").unwrap().is_empty());
        let refused = curves("step,loss\n1\n").map(|found| found.len()).unwrap_err();
        let is_short =
            matches!(refused.kind(), csv::ErrorKind::UnequalLengths { expected_len: 2, len: 1, .. });
        assert!(is_short, "{refused}");
    }

    #[test]
    fn a_result_is_flattened_by_names_and_ids() {
        let result = json!({
            "task": "compare", "pass": true, "list": [1, 2],
            "results": [{ "id": "qr", "error": 0.5, "none": null }],
        });
        let (mut numbers, mut texts) = (Vec::new(), Vec::new());
        flatten("", &result, &mut numbers, &mut texts);
        assert_eq!(numbers, [("pass".to_owned(), 1.0), ("results.qr.error".to_owned(), 0.5)]);
        assert_eq!(
            texts,
            [("task".to_owned(), "compare".to_owned()), ("results.qr.id".to_owned(), "qr".to_owned())]
        );
    }
}
