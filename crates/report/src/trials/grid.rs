//! Sections, tables and percentages of the page on trials.

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

/// A table whose cells may be shaded by what they hold.
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

/// A cell: a number, what stands small below it, and how deep it is shaded, in percent.
#[derive(Default)]
pub(super) struct GridCell {
    pub(super) text: String,
    pub(super) aside: String,
    pub(super) shade: Option<String>,
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    if share.is_finite() { quantity(&fixed(100.0 * share, 1), "%") } else { "–".to_owned() }
}

/// An interval of shares in percent, without its unit.
pub(super) fn percents(ends: [f64; 2]) -> String {
    let [low, high] = ends.map(|end| fixed(100.0 * end, 1));
    format!("[{low}, {high}]")
}
