//! The table of a sweep: what became of each run of the frozen list.

use crate::run_table::build::{Entry, build};
use results::{RunState, RunTable, RunTableRow, SweepLine, SweepManifest, SweepState};
use runs::{SweepFolder, read_run};
use settings::Document;

/// The table, in the order of the frozen list; runs are named from the sweep's folder.
pub(crate) fn table(folder: &SweepFolder, manifest: &SweepManifest) -> RunTable {
    let entry = |line| entry(folder, manifest, line, &|run| run.to_owned());
    let entries = manifest.runs.iter().map(entry).collect();
    build("sweep", &manifest.name, manifest.axes.clone(), entries)
}

/// The runs of a sweep as entries of another table; runs are named from the current folder.
pub(crate) fn entries(folder: &SweepFolder, manifest: &SweepManifest) -> Vec<Entry> {
    let place = |run: &str| folder.path().join(run).display().to_string();
    manifest.runs.iter().map(|line| entry(folder, manifest, line, &place)).collect()
}

/// What a row of this run is called: by its folder, or by what that would be called.
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
        (SweepState::Pending, _) | (_, None) => row(RunState::Pending, "not made yet"),
        (SweepState::Done | SweepState::Interrupted, Some(run)) => read_run(&folder.path().join(run)).rows,
    };
    for row in &mut rows {
        row.run.clone_from(&name);
        if line.state == SweepState::Done && row.state == RunState::Unfinished {
            // The sweep saw its result; somebody has taken it away since.
            (row.state, row.reason) = (RunState::Corrupt, "result.json is missing".to_owned());
        }
    }
    let text = std::fs::read_to_string(folder.path().join(&line.config)).unwrap_or_default();
    Entry { rows, config: Document::parse(&line.config, &text).ok() }
}

/// What a run's folder is called: its number and what is special about it. What all runs share is left out.
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
