//! Table of a data set's scores, with a column for each stated test part.

use crate::format::{fixed, significant};
use crate::tables::{ScoreRow, ScoreTable, whole};
use results::{LearnDraw, LearnKind, LearnPart, LearnProblem, LearnRow};

/// Columns before those of the test parts, and after them.
const FIRST: [&str; 2] = ["Method", "Free run"];
const LAST: [&str; 7] =
    ["× noise", "Horizon (s)", "One step", "In 95 % band", "Torque off", "Numbers", "Time (s)"];

/// Returns the table of a data set's methods, followed by what others published for its test parts.
pub(super) fn table(problem: &LearnProblem, rows: &[&LearnRow]) -> ScoreTable {
    let parts = problem.parts.iter().map(|part| format!("{} ({})", part.id, problem.unit));
    let validation = (!problem.parts.is_empty()).then(|| format!("Validation ({})", problem.unit));
    let [first, last] = [&FIRST[..], &LAST].map(|own| own.iter().map(|name| (*name).to_owned()));
    ScoreTable {
        columns: first.chain(parts).chain(validation).chain(last).collect(),
        rows: rows.iter().map(|row| of_method(row, problem)).chain(published(problem)).collect(),
    }
}

fn of_method(row: &LearnRow, problem: &LearnProblem) -> ScoreRow {
    let number = |value: Option<f64>| value.map_or_else(|| "∞".to_owned(), |value| significant(value, 3));
    // An ablation is a free run of an already trained model, so it has no one-step error and no training
    // time.
    let own = |cell: String| if row.kind == LearnKind::Ablation { String::new() } else { cell };
    let cells = row.test.as_ref().map_or_else(Vec::new, |test| {
        let on = |part: &LearnPart| test.parts.iter().find(|own| own.part == part.id);
        let of_part =
            |part: &LearnPart| Some(ranged(row, |draw| draw.on(&part.id), number(on(part)?.free_run_rmse)));
        let parts = problem.parts.iter().map(of_part);
        let validation = row.validation.map(|own| significant(own.free_run_rmse, 3));
        let validation = validation.map(|own| ranged(row, |draw| draw.validation_rmse, own));
        let stated = parts.chain((!problem.parts.is_empty()).then_some(validation));
        let last = [
            number(test.over_noise),
            significant(test.horizon_s, 3),
            own(number(test.one_step_rmse)),
            test.coverage_95.map_or_else(String::new, |share| format!("{} %", fixed(100.0 * share, 1))),
            row.torque_error.map_or_else(String::new, |error| format!("{} %", significant(100.0 * error, 2))),
            whole(row.parameters),
            own(significant(row.seconds, 2)),
        ];
        let stated = stated.map(Option::unwrap_or_default);
        let free_run = ranged(row, |draw| draw.free_run_rmse, number(test.free_run_rmse));
        [free_run].into_iter().chain(stated).chain(last).collect()
    });
    let reason = row.failure.clone().unwrap_or_else(|| row.reached.name().to_owned());
    ScoreRow { title: row.title.clone(), is_marked: row.kind == LearnKind::Learner, cells, reason }
}

/// Returns the median and the range over several seeds; for a single one, its own cell.
fn ranged(row: &LearnRow, of: impl Fn(&LearnDraw) -> Option<f64>, own: String) -> String {
    row.range_stated(of, |error| significant(error, 3)).unwrap_or(own)
}

/// Returns a row for each method of others, in the order in which the parts state them.
fn published(problem: &LearnProblem) -> Vec<ScoreRow> {
    let mut names: Vec<&str> = Vec::new();
    for own in problem.parts.iter().flat_map(|part| &part.published) {
        if !names.contains(&own.name.as_str()) {
            names.push(&own.name);
        }
    }
    let row = |name: &str| {
        let error = |part: &LearnPart| {
            let own = part.published.iter().find(|own| own.name == name);
            own.map_or_else(String::new, |own| significant(own.free_run_rmse, 3))
        };
        let empty = std::iter::repeat_n(String::new(), 1 + LAST.len());
        let cells = [String::new()].into_iter().chain(problem.parts.iter().map(error)).chain(empty);
        let title = format!("{name} (published)");
        ScoreRow { title, is_marked: false, cells: cells.collect(), reason: String::new() }
    };
    names.into_iter().map(row).collect()
}
