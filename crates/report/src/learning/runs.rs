//! Free runs that a data set's plots show.

use results::{LearnKind, LearnProblem, LearnRow, LearnSeriesRow};

/// Largest number of free runs drawn, those of the best methods.
const MOST_RUNS: usize = 4;

/// Method with its free run over the first test record.
pub(super) type Drawn<'a> = (&'a LearnRow, Vec<&'a LearnSeriesRow>);

/// Returns the best methods that have a free run.
pub(super) fn drawn<'a>(
    problem: &LearnProblem,
    rows: &[&'a LearnRow],
    runs: &'a [LearnSeriesRow],
) -> Vec<Drawn<'a>> {
    let of = |method: &str| -> Vec<&LearnSeriesRow> {
        runs.iter().filter(|row| row.problem == problem.id && row.method == method).collect()
    };
    rows.iter()
        .filter(|row| row.kind != LearnKind::Reference)
        .map(|row| (*row, of(&row.id)))
        .filter(|(_, found)| !found.is_empty())
        .take(MOST_RUNS)
        .collect()
}

/// Returns the name of the data set under a plot; it always distinguishes simulated from measured data.
pub(super) fn named(problem: &LearnProblem) -> String {
    format!("{} ({})", problem.title, crate::verdict::kind(problem.origin))
}
