//! The page on many runs: a sweep, or runs put side by side.

mod cells;
mod figures;
#[cfg(test)]
mod tests;
mod text;

use askama::Template;
use runs::result::{RunState, RunTable, SweepAxis};

use crate::figures::Figure;
use crate::format::count;
use crate::frame::{Frame, finish};
use crate::plot::Hue;
use crate::verdict::{self, Origin, Tone, Verdict};
use crate::{ReportError, RunTexts};
use cells::{Column, RowView};

pub use text::{csv, markdown, text_cells};

/// Rows on the page; `table.csv` has all.
const MOST_ROWS: usize = 2_000;
/// Longest result, in bytes, that the page holds in full.
const MOST_TEXT: usize = 300_000;

/// How to read the table.
const READING: &str = "The distance from the reference is |ζ − ζ₀|/ζ₀, where ζ₀ is that of closed-form least squares on the same \
     envelope; the worst is the largest over a run’s seeds. ± and the 95 % interval are the method’s own, under independent \
     residuals. A run passes where every seed is within its stated tolerance.";

#[derive(Template)]
#[template(path = "run_table.html")]
struct RunTablePage<'a> {
    frame: Frame<'a>,
    axes: &'a [SweepAxis],
    figures: Vec<Figure>,
    reading: &'static str,
    shortened: String,
    columns: Vec<Column>,
    /// Columns that hold numbers.
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
    let page = RunTablePage {
        frame: Frame {
            hues: &Hue::ALL,
            name: texts.name,
            kicker: if table.task == "sweep" { "a sweep" } else { "runs side by side" },
            verdict: headline(table),
            origin: origin(table),
            warnings: warnings(table),
            next: Vec::new(),
            pipelines: Vec::new(),
            data: Vec::new(),
            findings: Vec::new(),
            files: [
                ("Configuration that every run starts from (config.toml)", texts.config),
                ("Environment (environment.json)", texts.environment),
                ("Every number, unrounded (result.json)", result),
            ],
        },
        axes: &table.axes,
        figures: figures::figures(table),
        reading: READING,
        shortened: if shown < table.rows.len() {
            format!("The first {shown} of {} rows; table.csv has all.", table.rows.len())
        } else {
            String::new()
        },
        columns: cells::columns(table),
        numbers: cells::NUMBERS.len(),
        rows: table.rows.iter().take(shown).map(|row| cells::row(table, row)).collect(),
    };
    finish(&page)
}

fn headline(table: &RunTable) -> Verdict {
    let missed = table.rows.iter().filter(|row| !row.state.is_bad() && row.pass == Some(false)).count();
    let (tone, label) = match (table.failed, table.open, missed) {
        (0, 0, 0) => (Tone::Good, "Every run within its tolerance"),
        (0, 0, _) => (Tone::Bad, "Not every run within its tolerance"),
        (0, ..) => (Tone::Caution, "Not finished"),
        _ => (Tone::Bad, "Some runs gave no result"),
    };
    let rows = if missed == 1 { "row is" } else { "rows are" };
    Verdict {
        tone,
        label,
        sentence: format!(
            "Of {} runs {} are done, {} failed and {} are still open; {missed} {rows} outside the stated tolerance.",
            whole(table.done + table.failed + table.open),
            whole(table.done),
            whole(table.failed),
            whole(table.open),
        ),
    }
}

/// That of the record, where all runs share it.
fn origin(table: &RunTable) -> Origin {
    let mut stated: Vec<&str> =
        table.rows.iter().map(|row| row.origin.as_str()).filter(|origin| !origin.is_empty()).collect();
    stated.sort_unstable();
    stated.dedup();
    match stated[..] {
        [one] => verdict::origin(one),
        [] => verdict::origin("unstated"),
        _ => Origin {
            class: "unstated",
            label: "Records of different origins",
            note: "Some were measured, others simulated or not said to be either: table.csv says which.",
        },
    }
}

fn warnings(table: &RunTable) -> Vec<String> {
    let unfinished = table.rows.iter().filter(|row| row.state == RunState::Interrupted).count();
    if unfinished == 0 {
        return Vec::new();
    }
    vec![format!(
        "{} of the rows are of interrupted runs: what they had reached is no result.",
        whole(unfinished)
    )]
}

fn whole(value: usize) -> String {
    count(value as u64)
}
