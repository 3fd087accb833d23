//! Table of runs as CSV, as Markdown, and as cells for a terminal.

use results::{Reached, RunTable, RunTableRow};

use super::cells::{self, setting};
use super::headline::{READING, headline};
use crate::comparison::markdown::{escape, grid};
use crate::figures::number;

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
    // Writing to memory does not fail; if it did, the table would end early.
    let mut written = writer.write_record(header).is_ok();
    for row in &table.rows {
        written = written && writer.write_record(record(table, row)).is_ok();
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
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

/// Returns the verdict and the table as GitHub Markdown.
#[must_use]
pub fn markdown(table: &RunTable) -> String {
    let verdict = headline(table);
    let columns = cells::columns(table);
    let titles: Vec<(&str, bool)> =
        columns.iter().map(|column| (column.title.as_str(), !column.words)).collect();
    let rows = table.rows.iter().map(|row| {
        let view = cells::row(table, row);
        let state = if view.is_bad { format!("**{}**", view.state) } else { view.state.to_owned() };
        let mut line = vec![escape(&view.name), state];
        line.extend(view.settings.iter().map(|cell| escape(cell)));
        if view.numbers.is_empty() {
            line.push(escape(&view.reason));
            line.resize(columns.len(), String::new());
        } else {
            line.extend(view.numbers.iter().map(|cell| escape(cell)));
        }
        line
    });
    let name = if table.name.is_empty() { "Runs side by side" } else { &table.name };
    let blocks = [
        format!("# {}", escape(name)),
        format!("**{}.** {}", verdict.label, escape(&verdict.sentence)),
        grid(&titles, rows),
        escape(READING),
    ];
    blocks.join("\n\n") + "\n"
}

/// Returns header and rows for a terminal, with fewer columns than the page. The last cell of a row that
/// needs attention is in capitals.
#[must_use]
pub fn text_cells(table: &RunTable) -> (Vec<String>, Vec<Vec<String>>) {
    let short = |key: &String| key.rsplit('.').next().unwrap_or(key).to_owned();
    let mut header = vec!["run".to_owned(), "method".to_owned()];
    header.extend(table.columns.iter().map(short));
    header.extend(["ζ", "±", "error %", "worst %", "steps", "s", "state"].map(str::to_owned));
    let rows = table.rows.iter().map(|row| {
        let view = cells::row(table, row);
        let mut line = vec![view.name];
        line.extend(view.settings);
        match row.zeta {
            Some(zeta) => {
                let float =
                    |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.1e}"));
                line.push(format!("{zeta:.8}"));
                line.extend([row.zeta_std_error, row.error_percent, row.worst_error_percent].map(float));
                line.push(row.steps.map_or_else(|| "-".to_owned(), |steps| steps.to_string()));
                line.push(row.seconds.map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.3}")));
                let verdict = if row.pass == Some(false) { ", FAILS" } else { "" };
                let state = row.reached.map_or("-", Reached::in_words);
                line.push(format!("{state}{verdict}"));
            }
            None => {
                line.extend(std::iter::repeat_n(String::new(), 6));
                line.push(format!("{}: {}", view.state, view.reason));
            }
        }
        line
    });
    (header, rows.collect())
}
