//! Sections, tables and percentages of the page of trials.

use crate::figures::Figure;
use crate::format::{fixed, quantity};

/// A section of tables and plots.
pub(super) struct Section {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) sentences: Vec<String>,
    pub(super) grids: Vec<Grid>,
    pub(super) figures: Vec<Figure>,
}

/// A table whose cells may be shaded by their values.
pub(super) struct Grid {
    pub(super) title: String,
    pub(super) corner: &'static str,
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<GridRow>,
}

pub(super) struct GridRow {
    pub(super) name: String,
    pub(super) cells: Vec<GridCell>,
}

/// A cell: a number, a small text below it, and the depth of its shading in percent.
#[derive(Default)]
pub(super) struct GridCell {
    pub(super) text: String,
    pub(super) aside: String,
    pub(super) shade: Option<String>,
}

/// Formats a share in percent.
pub(super) fn percent(share: f64) -> String {
    if share.is_finite() { quantity(&fixed(100.0 * share, 1), "%") } else { "–".to_owned() }
}

/// Formats an interval of shares in percent, without the unit.
pub(super) fn percents(ends: [f64; 2]) -> String {
    let [low, high] = ends.map(|end| fixed(100.0 * end, 1));
    format!("[{low}, {high}]")
}
