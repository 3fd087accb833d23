//! A sweep and the table of its runs.

use super::method::Reached;
use super::{RESULT_SCHEMA, SearchOutcome, SweepSearch};
use record::Origin;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// The `schema` field of a sweep's manifest.
pub const SWEEP_SCHEMA: &str = "ringdown.sweep/1";

/// The content of `sweep.json`: what was frozen before the first run, and what became of each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepManifest {
    /// Always [`SWEEP_SCHEMA`].
    pub schema: String,
    /// Start of the sweep folder's name.
    pub name: String,
    /// The configuration that every combination starts from, as it was named.
    pub config: String,
    /// Version of the program that froze it.
    pub version: String,
    /// Keys that are varied; the first axis varies slowest.
    pub axes: Vec<SweepAxis>,
    /// The records that the runs read, with their digests when the sweep was frozen.
    pub records: Vec<SweepRecord>,
    /// Choice of points and the measure that they are judged by, where the sweep searches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SweepSearch>,
    /// One line for each run, in the order of the combinations; of a search with `"tpe"`, those proposed so far.
    pub runs: Vec<SweepLine>,
}

/// A key and its values.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepAxis {
    /// The dotted key.
    pub key: String,
    /// The values, as overrides write them; with a scale, the ends of a range.
    pub values: Vec<String>,
    /// `"linear"` or `"log"`: numbers are drawn from a range; absent where the values are all there are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<String>,
}

/// A record file that a sweep reads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepRecord {
    /// The path as configured.
    pub path: String,
    /// SHA-256 of the file's bytes, `sha256:` and 64 hexadecimal digits.
    pub digest: String,
}

/// One run of a sweep.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepLine {
    /// Position in the list, from 1.
    pub number: usize,
    /// SHA-256 of every value in force: the run's identity.
    pub digest: String,
    /// Overrides of the configuration, as `key=value`.
    pub overrides: Vec<String>,
    /// The frozen configuration, from the sweep's folder.
    pub config: String,
    /// State of the run. `sweep.json` is written again now and then; the files in `state/` are first to know.
    pub state: SweepState,
    /// The run's folder, from the sweep's; none before it began, or where it failed before it had one.
    pub run: Option<String>,
    /// Reason of a failure, or of having been stopped.
    pub message: Option<String>,
}

/// State of a run of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SweepState {
    /// Not finished, perhaps not begun.
    Pending,
    /// It has a result.
    Done,
    /// It gave none.
    Failed,
    /// Stopped on request; what it had is kept, and the run is made again.
    Interrupted,
    /// Stopped early by a search, since others were better; it is not gone on with.
    Stopped,
}

impl SweepState {
    /// Returns the name as `sweep.json` writes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pending => "pending",
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
            Self::Stopped => "stopped",
        }
    }
}

/// The content of one file in a sweep's `state/`: a run that came to its end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepEnd {
    /// Digest of the run's values, as [`SweepLine::digest`].
    pub digest: String,
    /// State of the run, as [`SweepLine::state`]; never pending.
    pub state: SweepState,
    /// Folder of the run, as [`SweepLine::run`].
    pub run: Option<String>,
    /// Reason of a failure, as [`SweepLine::message`].
    pub message: Option<String>,
}

/// What put the runs of a table together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunTableTask {
    /// A sweep made them.
    Sweep,
    /// They were named by hand.
    Runs,
}

/// A table of runs: `result.json` of a sweep (`task = "sweep"`) and what `trainer compare` says (`task = "runs"`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunTable {
    /// Always [`RESULT_SCHEMA`].
    pub schema: String,
    /// What put its runs together.
    pub task: RunTableTask,
    /// Name of the sweep; empty for runs that were put together by hand.
    pub name: String,
    /// Keys that a sweep varies.
    pub axes: Vec<SweepAxis>,
    /// The configuration keys in which the runs differ, in the order of their columns; of a search, its measure last.
    pub columns: Vec<String>,
    /// Result of the search, where the sweep searches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchOutcome>,
    /// One row for each run; of a comparison of methods one for each method.
    pub rows: Vec<RunTableRow>,
    /// Runs with a result.
    pub done: usize,
    /// Runs that failed or whose folders cannot be read.
    pub failed: usize,
    /// Runs without a result that may still get one: pending, interrupted, unfinished.
    pub open: usize,
    /// True if no run failed and every result is within its stated tolerance.
    pub pass: bool,
}

/// State of a run in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    /// It has a result.
    Done,
    /// Stopped on request; what it had is kept.
    Interrupted,
    /// Stopped early by a search, since others were better.
    Stopped,
    /// It ended without a result and said why.
    Failed,
    /// No result yet: it runs, or ended before it had one.
    Unfinished,
    /// Not begun.
    Pending,
    /// The folder cannot be read as a run.
    Corrupt,
}

impl RunState {
    /// Returns the name as tables and JSON write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Interrupted => "interrupted",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
            Self::Unfinished => "unfinished",
            Self::Pending => "pending",
            Self::Corrupt => "corrupt",
        }
    }

    /// Returns whether a reader has to look after it.
    #[must_use]
    pub fn is_bad(self) -> bool {
        matches!(self, Self::Failed | Self::Corrupt)
    }
}

