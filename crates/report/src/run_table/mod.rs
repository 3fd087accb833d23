//! Page of many runs: those of a sweep, or runs put side by side.

mod cells;
mod figures;
mod headline;
mod swept;
#[cfg(test)]
mod tests;
mod text;

use askama::Template;
use results::{RunState, RunTable, RunTableTask, SweepAxis};

use crate::figures::Figure;
use crate::frame::{Frame, finish};
use crate::verdict::{self, Origin};
use crate::{ReportError, RunTexts};
use cells::{Column, RowView};
use headline::{headline, reading, whole};

pub use text::{csv, latex, markdown, text_cells};

/// Largest number of rows on the page; `table.csv` has all rows.
const MOST_ROWS: usize = 2_000;
/// Largest size of a result that the page contains in full, in bytes.
const MOST_TEXT: usize = 300_000;

#[derive(Template)]
#[template(path = "run_table.html")]
struct RunTablePage<'a> {
    frame: Frame<'a>,
    axes: &'a [SweepAxis],
    figures: Vec<Figure>,
    reading: String,
    shortened: String,
    columns: Vec<Column>,
    /// Number of columns with numbers.
    numbers: usize,
    rows: Vec<RowView>,
}

pub(crate) fn render(texts: &RunTexts<'_>, table: &RunTable) -> Result<String, ReportError> {
    let shown = table.rows.len().min(MOST_ROWS);
    let result = if texts.result.len() > MOST_TEXT {
        "Too long for this page; the file stands beside it."
    } else {
        texts.result
    };
    let numbers = cells::numbers(table);
    let page = RunTablePage {
        frame: Frame {
            warnings: warnings(table),
            files: [
                ("Configuration that every run starts from (config.toml)", texts.config),
                ("Environment (environment.json)", texts.environment),
                ("Every number, unrounded (result.json)", result),
            ],
            ..Frame::bare(
                texts,
                match table.task {
                    RunTableTask::Sweep => "a sweep",
                    RunTableTask::Runs => "runs side by side",
                },
                headline(table),
                origin(table),
            )
        },
        axes: &table.axes,
        figures: swept::figures(table).into_iter().chain(figures::figures(table)).collect(),
        reading: reading(table),
        shortened: if shown < table.rows.len() {
            format!("The first {shown} of {} rows; table.csv has all.", table.rows.len())
        } else {
            String::new()
        },
        columns: cells::columns(table),
        rows: table.rows.iter().take(shown).map(|row| cells::row(table, &numbers, row)).collect(),
        numbers: numbers.len(),
    };
    finish(&page)
}

/// Returns the origin of the record, if all runs share it.
fn origin(table: &RunTable) -> Origin {
    let stated = table.rows.iter().filter_map(|row| row.origin);
    verdict::origin_of_all(
        stated,
        Some("Some were measured; others were simulated or have no stated origin: see table.csv."),
    )
}

fn warnings(table: &RunTable) -> Vec<String> {
    let unfinished = table.rows.iter().filter(|row| row.state == RunState::Interrupted).count();
    if unfinished == 0 {
        return Vec::new();
    }
    vec![format!(
        "{} of the rows belong to interrupted runs: their values are not results.",
        whole(unfinished)
    )]
}
