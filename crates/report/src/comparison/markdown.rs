//! Tables of a comparison as GitHub Markdown, and those of its methods as LaTeX.

use results::ComparisonResult;

use super::methods::{self, MethodTable, MethodView};
use super::parts::WordTable;
use super::{guidelines, oscillation, verdict};
use crate::latex;
use crate::remarks::{noticed, warnings};
use crate::tables::{self, PipelineView};
use crate::verdict::{kind, origin};

pub(crate) fn markdown(result: &ComparisonResult) -> String {
    let origin = origin(result.data.origin);
    let verdict = verdict::verdict(result);
    let mut blocks = vec![
        format!("# One damping ratio by {} methods", result.results.len()),
        format!("**{}.** {}", origin.label, origin.note),
        format!("**{}.** {}", verdict.label, escape(&verdict.sentence)),
    ];
    blocks
        .extend(warnings(&result.oracle).iter().map(|warning| format!("**Take care.** {}", escape(warning))));
    blocks.extend(word_table(&oscillation::parameters(result)));
    blocks.extend(word_table(&oscillation::derived(result)));
    for table in methods::tables(result) {
        blocks.extend(method_table(&table));
    }
    blocks.push(escape(methods::READING));
    blocks.extend(word_table(&guidelines::guidelines(result)));
    if !result.cautions.is_empty() {
        blocks.push("## What does not follow from these numbers".to_owned());
        blocks.push(list(
            result
                .cautions
                .iter()
                .map(|caution| format!("“{}” – {}", escape(&caution.statement), escape(&caution.finding))),
        ));
    }
    if !result.pipelines.is_empty() {
        blocks.push("## The same record through each pipeline".to_owned());
        blocks.push(pipelines(&tables::pipelines(&result.pipelines)));
    }
    blocks.push("## Data".to_owned());
    let facts = tables::data(&result.data);
    let facts = facts.iter().map(|fact| format!("{}: {}", fact.name, escape(&fact.value)));
    let findings = noticed(&result.data);
    let findings = findings.iter().map(|finding| format!("Noticed: {}", escape(finding)));
    blocks.push(list(facts.chain(findings)));
    blocks.join("\n\n") + "\n"
}

/// Columns that a printed page has no room for.
const SCREEN_ONLY: [&str; 4] = ["digits", "may differ", "at zero, %", "on noise, %"];

/// Returns the tables of the methods as LaTeX.
pub(crate) fn latex(result: &ComparisonResult) -> String {
    let record = format!("{} ({})", result.data.path, kind(result.data.origin));
    let tables = methods::tables(result).into_iter().map(|table| {
        let columns = method_columns(&table);
        let is_printed: Vec<bool> = columns.iter().map(|(title, _)| !SCREEN_ONLY.contains(title)).collect();
        let printed = |cells: Vec<String>| -> Vec<String> {
            cells.into_iter().zip(&is_printed).filter_map(|(cell, keep)| keep.then_some(cell)).collect()
        };
        let rows =
            table.rows.iter().map(|row| printed(method_cells(row, table.columns.len(), str::to_owned)));
        let columns: Vec<(&str, bool)> =
            columns.iter().zip(&is_printed).filter_map(|(column, keep)| keep.then_some(*column)).collect();
        // LaTeX numbers its tables itself.
        let title = table.title.split_once(": ").map_or(table.title, |(_, title)| title);
        latex::table(&format!("Damping ratio by {title}: {record}."), &columns, rows)
    });
    std::iter::once(latex::PREAMBLE.to_owned()).chain(tables).collect::<Vec<_>>().join("\n")
}

fn word_table(table: &WordTable) -> [String; 3] {
    let rows = table.rows.iter().map(|row| row.iter().map(|cell| escape(cell)).collect());
    let columns = table.columns.map(|title| (title, false));
    [format!("## {}", escape(&table.title)), escape(&table.note), grid(&columns, rows)]
}

/// Returns the columns of a table of methods, each a title and `true` for right alignment.
fn method_columns(table: &MethodTable) -> Vec<(&'static str, bool)> {
    let last = table.columns.len().saturating_sub(1);
    table.columns.iter().enumerate().map(|(index, title)| (*title, index != 1 && index + 1 < last)).collect()
}

fn method_table(table: &MethodTable) -> [String; 2] {
    let rows = table.rows.iter().map(|row| {
        let mut cells = method_cells(row, table.columns.len(), escape);
        if let Some(verdict) = cells.last_mut().filter(|_| row.tone() != "good") {
            *verdict = format!("**{verdict}**");
        }
        cells
    });
    [format!("## {}", escape(table.title)), grid(&method_columns(table), rows)]
}

