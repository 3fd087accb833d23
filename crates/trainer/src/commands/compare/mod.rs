//! `trainer compare`: finished runs in one table.

pub(crate) mod arguments;

use crate::error::{TableError, TrainerError};
use crate::folders::page::write_report;
use crate::outcome::Outcome;
use crate::run_table::{
    build::{Entry, build, sort},
    of_sweep::entries,
    print_table,
};
use crate::terminal::console;
use arguments::{CompareArguments, Format};
use report::{RunTexts, render_run_table, run_table_csv, run_table_latex, run_table_markdown};
use results::{RunTable, RunTableTask};
use runs::{RunFolder, SweepFolder, has_run_files, list_runs, read_run};
use std::path::{Path, PathBuf};

/// Reads the runs, builds the table, writes and prints it.
pub(crate) fn command(arguments: &CompareArguments) -> Result<Outcome, TrainerError> {
    if let Some(path) = &arguments.out {
        RunFolder::check_free(path)?;
    }
    let mut found = Vec::new();
    for argument in &arguments.runs {
        for path in paths(argument)? {
            found.extend(at(&path)?);
        }
    }
    let mut table = build(RunTableTask::Runs, "", Vec::new(), found);
    if let Some(key) = &arguments.sort {
        sort(&mut table, key, arguments.reverse)?;
    }
    if let Some(path) = &arguments.out {
        let folder = RunFolder::create_at(path)?;
        folder.write_json("result.json", &table)?;
        folder.write("table.csv", run_table_csv(&table).as_bytes())?;
        folder.write("table.md", run_table_markdown(&table).as_bytes())?;
        folder.write("table.tex", run_table_latex(&table).as_bytes())?;
        write_report(&folder)?;
    }
    if arguments.output.json {
        arguments.output.print(&table, String::new)?;
    } else if !arguments.output.quiet {
        match arguments.format {
            Some(Format::Csv) => console::result(run_table_csv(&table).trim_end()),
            Some(Format::Markdown) => console::result(run_table_markdown(&table).trim_end()),
            Some(Format::Latex) => console::result(run_table_latex(&table).trim_end()),
            Some(Format::Html) => console::result(&page(&table)?),
            Some(Format::Text) | None => print_table(&table),
        }
    }
    Ok(Outcome::Done)
}

/// Renders the page of a table that is not saved.
fn page(table: &RunTable) -> Result<String, TrainerError> {
    let result = serde_json::to_string_pretty(table)
        .map_err(|error| TrainerError::System { what: "the table", problem: error.to_string() })?;
    Ok(render_run_table(&RunTexts { name: "Runs side by side", result: &result, ..RunTexts::default() })?)
}

/// Returns the folders that an argument names; those that match a pattern are sorted by name.
fn paths(argument: &str) -> Result<Vec<PathBuf>, TableError> {
    let path = PathBuf::from(argument);
    if path.exists() {
        return Ok(vec![path]);
    }
    if !argument.contains(['*', '?', '[']) {
        return Err(TableError::Absent { path: argument.to_owned() });
    }
    let bad = |problem: String| TableError::BadPattern { pattern: argument.to_owned(), problem };
    let matches = glob::glob(argument).map_err(|error| bad(error.to_string()))?;
    // Paths that cannot be read do not count as matches.
    let found: Vec<PathBuf> = matches.flatten().filter(|path| path.is_dir()).collect();
    if found.is_empty() { Err(TableError::NoMatch { pattern: argument.to_owned() }) } else { Ok(found) }
}

/// Returns the entries at a path: the runs of a sweep, a single run, or the runs in a folder.
fn at(path: &Path) -> Result<Vec<Entry>, TrainerError> {
    if SweepFolder::is_one(path) {
        let folder = SweepFolder::open(path);
        return Ok(match folder.manifest() {
            Ok(Some(manifest)) => entries(&folder, &manifest),
            // The single row states the error.
            Ok(None) | Err(_) => vec![run(path)],
        });
    }
    if !path.is_dir() {
        return Err(TableError::Absent { path: path.display().to_string() }.into());
    }
    let holds_runs = |path: &Path| has_run_files(path) || SweepFolder::is_one(path);
    if has_run_files(path) {
        return Ok(vec![run(path)]);
    }
    let inside = list_runs(path)?;
    if !inside.iter().any(|run| holds_runs(&run.path)) {
        // The folder was probably meant to be a run.
        return Ok(vec![run(path)]);
    }
    let mut all = Vec::new();
    for kept in inside {
        if SweepFolder::is_one(&kept.path) {
            all.extend(at(&kept.path)?);
        } else {
            all.push(Entry { rows: kept.rows, config: kept.config });
        }
    }
    Ok(all)
}

fn run(path: &Path) -> Entry {
    let kept = read_run(path);
    Entry { rows: kept.rows, config: kept.config }
}
