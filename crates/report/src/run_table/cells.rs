//! Columns and cells of a table of runs.

use results::{RunState, RunTable, RunTableRow, RunTableTask};
use serde_json::Value;

use crate::figures::number;
use crate::format::{count, duration, interval, quantity, share, significant};

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
    /// A cell for each of the table's [`numbers`]; empty without an estimate.
    pub(super) numbers: Vec<String>,
    /// Reason for a missing estimate.
    pub(super) reason: String,
    pub(super) state: &'static str,
    /// Style-sheet class of the state's tag.
    pub(super) tone: &'static str,
    pub(super) is_bad: bool,
}

/// A column after the settings.
pub(super) struct Number {
    title: &'static str,
    cell: fn(&RunTableRow) -> Option<String>,
}

const DISTANCE: &str = "distance from reference, %";
const WORST: &str = "worst distance, %";
/// Title of the column that tells data sets apart.
pub(super) const DATA_SET: &str = "data set";

/// All columns after the settings: of estimates, of learners, of both.
const NUMBERS: [Number; 16] = [
    Number { title: "ζ", cell: |row| row.zeta.map(|zeta| significant(zeta, 8)) },
    Number { title: "± of ζ", cell: |row| row.zeta_std_error.map(|error| significant(error, 2)) },
    Number { title: "95 % interval", cell: |row| row.zeta_interval_95.map(interval) },
    Number { title: "reference ζ", cell: |row| row.oracle_zeta.map(|zeta| significant(zeta, 8)) },
    Number { title: DISTANCE, cell: |row| row.error_percent.map(gap) },
    Number { title: WORST, cell: |row| row.worst_error_percent.map(gap) },
    Number { title: DATA_SET, cell: |row| row.learned.as_ref().map(|of| of.problem.clone()) },
    Number {
        title: "validation error, × noise",
        cell: |row| row.learned.as_ref()?.validation_over_noise.map(|error| significant(error, 3)),
    },
    Number {
        title: "test error, × noise",
        cell: |row| row.learned.as_ref()?.test_over_noise.map(|error| significant(error, 3)),
    },
    Number {
        title: "test error",
        cell: |row| {
            let of = row.learned.as_ref()?;
            of.test_rmse.map(|error| quantity(&significant(error, 3), &of.unit))
        },
    },
    Number {
        title: "horizon",
        cell: |row| row.learned.as_ref()?.horizon_s.map(|time| quantity(&significant(time, 3), "s")),
    },
    Number { title: "in 95 % band", cell: |row| row.learned.as_ref()?.coverage_95.map(share) },
    Number { title: "reached", cell: |row| row.reached.map(|state| state.in_words().to_owned()) },
    Number { title: "steps", cell: |row| row.steps.map(count) },
    Number {
        title: "parameters",
        cell: |row| row.learned.as_ref().and(row.parameters).map(|number| count(number as u64)),
    },
    Number { title: "time", cell: |row| row.seconds.map(duration) },
];

/// Returns `true` if a row has an estimate or a learner's scores.
pub(super) fn has_numbers(row: &RunTableRow) -> bool {
    row.zeta.is_some() || row.learned.is_some()
}

/// Returns `true` if learners were scored on more than one data set.
pub(super) fn has_data_sets(table: &RunTable) -> bool {
    let sets = || table.rows.iter().filter_map(|row| row.learned.as_ref()).map(|of| of.problem.as_str());
    sets().any(|set| Some(set) != sets().next())
}

/// Returns the columns after the settings that tell something about any of the rows.
pub(super) fn numbers(table: &RunTable) -> Vec<&'static Number> {
    let rows = || table.rows.iter().filter(|row| has_numbers(row));
    let is_measure = table.search.as_ref().is_some_and(|search| search.measure == "error_percent");
    let tells = |number: &&Number| match number.title {
        // The column of a search's measure has it already.
        DISTANCE if is_measure => false,
        WORST => rows().any(|row| row.worst_error_percent != row.error_percent),
        DATA_SET => has_data_sets(table),
        _ => rows().any(|row| (number.cell)(row).is_some()),
    };
    let mut told: Vec<&Number> = NUMBERS.iter().filter(tells).collect();
    if told.is_empty() {
        // The reasons of rows without numbers need a column.
        told.extend(NUMBERS.first());
    }
    told
}

/// Returns `true` if a row needs attention.
pub(super) fn is_bad(row: &RunTableRow) -> bool {
    row.state.is_bad() || row.pass == Some(false)
}

/// Returns all columns, from left to right.
pub(super) fn columns(table: &RunTable) -> Vec<Column> {
    let words = |title: &str| Column { title: title.to_owned(), words: true };
    let mut columns = vec![words("run"), words("state"), words("method")];
    columns.extend(table.columns.iter().map(|key| words(short_key(table, key))));
    columns
        .extend(numbers(table).iter().map(|number| Column { title: number.title.to_owned(), words: false }));
    columns
}

pub(super) fn row(table: &RunTable, numbers: &[&Number], row: &RunTableRow) -> RowView {
    let absent = || "–".to_owned();
    let method = if row.estimator.is_empty() { absent() } else { row.estimator.clone() };
    let measure = table.search.as_ref().map(|search| &search.measure);
    let setting = |key: &String| match row.settings.get(key) {
        // A measure is a result, and needs no more digits than one.
        Some(value) if Some(key) == measure => {
            value.as_f64().map_or_else(absent, |value| significant(value, 6))
        }
        value => value.map_or_else(absent, shown),
    };
    let (state, tone) = state(row);
    let numbers: Vec<String> = match has_numbers(row) {
        true => numbers.iter().map(|number| (number.cell)(row).unwrap_or_else(absent)).collect(),
        false => Vec::new(),
    };
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
        is_bad: is_bad(row),
    }
}

/// Returns the last part of a key, or the whole key if another column ends in the same part.
pub(super) fn short_key<'a>(table: &RunTable, key: &'a str) -> &'a str {
    let last = |key: &'a str| key.rsplit('.').next().unwrap_or(key);
    let is_shared =
        table.columns.iter().any(|other| other != key && other.rsplit('.').next() == Some(last(key)));
    if is_shared { key } else { last(key) }
}

/// Formats a value of the configuration for reading: a number has as few characters as give the same number.
pub(super) fn shown(value: &Value) -> String {
    /// Longest number that is easier to read without a power of ten.
    const PLAIN: usize = 6;
    match value.as_f64().filter(|_| value.is_f64()) {
        Some(float) => {
            let (plain, power) = (number(float), format!("{float:e}"));
            if plain.len() > PLAIN && power.len() < plain.len() { power } else { plain }
        }
        None => setting(value),
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
        (RunState::Done, None) => ("done", "good"),
        (RunState::Done, Some(false)) => ("FAIL", "bad"),
        (state, _) => (state.name(), "caution"),
    }
}

#[cfg(test)]
mod tests {
    use super::{gap, shown};

    #[test]
    fn a_number_is_shown_as_short_as_it_is_exact() {
        let of = |value: f64| shown(&value.into());
        assert_eq!([1.0, 0.001, 123_456.0, 1e6].map(of), ["1", "0.001", "123456", "1e6"]);
        assert_eq!([123_456_789_012.0, 0.000_12].map(of), ["123456789012", "1.2e-4"]);
        assert_eq!([shown(&12.into()), shown(&"a".into())], ["12", "a"]);
    }

    #[test]
    fn an_exact_zero_is_one() {
        assert_eq!((gap(0.0).as_str(), gap(1.25e-7).as_str()), ("0", "1.2\u{a0}×\u{a0}10⁻⁷"));
    }
}
