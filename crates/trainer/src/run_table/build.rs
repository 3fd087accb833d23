//! Building of one table from runs: choice of columns and order of rows.

use crate::error::TableError;
use experiment::sweep::differing_keys;
use results::{RunTable, RunTableRow, RunTableTask, SweepAxis};
use serde_json::Value;
use settings::Document;
use std::cmp::Ordering;

/// Run to be added to a table.
pub(crate) struct Entry {
    /// Rows of the run, without settings.
    pub(crate) rows: Vec<RunTableRow>,
    /// Configuration of the run, if known.
    pub(crate) config: Option<Document>,
}

/// Columns that every table has, with the names that `--sort` takes.
const COLUMNS: [&str; 8] = ["run", "method", "zeta", "error", "worst", "steps", "seconds", "state"];

/// Combines runs into one table. Its columns are the keys that a sweep varies, and every other key in which
/// the runs differ.
pub(crate) fn build(task: RunTableTask, name: &str, axes: Vec<SweepAxis>, entries: Vec<Entry>) -> RunTable {
    let configs: Vec<&Document> = entries.iter().filter_map(|entry| entry.config.as_ref()).collect();
    let varied = axes.iter().filter(|axis| axis.values.len() > 1).map(|axis| axis.key.clone());
    let mut columns: Vec<String> = varied.collect();
    for key in differing_keys(&configs) {
        if !columns.contains(&key) {
            columns.push(key);
        }
    }
    // Estimators and learners have a column of their own.
    columns.retain(|key| !["estimator", "estimator.name", "learn.learners"].contains(&key.as_str()));
    let mut rows = Vec::new();
    for entry in entries {
        let value = |key: &String| {
            let leaf = entry.config.as_ref()?.get(key)?;
            Some((key.clone(), serde_json::to_value(&leaf.value).unwrap_or(Value::Null)))
        };
        let settings: serde_json::Map<String, Value> = columns.iter().filter_map(value).collect();
        let named = entry.config.as_ref().and_then(|config| config.get("estimator.name")?.value.as_str());
        rows.extend(entry.rows.into_iter().map(|mut row| {
            row.settings.clone_from(&settings);
            if row.estimator.is_empty() {
                row.estimator = named.unwrap_or_default().to_owned();
            }
            row
        }));
    }
    RunTable::new(task, name, axes, columns, rows)
}

/// Sorts the rows by a column; rows without a value there come last in either direction.
pub(crate) fn sort(table: &mut RunTable, key: &str, reverse: bool) -> Result<(), TableError> {
    if !COLUMNS.contains(&key) && !table.columns.iter().any(|column| column == key) {
        let known: Vec<&str> = COLUMNS.into_iter().chain(table.columns.iter().map(String::as_str)).collect();
        return Err(TableError::NoColumn { key: key.to_owned(), known: known.join(", ") });
    }
    table.rows.sort_by(|one, other| match (cell(one, key), cell(other, key)) {
        (Some(one), Some(other)) => {
            let order = compare(&one, &other);
            if reverse { order.reverse() } else { order }
        }
        (one, other) => other.is_some().cmp(&one.is_some()),
    });
    Ok(())
}

fn cell(row: &RunTableRow, key: &str) -> Option<Value> {
    let number = |value: Option<f64>| value.filter(|value| value.is_finite()).map(Value::from);
    match key {
        "run" => Some(row.run.as_str().into()),
        "method" => (!row.estimator.is_empty()).then(|| row.estimator.as_str().into()),
        "zeta" => number(row.zeta),
        "error" => number(row.error_percent),
        "worst" => number(row.worst_error_percent),
        "steps" => row.steps.map(Value::from),
        "seconds" => number(row.seconds),
        "state" => Some(row.state.name().into()),
        key => row.settings.get(key).cloned(),
    }
}

/// Compares numbers by size and other values by their text; numbers come first.
fn compare(one: &Value, other: &Value) -> Ordering {
    match (one.as_f64(), other.as_f64()) {
        (Some(one), Some(other)) => one.total_cmp(&other),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => one.to_string().cmp(&other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::{Entry, build, sort};
    use results::{RunState, RunTable, RunTableRow, RunTableTask};
    use settings::Document;

    fn entry(run: &str, config: &str, error: Option<f64>) -> Entry {
        let row =
            RunTableRow { error_percent: error, ..RunTableRow::without_numbers(run, RunState::Done, "") };
        Entry { rows: vec![row], config: Document::parse("a.toml", config).ok() }
    }

    fn table() -> RunTable {
        let entries = vec![
            entry("a", "seed = 10\n[estimator]\nname = 'pinn'\n", Some(2.0)),
            entry("b", "seed = 9\n[estimator]\nname = 'lstm'\n", Some(0.5)),
            Entry { rows: vec![RunTableRow::without_numbers("c", RunState::Corrupt, "x")], config: None },
            entry("d", "seed = 11\n[estimator]\nname = 'ols'\n", Some(f64::NAN)),
        ];
        build(RunTableTask::Runs, "", vec![], entries)
    }

    fn order(key: &str, reverse: bool) -> String {
        let mut table = table();
        sort(&mut table, key, reverse).unwrap();
        table.rows.iter().map(|row| row.run.as_str()).collect()
    }

    #[test]
    fn columns_are_what_differs() {
        let table = table();
        assert_eq!(table.columns, ["seed"]);
        assert_eq!(table.rows[0].settings["seed"], 10);
        assert_eq!((table.rows[1].estimator.as_str(), table.failed), ("lstm", 1));
    }

    #[test]
    fn rows_are_sorted_by_size_and_those_without_a_value_come_last() {
        assert_eq!(order("error", false), "bacd");
        assert_eq!(order("error", true), "abcd");
        // Ten is more than nine.
        assert_eq!(order("seed", false), "badc");
        assert_eq!(order("method", true), "adbc");
        assert_eq!(order("run", true), "dcba");
    }

    #[test]
    fn an_unknown_column_is_named_with_those_there_are() {
        let refused = sort(&mut table(), "eror", false).unwrap_err().to_string();
        assert!(refused.starts_with("--sort eror: no such column") && refused.ends_with("seed"), "{refused}");
    }
}
