//! Report and tables of a run, derived from the other files of its folder.

use crate::error::TrainerError;
use report::{Reader, RunTexts, comparison_markdown, prediction_markdown, render};
use runs::RunFolder;
use serde_json::Value;
use std::path::Path;

/// Builds the error for a folder that holds no file of a run.
pub(crate) fn no_run(run: &Path) -> TrainerError {
    let problem = "it holds none of its files, such as result.json".to_owned();
    TrainerError::NoRun { folder: run.display().to_string(), problem }
}

/// Writes `report.html` from the folder's other files.
pub(crate) fn write_report(folder: &RunFolder) -> Result<(), TrainerError> {
    let texts = folder.texts()?;
    let html = render(&RunTexts {
        name: &texts.name,
        config: &texts.config,
        result: &texts.result,
        trace: &texts.trace,
        envelope: &texts.envelope,
        predictions: &texts.predictions,
        series: &texts.series,
        environment: &texts.environment,
        reader: Reader::CommandLine,
    })?;
    folder.write("report.html", html.as_bytes())?;
    Ok(())
}

/// Returns the tables derived from the folder's result; `None` if its task has none.
pub(crate) fn tables(folder: &RunFolder) -> Result<Option<String>, TrainerError> {
    let result = folder.texts()?.result;
    let task = serde_json::from_str::<Value>(&result).unwrap_or_default();
    Ok(match task.get("task").and_then(Value::as_str) {
        Some("compare") => Some(comparison_markdown(&result)?),
        Some("predict") => Some(prediction_markdown(&result)?),
        _ => None,
    })
}
