//! Table of runs as CSV, as Markdown, as LaTeX, and as cells for a terminal.

use results::{LearnedScores, Reached, RunTable, RunTableRow};

use super::cells::{self, DATA_SET, setting};
use super::headline::{headline, reading};
use crate::comparison::markdown::{escape, grid};
use crate::figures::number;
use crate::latex;

/// Returns the table as CSV with a header. Numbers have all their digits; cells of missing numbers are empty.
#[must_use]
pub fn csv(table: &RunTable) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = ["run", "state", "task", "estimator"].into_iter();
    let header = header.chain(table.columns.iter().map(String::as_str)).chain([
        "zeta",
        "zeta_std_error",
        "zeta_low_95",
        "zeta_high_95",
        "decay_rate",
        "oracle_zeta",
        "error_percent",
        "worst_error_percent",
        "tolerance_percent",
        "reached",
        "steps",
        "parameters",
        "seconds",
        "pass",
        "origin",
        "reason",
    ]);
    let has_learned = table.rows.iter().any(|row| row.learned.is_some());
    let header = header.chain(LEARNED.into_iter().filter(|_| has_learned));
    // Writing to memory does not fail; if it did, the table would end early.
    let mut written = writer.write_record(header).is_ok();
    for row in &table.rows {
        let learned = learned(row.learned.as_ref()).into_iter().filter(|_| has_learned);
        written = written && writer.write_record(record(table, row).into_iter().chain(learned)).is_ok();
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// Titles of the last columns, if any row has a learner's scores.
const LEARNED: [&str; 7] =
    ["problem", "validation_over_noise", "test_over_noise", "test_rmse", "unit", "horizon_s", "coverage_95"];

/// Returns the cells of these columns.
fn learned(scores: Option<&LearnedScores>) -> [String; 7] {
    let text = |of: fn(&LearnedScores) -> &String| scores.map(of).cloned().unwrap_or_default();
    let float = |of: fn(&LearnedScores) -> Option<f64>| scores.and_then(of).map_or_else(String::new, number);
    [
        text(|of| &of.problem),
        float(|of| of.validation_over_noise),
        float(|of| of.test_over_noise),
        float(|of| of.test_rmse),
        text(|of| &of.unit),
        float(|of| of.horizon_s),
        float(|of| of.coverage_95),
    ]
}

fn record(table: &RunTable, row: &RunTableRow) -> Vec<String> {
    let float = |value: Option<f64>| value.map_or_else(String::new, number);
    let end = |at: usize| float(row.zeta_interval_95.and_then(|ends| ends.get(at).copied()));
    let mut cells =
        vec![row.run.clone(), row.state.name().to_owned(), row.task.clone(), row.estimator.clone()];
    cells.extend(table.columns.iter().map(|key| row.settings.get(key).map_or_else(String::new, setting)));
    cells.extend([float(row.zeta), float(row.zeta_std_error), end(0), end(1)]);
    cells.extend(
        [row.decay_rate, row.oracle_zeta, row.error_percent, row.worst_error_percent, row.tolerance_percent]
            .map(float),
    );
    cells.push(row.reached.map_or_else(String::new, |state| state.name().to_owned()));
    cells.push(row.steps.map_or_else(String::new, |steps| steps.to_string()));
    cells.push(row.parameters.map_or_else(String::new, |count| count.to_string()));
    cells.push(float(row.seconds));
    cells.push(row.pass.map_or_else(String::new, |pass| pass.to_string()));
    cells
        .extend([row.origin.map_or_else(String::new, |origin| origin.name().to_owned()), row.reason.clone()]);
    cells
}

/// Returns the rows with all their cells as text.
fn lines(table: &RunTable) -> Vec<Vec<String>> {
    let (columns, numbers) = (cells::columns(table).len(), cells::numbers(table));
    let line = |row| {
        let view = cells::row(table, &numbers, row);
        let mut line = vec![view.name, view.state.to_owned()];
        line.extend(view.settings);
        if view.numbers.is_empty() {
            line.push(view.reason);
            line.resize(columns, String::new());
        } else {
            line.extend(view.numbers);
        }
        line
    };
    table.rows.iter().map(line).collect()
}

/// Returns the name of a table.
fn name(table: &RunTable) -> &str {
    if table.name.is_empty() { "Runs side by side" } else { &table.name }
}

/// Returns the verdict and the table as GitHub Markdown.
#[must_use]
pub fn markdown(table: &RunTable) -> String {
    let verdict = headline(table);
    let columns = cells::columns(table);
    let titles: Vec<(&str, bool)> =
        columns.iter().map(|column| (column.title.as_str(), !column.words)).collect();
    let rows = lines(table).into_iter().zip(&table.rows).map(|(line, row)| {
        let mut line: Vec<String> = line.iter().map(|cell| escape(cell)).collect();
        if let Some(state) = line.get_mut(1).filter(|_| cells::is_bad(row)) {
            *state = format!("**{state}**");
        }
        line
    });
    let blocks = [
        format!("# {}", escape(name(table))),
        format!("**{}.** {}", verdict.label, escape(&verdict.sentence)),
        grid(&titles, rows),
        escape(&reading(table)),
    ];
    blocks.join("\n\n") + "\n"
}

/// Returns the table as LaTeX with the rules of booktabs.
#[must_use]
pub fn latex(table: &RunTable) -> String {
    let columns = cells::columns(table);
    let titles: Vec<(&str, bool)> =
        columns.iter().map(|column| (column.title.as_str(), !column.words)).collect();
    format!("{}\n{}", latex::PREAMBLE, latex::table(name(table), &titles, lines(table).into_iter()))
}

/// A column of the terminal: its title and its cells.
type Cell = (&'static str, fn(&RunTableRow) -> Option<String>);

const OF_ESTIMATES: [Cell; 5] = [
    ("ζ", |row| row.zeta.map(|zeta| format!("{zeta:.8}"))),
    ("±", |row| row.zeta_std_error.map(|error| format!("{error:.1e}"))),
    ("error %", |row| row.error_percent.map(|error| format!("{error:.1e}"))),
    ("worst %", |row| row.worst_error_percent.map(|error| format!("{error:.1e}"))),
    ("steps", |row| row.steps.map(|steps| steps.to_string())),
];
const OF_LEARNERS: [Cell; 5] = [
    (DATA_SET, |row| row.learned.as_ref().map(|of| of.problem.clone())),
    ("validation × noise", |row| {
        row.learned.as_ref()?.validation_over_noise.map(|error| format!("{error:.3}"))
    }),
    ("test × noise", |row| row.learned.as_ref()?.test_over_noise.map(|error| format!("{error:.3}"))),
    ("horizon s", |row| row.learned.as_ref()?.horizon_s.map(|time| format!("{time:.2}"))),
    ("numbers", |row| row.learned.as_ref().and(row.parameters).map(|number| number.to_string())),
];

/// Returns header and rows for a terminal, with fewer columns than the page. The last cell of a row that
/// needs attention is in capitals.
#[must_use]
pub fn text_cells(table: &RunTable) -> (Vec<String>, Vec<Vec<String>>) {
    let has_learned = table.rows.iter().any(|row| row.learned.is_some());
    let has_estimates = !has_learned || table.rows.iter().any(|row| row.zeta.is_some());
    let estimates = OF_ESTIMATES.iter().filter(|_| has_estimates);
    let learners = OF_LEARNERS.iter().filter(|_| has_learned);
    let learners = learners.filter(|(title, _)| *title != DATA_SET || cells::has_data_sets(table));
    let cells: Vec<&Cell> = estimates.chain(learners).collect();
    let mut header = vec!["run".to_owned(), "method".to_owned()];
    header.extend(table.columns.iter().map(|key| cells::short_key(table, key).to_owned()));
    header.extend(cells.iter().map(|(title, _)| (*title).to_owned()));
    header.extend(["s", "state"].map(str::to_owned));
    let numbers = cells::numbers(table);
    let rows = table.rows.iter().map(|row| {
        let view = cells::row(table, &numbers, row);
        let mut line = vec![view.name];
        line.extend(view.settings);
        if cells::has_numbers(row) {
            line.extend(cells.iter().map(|(_, cell)| cell(row).unwrap_or_else(|| "-".to_owned())));
            line.push(row.seconds.map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.3}")));
            let verdict = if row.pass == Some(false) { ", FAILS" } else { "" };
            line.push(format!("{}{verdict}", row.reached.map_or("-", Reached::in_words)));
        } else {
            line.extend(std::iter::repeat_n(String::new(), cells.len() + 1));
            line.push(format!("{}: {}", view.state, view.reason));
        }
        line
    });
    (header, rows.collect())
}
