//! Parts shared by the sections of a comparison page.

use results::{ComparisonResult, MethodEstimate, MethodRow};

/// A table of three columns: the subject of a row, and two statements about it.
pub(super) struct WordTable {
    /// Name of the table's anchor in the page.
    pub(super) id: &'static str,
    pub(super) title: String,
    /// Explanation of the table.
    pub(super) note: String,
    pub(super) columns: [&'static str; 3],
    pub(super) rows: Vec<[String; 3]>,
    /// `true` if the cells hold sentences, which need the whole width of a narrow page.
    pub(super) is_prose: bool,
}

/// Returns the methods that gave an estimate, with their estimates.
pub(super) fn estimates(result: &ComparisonResult) -> impl Iterator<Item = (&MethodRow, &MethodEstimate)> {
    result.results.iter().filter_map(|row| row.outcome.estimate().map(|estimate| (row, estimate)))
}
