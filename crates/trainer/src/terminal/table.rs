//! Tables and numbers as a terminal shows them.

use comfy_table::{ContentArrangement, Table, presets};

/// A table with aligned columns, as wide as the terminal at most.
pub(crate) fn table(header: &[&str], rows: Vec<Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_content_arrangement(ContentArrangement::Dynamic);
    if !header.is_empty() {
        table.set_header(header.to_vec());
    }
    table.add_rows(rows);
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

/// An error to two significant digits: with a power of ten only where that is shorter.
pub(crate) fn two_digits(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if (-2.0..4.0).contains(&exponent) {
        let decimals = (1.0 - exponent).max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}
