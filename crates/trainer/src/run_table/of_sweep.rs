//! Table of a sweep: the outcome of each run of the frozen list.

use crate::commands::sweep::measure::{value_of, warning};
use crate::error::{SweepCommandError, TrainerError};
use crate::run_table::build::{Entry, build};
use results::{
    RunState, RunTable, RunTableRow, RunTableTask, SearchBest, SearchOutcome, SweepLine, SweepManifest,
    SweepState,
};
use runs::{SweepFolder, read_run};
use settings::Document;

/// Builds the table in the order of the frozen list; runs are named relative to the sweep's folder.
///
/// # Errors
/// A result lacks the measure of the search.
pub(crate) fn table(folder: &SweepFolder, manifest: &SweepManifest) -> Result<RunTable, SweepCommandError> {
    let entry = |line| entry(folder, manifest, line, &|run| run.to_owned());
    let entries = manifest.runs.iter().map(entry).collect();
    let mut table = build(RunTableTask::Sweep, &manifest.name, manifest.axes.clone(), entries);
    let Some(search) = &manifest.search else { return Ok(table) };
    let mut measured: Vec<(&SweepLine, f64)> = Vec::new();
    for line in &manifest.runs {
        let Some(value) = value_of(folder, search, line)? else { continue };
        if line.state == SweepState::Done {
            measured.push((line, value));
        }
        let name = run_name(manifest, line);
        for row in table.rows.iter_mut().filter(|row| row.run == name) {
            row.settings.insert(search.measure.clone(), value.into());
        }
    }
    if !table.columns.contains(&search.measure) {
        table.columns.push(search.measure.clone());
    }
    let count = |state| manifest.runs.iter().filter(|line| line.state == state).count();
    let cost = |value: f64| if search.maximize { -value } else { value };
    let best = measured.iter().min_by(|one, other| cost(one.1).total_cmp(&cost(other.1)));
    table.search = Some(SearchOutcome {
        sampler: search.sampler,
        measure: search.measure.clone(),
        maximize: search.maximize,
        trials: search.trials,
        measured: measured.len(),
        stopped: count(SweepState::Stopped),
        failed: count(SweepState::Failed) + count(SweepState::Done) - measured.len(),
        best: best.map(|(line, value)| SearchBest {
            number: line.number,
            run: run_name(manifest, line),
            value: *value,
            overrides: line.overrides.clone(),
            config: BEST.to_owned(),
        }),
        warning: warning(&search.measure),
    });
    Ok(table)
}

/// File name of the best trial's configuration.
const BEST: &str = "best.toml";

/// Returns the configuration of the best trial, with a comment that describes it.
pub(crate) fn best_config(
    folder: &SweepFolder,
    best: &SearchBest,
    table: &RunTable,
) -> Result<String, TrainerError> {
    let file = folder.path().join(format!("configs/{:04}.toml", best.number));
    let text = std::fs::read_to_string(&file).map_err(|error| TrainerError::Config {
        file: file.display().to_string(),
        problem: error.to_string(),
    })?;
    let measure = table.search.as_ref().map(|found| found.measure.as_str()).unwrap_or_default();
    let of = table.search.as_ref().map_or(0, |found| found.measured);
    let what = format!("# Trial {:04}, the best of {of}: {measure} = {}.", best.number, best.value);
    Ok(format!("{what}\n{text}"))
}

/// Returns the runs of a sweep as entries of another table; runs are named relative to the current folder.
pub(crate) fn entries(folder: &SweepFolder, manifest: &SweepManifest) -> Vec<Entry> {
    let place = |run: &str| folder.path().join(run).display().to_string();
    manifest.runs.iter().map(|line| entry(folder, manifest, line, &place)).collect()
}

/// Returns the name of a run in the table: its folder, or the name that its folder would have.
pub(crate) fn run_name(manifest: &SweepManifest, line: &SweepLine) -> String {
    line.run.clone().unwrap_or_else(|| label(manifest, line))
}

fn entry(
    folder: &SweepFolder,
    manifest: &SweepManifest,
    line: &SweepLine,
    place: &dyn Fn(&str) -> String,
) -> Entry {
    let name = place(&run_name(manifest, line));
    let row = |state, reason: &str| vec![RunTableRow::without_numbers(&name, state, reason)];
    let mut rows = match (line.state, &line.run) {
        (SweepState::Failed, _) => row(RunState::Failed, line.message.as_deref().unwrap_or_default()),
        (SweepState::Stopped, _) => row(RunState::Stopped, line.message.as_deref().unwrap_or_default()),
        (SweepState::Pending, _) | (_, None) => row(RunState::Pending, "not made yet"),
        (SweepState::Done | SweepState::Interrupted, Some(run)) => read_run(&folder.path().join(run)).rows,
    };
    for row in &mut rows {
        row.run.clone_from(&name);
        if line.state == SweepState::Done && row.state == RunState::Unfinished {
            // The sweep recorded a result, which has been removed since.
            (row.state, row.reason) = (RunState::Corrupt, "result.json is missing".to_owned());
        }
    }
    let text = std::fs::read_to_string(folder.path().join(&line.config)).unwrap_or_default();
    Entry { rows, config: Document::parse(&line.config, &text).ok() }
}

/// Returns the name of a run's folder: its number and the values that distinguish it. Values that all runs
/// share are left out.
pub(crate) fn label(manifest: &SweepManifest, line: &SweepLine) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
    let mut label = format!("{:04}", line.number);
    let varied = manifest.axes.iter().zip(&line.overrides).filter(|(axis, _)| axis.values.len() > 1);
    for (_, argument) in varied {
        let (key, value) = argument.split_once('=').unwrap_or((argument, ""));
        let short = key.rsplit('.').next().unwrap_or(key);
        let words: String = format!("{short}-{value}").chars().map(safe).collect();
        let words: Vec<&str> = words.split('-').filter(|word| !word.is_empty()).collect();
        label = format!("{label}-{}", words.join("-"));
    }
    label.chars().take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::label;
    use results::{SWEEP_SCHEMA, SweepAxis, SweepLine, SweepManifest, SweepState};

    #[test]
    fn a_label_is_a_file_name_that_tells_runs_apart() {
        let named = |overrides: &[(&str, usize)]| {
            let axis = |&(text, values): &(&str, usize)| SweepAxis {
                key: text.to_owned(),
                values: vec![String::new(); values],
                scale: None,
            };
            let line = SweepLine {
                number: 7,
                digest: String::new(),
                overrides: overrides.iter().map(|(text, _)| (*text).to_owned()).collect(),
                config: String::new(),
                state: SweepState::Pending,
                run: None,
                message: None,
            };
            let manifest = SweepManifest {
                schema: SWEEP_SCHEMA.into(),
                name: String::new(),
                config: String::new(),
                version: String::new(),
                axes: overrides.iter().map(axis).collect(),
                records: vec![],
                search: None,
                runs: vec![],
            };
            label(&manifest, &line)
        };
        assert_eq!(named(&[("estimator=pinn", 2), ("seed=3", 5)]), "0007-estimator-pinn-seed-3");
        assert_eq!(named(&[("estimator.hidden=[32, 16]", 2)]), "0007-hidden-32-16");
        assert_eq!(named(&[("data.path=../a/b c.csv", 2), ("fit.seeds=3", 1)]), "0007-path-..-a-b-c.csv");
        assert_eq!(named(&[]), "0007");
        assert_eq!(named(&[(&format!("name={}", "x".repeat(500)), 2)]).len(), 80);
    }
}
