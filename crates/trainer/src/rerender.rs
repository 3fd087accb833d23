//! `trainer report`.

use crate::Outcome;
use crate::cli::Output;
use crate::console;
use crate::error::TrainerError;
use report::{RunTexts, comparison_markdown, prediction_markdown, render};
use runs::RunFolder;
use serde_json::{Value, json};
use std::path::Path;

/// Makes a run's report again and puts it in place of the old one: it is derived from the other files,
/// so nothing is lost.
pub(crate) fn rerender(run: &Path, output: Output) -> Result<Outcome, TrainerError> {
    let folder = RunFolder::open(run);
    write_report(&folder)?;
    let report = run.join("report.html").display().to_string();
    if output.json {
        console::result(&json!({ "report": report }).to_string());
    } else if !output.quiet {
        console::result(&format!("report: {report}"));
    }
    Ok(Outcome::Done)
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
    })?;
    folder.write("report.html", html.as_bytes())?;
    Ok(())
}

/// The tables that the folder's result makes, where its task has some.
pub(crate) fn tables(folder: &RunFolder) -> Result<Option<String>, TrainerError> {
    let result = folder.texts()?.result;
    let task = serde_json::from_str::<Value>(&result).unwrap_or_default();
    Ok(match task.get("task").and_then(Value::as_str) {
        Some("compare") => Some(comparison_markdown(&result)?),
        Some("predict") => Some(prediction_markdown(&result)?),
        _ => None,
    })
}
