//! Runs as the rows of one table, from folders or from a sweep.

pub(crate) mod build;
pub(crate) mod of_sweep;

use crate::terminal::console;
use crate::terminal::table::table as aligned;
use record::counted;
use report::run_table_text;
use results::RunTable;

/// Maximum number of rows shown on a terminal; files and `--json` have all of them.
const MOST_LINES: usize = 100;

/// Words that occur only in rows that need attention.
pub(crate) const RED: [&str; 3] = ["FAIL", "CORRUPT", "corrupt"];

/// Prints a table; of a long one only the first rows.
pub(crate) fn print_table(table: &RunTable) {
    let (header, mut rows) = run_table_text(table);
    let left_out = rows.len().saturating_sub(MOST_LINES);
    rows.truncate(MOST_LINES);
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let mut text = aligned(&header, rows);
    if left_out > 0 {
        text.push_str(&format!(
            "\n… and {} more; table.csv, --json and --format csv have all",
            counted(left_out, "row")
        ));
    }
    text.push_str(&format!("\n\n{} done, {} failed, {} open", table.done, table.failed, table.open));
    console::table(&text, &RED);
}
