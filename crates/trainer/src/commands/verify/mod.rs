//! `trainer verify`: repetition of a finished run from its folder, compared with the original.

mod difference;

use crate::commands::run::run_until;
use crate::error::{ResumeError, TrainerError};
use crate::folders::page::{no_run, tables};
use crate::folders::resume::{DataFile, check_data, config_of, is_finished, started};
use crate::options::{ExperimentArguments, Output, RunOptions};
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::interrupt;
use difference::{Difference, differences};
use record::counted;
use runs::{Disk, RunFolder, Scratch, digest};
use serde_json::json;
use std::path::Path;

/// Maximum number of differences printed; all of them are counted and included in the JSON output.
const MOST_PRINTED: usize = 20;

/// Repeats the run of a folder in a temporary folder and reports the differences.
pub(crate) fn command(run: &Path, threads: Option<u16>, output: Output) -> Result<Outcome, TrainerError> {
    if !run.is_dir() {
        return Err(no_run(run));
    }
    let cancel = interrupt::watch()?;
    let folder = RunFolder::open(run);
    let shown = || run.display().to_string();
    let begun = started(&folder)?.ok_or_else(|| ResumeError::NoRun { folder: shown() })?;
    config_of(&folder, &begun)?;
    if !is_finished(&folder)? {
        return Err(ResumeError::Unfinished { folder: shown() }.into());
    }
    check_data(&begun, &present(&begun.data))?;
    let scratch = Scratch::new()?;
    let again = scratch.path().join("again");
    let arguments = ExperimentArguments {
        config: Some(run.join("config.toml")),
        overrides: Vec::new(),
        run: RunOptions { out: Some(again.clone()), threads, ..RunOptions::default() },
        output: Output { quiet: true, json: false },
        disk: Disk::default(),
    };
    if run_until(&arguments, cancel)? == Outcome::Interrupted {
        return Ok(Outcome::Interrupted);
    }
    let mut found = differences(run, &again)?;
    found.extend(derived(&folder)?);
    print(run, &found, output);
    Ok(if found.is_empty() { Outcome::Done } else { Outcome::CheckFailed })
}

/// Reads the records as they are now; those that cannot be read are left out.
fn present(data: &[DataFile]) -> Vec<DataFile> {
    let read = |file: &DataFile| {
        let bytes = std::fs::read(&file.path).ok()?;
        Some(DataFile { path: file.path.clone(), digest: digest(&bytes) })
    };
    data.iter().filter_map(read).collect()
}

/// Rebuilds the tables that are derived from the result and compares them with the original ones. The report
/// is not compared: it holds the folder's name, which may have changed since.
fn derived(folder: &RunFolder) -> Result<Option<Difference>, TrainerError> {
    let name = "tables.md";
    let Some(again) = tables(folder)?.filter(|_| folder.path().join(name).exists()) else { return Ok(None) };
    let [kept, again] = [digest(&folder.read(name)?), digest(again.as_bytes())];
    Ok((kept != again).then(|| Difference { file: name.to_owned(), place: "digest".to_owned(), kept, again }))
}

fn print(run: &Path, found: &[Difference], output: Output) {
    if output.json {
        let value =
            json!({ "run": run.display().to_string(), "identical": found.is_empty(), "differences": found });
        console::result(&value.to_string());
    } else if !output.quiet && found.is_empty() {
        console::result(&format!("{}: identical", run.display()));
    } else if !output.quiet {
        console::result(&format!("{}: {}", run.display(), counted(found.len(), "difference")));
        for difference in found.iter().take(MOST_PRINTED) {
            console::result(&difference.to_string());
        }
        if found.len() > MOST_PRINTED {
            console::result(&format!("and {} more", found.len() - MOST_PRINTED));
        }
    }
}
