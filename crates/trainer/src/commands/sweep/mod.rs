//! `trainer sweep`: every combination of some keys' values, or a search among them; resumable.

pub(crate) mod arguments;
mod execute;
mod frozen;
pub(crate) mod measure;
pub(crate) mod search;
mod study;

use crate::error::{SweepCommandError, TrainerError};
use crate::folders::page::write_report;
use crate::options::Output;
use crate::outcome::Outcome;
use crate::run_table::{of_sweep, print_table};
use crate::share::{Launcher, Work, launch};
use crate::terminal::console;
use crate::terminal::interrupt::{self, Saving};
use arguments::SweepArguments;
use execute::Making;
use frozen::{FrozenSweep, Job, is_missing};
use record::counted;
use report::{run_table_csv, run_table_latex, run_table_markdown};
use results::{RunTable, SweepLine, SweepManifest, SweepSearch, SweepState};
use runs::SweepFolder;
use serde::Serialize;
use serde_json::json;

/// JSON output: the table and the sweep's folder.
#[derive(Serialize)]
struct Answer<'a> {
    folder: String,
    #[serde(flatten)]
    table: &'a RunTable,
}

/// Freezes or reopens a sweep, makes the missing runs, and builds the table.
pub(crate) fn command(arguments: &SweepArguments) -> Result<Outcome, TrainerError> {
    let cancel = interrupt::watch()?;
    let mut sweep = frozen::settle(arguments)?;
    let _present = sweep.folder.enter()?;
    let searches = sweep.manifest.search.clone().filter(looks_at_results);
    if let Some(search) = &searches
        && (arguments.share.launcher.is_some() || arguments.share.shard.is_some())
    {
        let what = if search.halving.is_some() { "--halving" } else { "--search tpe" };
        return Err(SweepCommandError::Shares { what }.into());
    }
    if let Some(Launcher::Slurm) = arguments.share.launcher {
        return launched(arguments, &sweep);
    }
    let shard = arguments.share.shard();
    let output = arguments.output;
    let making = Making { threads: arguments.threads(), output, cancel, pause_after: None };
    let made = make(arguments, &mut sweep, searches.as_ref(), &making)?;
    let _saving = Saving::begin();
    let table = finish(&sweep.folder, &mut sweep.manifest)?;
    let own = || sweep.manifest.runs.iter().enumerate().filter(|(position, _)| shard.takes(*position));
    // A request to stop that comes after the last run interrupts nothing.
    let interrupted = cancel.is_requested() && own().any(|(_, line)| is_missing(line, false));
    let event = if interrupted { "interrupted" } else { "end" };
    sweep.folder.folder().record_event(event, &json!({ "runs": made, "shard": shard.to_string() }))?;
    let path = sweep.folder.path().display().to_string();
    tell(output, &path, &table)?;
    if interrupted {
        if !output.quiet {
            console::remark(&format!("interrupted; trainer sweep --out {path} --resume goes on"));
        }
        return Ok(Outcome::Interrupted);
    }
    if let Some(found) = &table.search {
        let outcome = if found.best.is_some() { Outcome::Done } else { Outcome::CheckFailed };
        return Ok(arguments.share.outcome(outcome));
    }
    let is_fine = own().map(|(_, line)| line).all(|line| holds(&table, &sweep.manifest, line));
    Ok(arguments.share.outcome(if is_fine { Outcome::Done } else { Outcome::CheckFailed }))
}

/// Makes the missing runs of this process's share and returns their number.
fn make(
    arguments: &SweepArguments,
    sweep: &mut FrozenSweep,
    searches: Option<&SweepSearch>,
    making: &Making,
) -> Result<usize, TrainerError> {
    let (count, path) = (sweep.manifest.runs.len(), sweep.folder.path().display().to_string());
    let said = |now: &str| {
        if !making.is_silent() {
            console::remark(&format!("sweep of {} in {path}{now}", counted(count, "run")));
        }
    };
    if let Some(search) = searches {
        said("");
        return search::search(sweep, search, arguments.failed, making);
    }
    let shard = arguments.share.shard();
    let own = sweep.jobs().enumerate().filter(|(position, _)| shard.takes(*position));
    let jobs: Vec<Job<'_>> =
        own.map(|(_, job)| job).filter(|(line, _)| is_missing(line, arguments.failed)).collect();
    said(&format!(", {} of them now", jobs.len()));
    execute::execute(sweep, &jobs, making)?;
    Ok(jobs.len())
}

/// Prints the table, as JSON or as text.
fn tell(output: Output, path: &str, table: &RunTable) -> Result<(), TrainerError> {
    if output.json {
        output.print(&Answer { folder: path.to_owned(), table }, String::new)?;
    } else if !output.quiet {
        print_table(table);
        if let Some(found) = &table.search {
            console::text(&format!("\n{}", found.sentence()));
        }
        console::result(&format!("\nsweep: {path}\nreport: {path}/report.html"));
    }
    Ok(())
}

/// Submits the frozen list to a batch system; its tasks need no configuration.
fn launched(arguments: &SweepArguments, sweep: &FrozenSweep) -> Result<Outcome, TrainerError> {
    let path = sweep.folder.path();
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned()).display().to_string();
    let mut words = vec!["sweep".to_owned(), "--out".to_owned(), path, "--resume".to_owned()];
    words.extend(arguments.failed.then(|| "--failed".to_owned()));
    let work = Work {
        name: &sweep.manifest.name,
        folder: sweep.folder.folder(),
        parts: sweep.manifest.runs.len(),
        part: "run",
        words,
        threads: arguments.run.threads.unwrap_or(1),
    };
    launch(&arguments.share, &work, arguments.output)
}

/// Returns `true` if a search needs results before it can choose the next runs.
fn looks_at_results(search: &SweepSearch) -> bool {
    search.sampler.looks_at_results() || search.halving.is_some()
}

/// Returns `true` if a run is done and all its rows are within their tolerances.
fn holds(table: &RunTable, manifest: &SweepManifest, line: &SweepLine) -> bool {
    let name = of_sweep::run_name(manifest, line);
    line.state == SweepState::Done
        && table
            .rows
            .iter()
            .filter(|row| row.run == name)
            .all(|row| !row.state.is_bad() && row.pass != Some(false))
}

/// Writes the manifest, the table and the page until nothing has changed meanwhile: of several shares that
/// end at the same time, the last leaves them complete.
pub(crate) fn finish(sweep: &SweepFolder, manifest: &mut SweepManifest) -> Result<RunTable, TrainerError> {
    loop {
        sweep.refresh(manifest)?;
        let table = of_sweep::table(sweep, manifest)?;
        let folder = sweep.folder();
        if let Some(best) = table.search.as_ref().and_then(|found| found.best.as_ref()) {
            folder.write("best.toml", of_sweep::best_config(sweep, best, &table)?.as_bytes())?;
        }
        folder.write_json("result.json", &table)?;
        folder.write("table.csv", run_table_csv(&table).as_bytes())?;
        folder.write("table.md", run_table_markdown(&table).as_bytes())?;
        folder.write("table.tex", run_table_latex(&table).as_bytes())?;
        write_report(folder)?;
        let now = sweep.manifest().map_err(SweepCommandError::Folder)?;
        if now.is_none_or(|now| now.runs == manifest.runs) {
            return Ok(table);
        }
    }
}
