//! Verdict and explanation of a table of runs.

use crate::format::count;
use crate::verdict::{Tone, Verdict};
use results::RunTable;

/// Explanation of the columns of estimates.
const ESTIMATES: &str = "The distance from the reference is |ζ − ζ₀|/ζ₀, where ζ₀ is that of closed-form least squares on the same \
     envelope; the worst is the largest over a run’s seeds. ± and the 95 % interval are the method’s own, under independent \
     residuals. A run passes where every seed is within its stated tolerance.";
/// Explanation of the columns of learners.
const LEARNERS: &str = "The errors of learners are root mean squares of free runs: × noise is the error divided by the sensor noise. \
     Settings may be chosen by the validation error; the test error is on records that no choice has seen. The horizon is \
     the median time until the error exceeds three times the noise.";

/// Returns the explanation of the table's columns.
pub(super) fn reading(table: &RunTable) -> String {
    let has_learned = table.rows.iter().any(|row| row.learned.is_some());
    let has_estimates = !has_learned || table.rows.iter().any(|row| row.zeta.is_some());
    let parts = [has_estimates.then_some(ESTIMATES), has_learned.then_some(LEARNERS)];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" ")
}

pub(super) fn headline(table: &RunTable) -> Verdict {
    let missed = table.rows.iter().filter(|row| !row.state.is_bad() && row.pass == Some(false)).count();
    let (tone, label) = match (table.failed, table.open, missed) {
        (0, 0, 0) => (Tone::Good, "Every run within its tolerance"),
        (0, 0, _) => (Tone::Bad, "Not every run within its tolerance"),
        (0, ..) => (Tone::Caution, "Not finished"),
        _ => (Tone::Bad, "Some runs gave no result"),
    };
    if let Some(found) = &table.search {
        let (tone, label) = match (&found.best, table.open) {
            (None, _) => (Tone::Bad, "No trial gave a result"),
            (Some(_), 0) => (Tone::Good, "Searched"),
            (Some(_), _) => (Tone::Caution, "Not finished"),
        };
        return Verdict { tone, label, sentence: found.sentence() };
    }
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

pub(super) fn whole(value: usize) -> String {
    count(value as u64)
}
