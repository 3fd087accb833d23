//! The table of a sweep: what became of each run of the frozen list.

use super::execute::label;
use crate::side_by_side::{Entry, build};
use runs::result::{RunState, RunTable, RunTableRow, SweepLine, SweepManifest, SweepState};
use runs::{SweepFolder, read_run};
use settings::Document;

/// The table, in the order of the frozen list; runs are named from the sweep's folder.
pub(super) fn table(folder: &SweepFolder, manifest: &SweepManifest) -> RunTable {
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
pub(super) fn run_name(manifest: &SweepManifest, line: &SweepLine) -> String {
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
