//! Results of a sweep, and the table of its runs.

use super::method::Reached;
use super::{RESULT_SCHEMA, SearchOutcome, SweepSearch};
use record::Origin;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// The `schema` field of a sweep's manifest.
pub const SWEEP_SCHEMA: &str = "ringdown.sweep/1";

/// The content of `sweep.json`: the plan frozen before the first run, and the state of each run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepManifest {
    /// Always [`SWEEP_SCHEMA`].
    pub schema: String,
    /// First part of the sweep folder's name.
    pub name: String,
    /// Path of the base configuration of all combinations, as given by the user.
    pub config: String,
    /// Version of the program that froze the sweep.
    pub version: String,
    /// Varied keys; the first axis varies slowest.
    pub axes: Vec<SweepAxis>,
    /// Records that the runs read, with their digests at the time the sweep was frozen.
    pub records: Vec<SweepRecord>,
    /// Settings of the search, if the sweep searches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SweepSearch>,
    /// One line for each run, in the order of the combinations; for a search with `"tpe"`, the runs proposed
    /// so far.
    pub runs: Vec<SweepLine>,
}

/// A varied key and its values.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepAxis {
    /// The dotted key.
    pub key: String,
    /// The values, in the notation of overrides; with a scale, the two ends of a range.
    pub values: Vec<String>,
    /// `"linear"` or `"log"` if numbers are drawn from a range; absent if `values` lists all values.
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
    /// SHA-256 of all values in force: the run's identity.
    pub digest: String,
    /// Overrides of the configuration, as `key=value`.
    pub overrides: Vec<String>,
    /// Path of the frozen configuration, relative to the sweep's folder.
    pub config: String,
    /// State of the run. `sweep.json` is rewritten only now and then; the files in `state/` are up to date
    /// first.
    pub state: SweepState,
    /// Folder of the run, relative to the sweep's folder; `None` before the run began, or if it failed before
    /// it had a folder.
    pub run: Option<String>,
    /// Reason of the failure, or of an early stop.
    pub message: Option<String>,
}

/// State of a run of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SweepState {
    /// Not finished, and perhaps not begun.
    Pending,
    /// Finished with a result.
    Done,
    /// Ended without a result.
    Failed,
    /// Stopped on request; its results so far are kept, and the run will be repeated.
    Interrupted,
    /// Stopped early by a search because other runs were better; it will not be continued.
    Stopped,
}

impl SweepState {
    /// Returns the name used in `sweep.json`.
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

/// The content of a file in a sweep's `state/`: the end of one run.
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

/// Origin of the runs in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunTableTask {
    /// The runs of a sweep.
    Sweep,
    /// Runs named by hand.
    Runs,
}

/// A table of runs: `result.json` of a sweep (`task = "sweep"`) and the output of `trainer compare` (`task =
/// "runs"`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunTable {
    /// Always [`RESULT_SCHEMA`].
    pub schema: String,
    /// Origin of the runs.
    pub task: RunTableTask,
    /// Name of the sweep; empty for runs named by hand.
    pub name: String,
    /// Keys that the sweep varies.
    pub axes: Vec<SweepAxis>,
    /// Configuration keys in which the runs differ, in the order of their columns; for a search, its measure
    /// comes last.
    pub columns: Vec<String>,
    /// Result of the search, if the sweep searches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchOutcome>,
    /// One row for each run; for a comparison of methods, one row for each method; for a learning study, one
    /// row for each learner and data set.
    pub rows: Vec<RunTableRow>,
    /// Number of runs with a result.
    pub done: usize,
    /// Number of runs that failed or whose folders cannot be read.
    pub failed: usize,
    /// Number of runs without a result that may still get one: pending, interrupted or unfinished.
    pub open: usize,
    /// `true` if no run failed and every result is within its stated tolerance.
    pub pass: bool,
}

/// State of a run in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    /// Finished with a result.
    Done,
    /// Stopped on request; its results so far are kept.
    Interrupted,
    /// Stopped early by a search because other runs were better.
    Stopped,
    /// Ended without a result and gave a reason.
    Failed,
    /// Has no result yet: it is running, or ended before it had one.
    Unfinished,
    /// Not begun.
    Pending,
    /// Its folder cannot be read as a run.
    Corrupt,
}

impl RunState {
    /// Returns the name used in tables and JSON.
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

    /// Returns `true` if the user must look into this run.
    #[must_use]
    pub fn is_bad(self) -> bool {
        matches!(self, Self::Failed | Self::Corrupt)
    }
}

/// One row of a table of runs. Numbers that a run does not have are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunTableRow {
    /// Folder of the run; for a run of a sweep, relative to the sweep's folder.
    pub run: String,
    /// State of the run.
    pub state: RunState,
    /// Reason for a missing estimate; empty if there is one.
    pub reason: String,
    /// Task of the run, such as `"estimate"`; empty if unknown.
    pub task: String,
    /// Identifier of the method; empty if there is none or there are many.
    pub estimator: String,
    /// Values of the keys in [`RunTable::columns`], as far as the run has them.
    pub settings: Map<String, Value>,
    /// Origin of the record; `None` if unknown.
    pub origin: Option<Origin>,
    /// Damping ratio ζ, defined as in [`OracleSummary::zeta`](crate::OracleSummary::zeta).
    pub zeta: Option<f64>,
    /// Standard error of ζ, if the method states one.
    pub zeta_std_error: Option<f64>,
    /// 95 % interval of ζ, if the method states one.
    pub zeta_interval_95: Option<[f64; 2]>,
    /// Decay rate λ, in 1/s.
    pub decay_rate: Option<f64>,
    /// ζ by closed-form least squares on the same envelope.
    pub oracle_zeta: Option<f64>,
    /// Oracle gap: |ζ − ζ_oracle| / |ζ_oracle| · 100.
    pub error_percent: Option<f64>,
    /// Largest oracle gap over the seeds of the run, in percent.
    pub worst_error_percent: Option<f64>,
    /// Largest oracle gap that passes, in percent.
    pub tolerance_percent: Option<f64>,
    /// State in which the first seed's fit ended; `None` without an estimate.
    pub reached: Option<Reached>,
    /// Number of training steps of the first seed's fit.
    pub steps: Option<u64>,
    /// Number of trained parameters.
    pub parameters: Option<usize>,
    /// Wall time of a fit, in seconds.
    pub seconds: Option<f64>,
    /// `true` if every seed is within the tolerance.
    pub pass: Option<bool>,
    /// Scores of a learner of dynamics; absent in rows of other tasks, and if it learned nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub learned: Option<LearnedScores>,
}

/// Scores of one learner on one data set of a learning study. Errors that are not finite are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnedScores {
    /// Name of the data set in the configuration.
    pub problem: String,
    /// Root mean square error of free runs over the sensor noise, on the validation part.
    pub validation_over_noise: Option<f64>,
    /// The same on the test part, which no choice may depend on.
    pub test_over_noise: Option<f64>,
    /// Root mean square error of free runs on the test part.
    pub test_rmse: Option<f64>,
    /// Unit of that error.
    pub unit: String,
    /// Median time until the error on the test part exceeds three times the noise, in seconds.
    pub horizon_s: Option<f64>,
    /// Share of the test part's observations inside the stated 95 % band.
    pub coverage_95: Option<f64>,
}

impl RunTableRow {
    /// Creates a row without numbers.
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
            learned: None,
        }
    }
}

impl RunTable {
    /// Creates a table and counts its runs. Rows of the same run must be adjacent.
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
