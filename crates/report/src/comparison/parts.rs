//! What the sections of the page on a comparison share.

use results::{ComparisonResult, MethodEstimate, MethodRow};

/// A table of three columns: what a row is about, and two things said of it.
pub(super) struct WordTable {
    /// Name of its anchor in the page.
    pub(super) id: &'static str,
    pub(super) title: String,
    /// How to read it.
    pub(super) note: String,
    pub(super) columns: [&'static str; 3],
    pub(super) rows: Vec<[String; 3]>,
    /// Whether the cells hold sentences, which want the whole width of a narrow page.
    pub(super) is_prose: bool,
}

/// The methods that gave an estimate, with it.
pub(super) fn estimates(result: &ComparisonResult) -> impl Iterator<Item = (&MethodRow, &MethodEstimate)> {
    result.results.iter().filter_map(|row| row.outcome.estimate().map(|estimate| (row, estimate)))
}
