//! `trainer list runs`: the runs in a folder.

use crate::error::TrainerError;
use crate::options::Output;
use crate::outcome::Outcome;
use crate::run_table::RED;
use crate::terminal::console;
use crate::terminal::table::table;
use record::counted;
use record::two_digits;
use results::{RunState, RunTableRow};
use runs::{KeptRun, SweepFolder, default_root, list_runs as read_runs};
use serde_json::{Value, json};
use std::path::Path;

/// Lists the runs in a folder, or those of a sweep, newest first.
pub(crate) fn list_runs(folder: Option<&Path>, output: Output) -> Result<Outcome, TrainerError> {
    let root = folder.map_or_else(default_root, Path::to_path_buf);
    let root = if SweepFolder::is_one(&root) { root.join("runs") } else { root };
    // A fresh clone has no runs yet.
    let runs = if folder.is_none() && !root.exists() { Vec::new() } else { read_runs(&root)? };
    if output.json {
        let rows: Vec<Value> = runs.iter().map(row_json).collect();
        console::result(&json!({ "folder": root.display().to_string(), "runs": rows }).to_string());
    } else if !output.quiet {
        let header = ["run", "task", "estimator", "state", "ζ", "error %", "began (UTC)"];
        let rows: Vec<Vec<String>> = runs.iter().map(row_text).collect();
        let count = |state| runs.iter().filter(|run| run.state == state).count();
        let counted = format!(
            "{} in {}: {} done, {} interrupted, {} unfinished, {} failed, {} corrupt",
            counted(runs.len(), "run"),
            root.display(),
            count(RunState::Done),
            count(RunState::Interrupted),
            count(RunState::Unfinished),
            count(RunState::Failed),
            count(RunState::Corrupt)
        );
        let text = if runs.is_empty() { counted } else { format!("{}\n\n{counted}", table(&header, rows)) };
        console::table(&text, &RED);
    }
    Ok(Outcome::Done)
}

/// Returns the row that represents a run: that of the worst method, if there are several.
fn worst(run: &KeptRun) -> Option<&RunTableRow> {
    let error = |row: &RunTableRow| row.worst_error_percent.unwrap_or(f64::NEG_INFINITY);
    run.rows.iter().max_by(|one, other| error(one).total_cmp(&error(other)))
}

fn row_text(run: &KeptRun) -> Vec<String> {
    let row = worst(run);
    let said = match row.and_then(|row| row.zeta) {
        Some(zeta) => format!("{zeta:.8}"),
        None if !run.reason.is_empty() => run.reason.clone(),
        None => run.summary.clone(),
    };
    let error = row.and_then(|row| row.worst_error_percent);
    let state =
        if run.state.is_bad() { run.state.name().to_uppercase() } else { run.state.name().to_owned() };
    vec![
        run.name.clone(),
        run.task.clone(),
        run.estimator.clone(),
        state,
        said,
        error.map_or_else(String::new, two_digits),
        run.began(),
    ]
}

fn row_json(run: &KeptRun) -> Value {
    let row = worst(run);
    json!({
        "name": run.name,
        "path": run.path.display().to_string(),
        "task": run.task,
        "estimator": run.estimator,
        "state": run.state,
        "reason": run.reason,
        "summary": run.summary,
        "zeta": row.and_then(|row| row.zeta),
        "zeta_std_error": row.and_then(|row| row.zeta_std_error),
        "error_percent": row.and_then(|row| row.worst_error_percent),
        "pass": row.and_then(|row| row.pass),
        "began": run.started.map(|time| time.to_string()),
    })
}
