//! `trainer report`: the report of a finished run, sweep or batch, rebuilt from its folder.

mod fleet;
mod outliers;

use crate::commands::sweep::finish;
use crate::error::TrainerError;
use crate::folders::page::{no_run, write_report};
use crate::options::Output;
use crate::outcome::Outcome;
use crate::terminal::console;
use runs::{RunFolder, SweepFolder, has_run_files};
use serde_json::json;
use std::path::Path;

/// Rebuilds a run's report and replaces the old one. Nothing is lost, since the report is derived from the
/// other files. For a sweep, the table is rebuilt as well from the runs that are there, since its tasks may
/// have been killed before they wrote one. For a fleet, the report is built from the answers of a batch.
pub(crate) fn command(run: &Path, output: Output) -> Result<Outcome, TrainerError> {
    if !run.is_dir() {
        return Err(no_run(run));
    }
    let folder = RunFolder::open(run);
    let sweep = SweepFolder::open(run);
    match sweep.manifest()? {
        Some(mut manifest) => {
            let _present = sweep.enter()?;
            finish(&sweep, &mut manifest)?;
        }
        None if fleet::is_one(run) => fleet::write(&folder)?,
        None if !has_run_files(run) => return Err(no_run(run)),
        None => write_report(&folder)?,
    }
    let report = run.join("report.html").display().to_string();
    if output.json {
        console::result(&json!({ "report": report }).to_string());
    } else if !output.quiet {
        console::result(&format!("report: {report}"));
    }
    Ok(Outcome::Done)
}