/// One row of a table of runs. Numbers that a run does not have are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunTableRow {
    /// The run's folder; of a sweep's, from the sweep's folder.
    pub run: String,
    /// State of the run.
    pub state: RunState,
    /// Why there is no estimate; empty where there is one.
    pub reason: String,
    /// Task that was asked for, such as `"estimate"`; empty where that is not known.
    pub task: String,
    /// Identifier of the method; empty where there is none or many.
    pub estimator: String,
    /// The values of [`RunTable::columns`] that the run has.
    pub settings: Map<String, Value>,
    /// Where the record came from; `None` where that is not known.
    pub origin: Option<Origin>,
    /// λ/ω.
    pub zeta: Option<f64>,
    /// Standard error of ζ, where the method states one.
    pub zeta_std_error: Option<f64>,
    /// 95 % interval of ζ, where the method states one.
    pub zeta_interval_95: Option<[f64; 2]>,
    /// λ, in 1/s.
    pub decay_rate: Option<f64>,
    /// λ/ω by closed-form least squares on the same envelope.
    pub oracle_zeta: Option<f64>,
    /// The oracle gap: |ζ − ζ_oracle| / ζ_oracle · 100.
    pub error_percent: Option<f64>,
    /// The largest over the seeds of the run.
    pub worst_error_percent: Option<f64>,
    /// The largest that passes.
    pub tolerance_percent: Option<f64>,
    /// State in which the first seed's fit ended; `None` without an estimate.
    pub reached: Option<Reached>,
    /// Steps of the first seed's fit.
    pub steps: Option<u64>,
    /// Number of trained parameters.
    pub parameters: Option<usize>,
    /// Wall time of a fit, in seconds.
    pub seconds: Option<f64>,
    /// True if every seed is within the tolerance.
    pub pass: Option<bool>,
}

impl RunTableRow {
    /// A row without numbers.
    #[must_use]
    pub fn without_numbers(run: &str, state: RunState, reason: &str) -> Self {
        Self {
            run: run.to_owned(),
            state,
            reason: reason.to_owned(),
            task: String::new(),
            estimator: String::new(),
            settings: Map::new(),
            origin: None,
            zeta: None,
            zeta_std_error: None,
            zeta_interval_95: None,
            decay_rate: None,
            oracle_zeta: None,
            error_percent: None,
            worst_error_percent: None,
            tolerance_percent: None,
            reached: None,
            steps: None,
            parameters: None,
            seconds: None,
            pass: None,
        }
    }
}

impl RunTable {
    /// A table of rows, counted. `rows` of one run stand together.
    #[must_use]
    pub fn new(
        task: RunTableTask,
        name: &str,
        axes: Vec<SweepAxis>,
        columns: Vec<String>,
        rows: Vec<RunTableRow>,
    ) -> Self {
        let count = |of: &dyn Fn(RunState) -> bool| {
            let mut runs: Vec<&str> =
                rows.iter().filter(|row| of(row.state)).map(|row| row.run.as_str()).collect();
            runs.dedup();
            runs.len()
        };
        let (done, failed) = (count(&|state| state == RunState::Done), count(&RunState::is_bad));
        let is_closed = |state: RunState| matches!(state, RunState::Done | RunState::Stopped);
        let open = count(&|state| !is_closed(state) && !state.is_bad());
        let pass = rows.iter().all(|row| !row.state.is_bad() && row.pass != Some(false));
        Self {
            schema: RESULT_SCHEMA.to_owned(),
            task,
            name: name.to_owned(),
            axes,
            columns,
            search: None,
            rows,
            done,
            failed,
            open,
            pass,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{RunState, RunTable, RunTableRow, RunTableTask, SweepState};
    use serde_json::to_value;

    const STATES: [RunState; 7] = [
        RunState::Done,
        RunState::Interrupted,
        RunState::Stopped,
        RunState::Failed,
        RunState::Unfinished,
        RunState::Pending,
        RunState::Corrupt,
    ];

    #[test]
    fn a_state_is_called_what_the_files_call_it() {
        for state in STATES {
            assert_eq!(to_value(state).unwrap(), state.name());
        }
        let sweeps = [
            SweepState::Pending,
            SweepState::Done,
            SweepState::Failed,
            SweepState::Interrupted,
            SweepState::Stopped,
        ];
        for state in sweeps {
            assert_eq!(to_value(state).unwrap(), state.name());
        }
    }

    #[test]
    fn a_run_is_counted_once_whatever_its_rows() {
        let row = |run: &str, state| RunTableRow::without_numbers(run, state, "");
        let each = STATES.map(|state| row(state.name(), state));
        let rows =
            [&each[..], &[row("two methods", RunState::Done), row("two methods", RunState::Done)]].concat();
        let table = RunTable::new(RunTableTask::Runs, "", vec![], vec![], rows);
        assert_eq!((table.done, table.failed, table.open), (2, 2, 3));
        assert!(!table.pass);
        let pass = |row: RunTableRow| RunTable::new(RunTableTask::Runs, "", vec![], vec![], vec![row]).pass;
        let done = row("a", RunState::Done);
        assert!(pass(done.clone()) && pass(RunTableRow { pass: Some(true), ..done.clone() }));
        assert!(!pass(RunTableRow { pass: Some(false), ..done }) && !pass(row("a", RunState::Corrupt)));
    }
}
