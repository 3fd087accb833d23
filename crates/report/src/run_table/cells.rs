//! Columns and cells of a table of runs.

use results::{RunState, RunTable, RunTableRow, RunTableTask};
use serde_json::Value;

use crate::format::{count, duration, interval, significant};

/// A column of the table.
pub(super) struct Column {
    pub(super) title: String,
    /// `true` if the column holds words, which are aligned to the left.
    pub(super) words: bool,
}

/// A row of the table.
pub(super) struct RowView {
    pub(super) name: String,
    /// The method, followed by a cell for each key in which the runs differ.
    pub(super) settings: Vec<String>,
    /// A cell for each of [`NUMBERS`]; empty without an estimate.
    pub(super) numbers: Vec<String>,
    /// Reason for a missing estimate.
    pub(super) reason: String,
    pub(super) state: &'static str,
    /// Style-sheet class of the state's tag.
    pub(super) tone: &'static str,
    pub(super) is_bad: bool,
}

/// Titles of the columns after the settings.
pub(super) const NUMBERS: [&str; 9] = [
    "ζ",
    "± of ζ",
    "95 % interval",
    "reference ζ",
    "distance from reference, %",
    "worst distance, %",
    "reached",
    "steps",
    "time",
];

/// Returns all columns, from left to right.
pub(super) fn columns(table: &RunTable) -> Vec<Column> {
    let words = |title: &str| Column { title: title.to_owned(), words: true };
    let mut columns = vec![words("run"), words("state"), words("method")];
    columns.extend(table.columns.iter().map(|key| words(key)));
    columns.extend(NUMBERS.iter().map(|title| Column { title: (*title).to_owned(), words: false }));
    columns
}

pub(super) fn row(table: &RunTable, row: &RunTableRow) -> RowView {
    let absent = || "–".to_owned();
    let method = if row.estimator.is_empty() { absent() } else { row.estimator.clone() };
    let setting = |key: &String| row.settings.get(key).map_or_else(absent, setting);
    let (state, tone) = state(row);
    let numbers = row.zeta.map_or_else(Vec::new, |zeta| {
        let or_absent = |text: Option<String>| text.unwrap_or_else(absent);
        vec![
            significant(zeta, 8),
            or_absent(row.zeta_std_error.map(|error| significant(error, 2))),
            or_absent(row.zeta_interval_95.map(interval)),
            or_absent(row.oracle_zeta.map(|zeta| significant(zeta, 8))),
            or_absent(row.error_percent.map(gap)),
            or_absent(row.worst_error_percent.map(gap)),
            or_absent(row.reached.map(|state| state.in_words().to_owned())),
            or_absent(row.steps.map(count)),
            or_absent(row.seconds.map(duration)),
        ]
    });
    let no_estimate = || format!("the task \"{}\" has no estimate", row.task);
    RowView {
        name: short_name(table, &row.run),
        settings: std::iter::once(method).chain(table.columns.iter().map(setting)).collect(),
        reason: match (numbers.is_empty(), row.reason.is_empty()) {
            (true, true) => no_estimate(),
            _ => row.reason.clone(),
        },
        numbers,
        state,
        tone,
        is_bad: row.state.is_bad() || row.pass == Some(false),
    }
}

/// Returns the name of a run in its row: its number in a sweep, else its folder.
pub(super) fn short_name(table: &RunTable, run: &str) -> String {
    let last = run.trim_end_matches('/').rsplit('/').next().unwrap_or(run);
    let number = last.split('-').next().unwrap_or(last);
    let is_number =
        table.task == RunTableTask::Sweep && !number.is_empty() && number.chars().all(|c| c.is_ascii_digit());
    if is_number { number } else { last }.to_owned()
}

/// Formats a value of the configuration; text has no quotes.
pub(super) fn setting(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Formats an error in percent, without the percent sign; an exact zero as `0`.
fn gap(percent: f64) -> String {
    if percent == 0.0 { "0".to_owned() } else { significant(percent, 2) }
}

/// Returns the name of a run's state, and its style-sheet class.
fn state(row: &RunTableRow) -> (&'static str, &'static str) {
    match (row.state, row.pass) {
        (RunState::Failed, _) => ("FAILED", "bad"),
        (RunState::Corrupt, _) => ("CORRUPT", "bad"),
        (RunState::Done, Some(true)) => ("pass", "good"),
        (RunState::Done, Some(false)) => ("FAIL", "bad"),
        (state, _) => (state.name(), "caution"),
    }
}

#[cfg(test)]
mod tests {
    use super::gap;

    #[test]
    fn an_exact_zero_is_one() {
        assert_eq!((gap(0.0).as_str(), gap(1.25e-7).as_str()), ("0", "1.2\u{a0}×\u{a0}10⁻⁷"));
    }
}