fn method_cells(row: &MethodView, width: usize, escape: fn(&str) -> String) -> Vec<String> {
    let mut cells = vec![escape(&row.number), escape(&row.title)];
    cells.extend(row.numbers.iter().map(|cell| escape(cell)));
    // Beside the state and the verdict; a method without an estimate has no numbers.
    cells.resize(width.saturating_sub(2), String::new());
    cells.push(escape(&row.state));
    cells.push(row.verdict().to_owned());
    cells
}

fn pipelines(rows: &[PipelineView<'_>]) -> String {
    let columns = [
        ("pipeline", false),
        ("clock", false),
        ("ζ ± standard error", true),
        ("λ, 1/s", true),
        ("ω, rad/s", true),
        ("peaks", true),
        ("R²", true),
        ("", false),
    ];
    let rows = rows.iter().map(|row| {
        let mut cells = vec![escape(row.pipeline), escape(row.clock)];
        match &row.fit {
            Some(fit) => cells.extend(
                [&fit.zeta, &fit.decay_rate, &fit.omega, &fit.peaks, &fit.r_squared].map(|cell| escape(cell)),
            ),
            None => cells.extend(std::iter::repeat_n(String::new(), 5)),
        }
        cells.push(match (&row.fit, row.is_in_force) {
            (None, _) => format!("does not apply: {}", escape(row.reason)),
            (Some(_), true) => "**in force**".to_owned(),
            (Some(_), false) => String::new(),
        });
        cells
    });
    grid(&columns, rows)
}

/// Returns a Markdown table; each column is a title and `true` for right alignment.
pub(crate) fn grid(columns: &[(&str, bool)], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
    let titles: Vec<String> = columns.iter().map(|(title, _)| escape(title)).collect();
    let rule: Vec<String> =
        columns.iter().map(|(_, right)| if *right { "---:" } else { "---" }.to_owned()).collect();
    let mut lines = vec![line(&titles), line(&rule)];
    lines.extend(rows.map(|row| line(&row)));
    lines.join("\n")
}

pub(crate) fn list(items: impl Iterator<Item = String>) -> String {
    items.map(|item| format!("- {item}")).collect::<Vec<_>>().join("\n")
}

/// Escapes text so that Markdown shows it literally, on one line. The caller must not begin a line with it.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '#' | '|' | '~' | '$' | '!' => {
                escaped.push('\\');
                escaped.push(letter);
            }
            // A line break would end the table.
            _ if letter.is_control() => escaped.push(' '),
            _ => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::sample;

    #[test]
    fn every_row_of_a_table_has_its_columns() {
        let text = markdown(&sample::result());
        let mut width = None;
        let mut rows = 0;
        for line in text.lines() {
            if !line.starts_with('|') {
                width = None;
                continue;
            }
            let cells = line.replace("\\|", "").matches('|').count();
            assert_eq!(*width.get_or_insert(cells), cells, "{line}");
            rows += 1;
        }
        // Five tables with two header lines each, and one for the pipelines.
        assert_eq!(rows, 6 * 2 + 9 + 8 + 11 + 10 + 6 + 4);
    }

    #[test]
    fn what_comes_from_files_is_escaped() {
        const EVIL: &str = "<script>|a|\n# b `c` *d* [e](f) $g$ \\";
        let mut result = sample::result();
        result.results[0].title = EVIL.into();
        result.data.path = EVIL.into();
        result.data.findings = vec![EVIL.into()];
        result.cautions[0].statement = EVIL.into();
        let text = markdown(&result);
        assert!(!text.contains("<script") && !text.contains("\n# b"));
        assert!(text.contains("&lt;script&gt;\\|a\\| \\# b \\`c\\` \\*d\\* \\[e\\](f) \\$g\\$ \\\\"));
    }

    #[test]
    fn the_methods_are_latex_tables_too() {
        let mut result = sample::result();
        result.data.path = "a_b.csv".into();
        let text = latex(&result);
        assert_eq!(text.matches("\\begin{table}").count(), 2);
        assert!(text.contains("\\caption{Damping ratio by learned methods: a\\_b.csv (measured)."), "{text}");
        for body in text.split("\\toprule").skip(1) {
            let body = body.split("\\bottomrule").next().unwrap();
            let widths: Vec<usize> = body
                .lines()
                .filter(|line| line.ends_with("\\\\"))
                .map(|line| line.replace("\\&", "").matches('&').count())
                .collect();
            assert!(widths.len() > 10 && widths.iter().all(|width| *width == widths[0]), "{widths:?}");
        }
    }

    #[test]
    fn two_texts_are_equal_bytes() {
        assert_eq!(markdown(&sample::result()), markdown(&sample::result()));
    }

    #[test]
    fn a_failure_stands_with_its_reason() {
        let text = markdown(&sample::result());
        let row = text.lines().find(|line| line.starts_with("| 16 |")).unwrap();
        assert!(row.contains("no estimate: the budget") && row.ends_with("| **FAIL** |"), "{row}");
    }
}
