//! Terminal output of `task = "learn"`: a table for each data set.

use crate::terminal::table::table;
use record::{prefixed, two_digits};
use results::{LearnDraw, LearnKind, LearnPart, LearnProblem, LearnResult, LearnRow};
use std::path::Path;

const HEADER: [&str; 9] =
    ["method", "free run", "× noise", "horizon s", "one step", "in 95 %", "torque off", "numbers", "s"];

/// Formats the result for the terminal.
pub(super) fn summary(result: &LearnResult, folder: &Path) -> String {
    let mut parts = vec![
        "errors are RMS on records never seen, in the record's unit; the horizon ends where the error passes \
         three times the noise; the torque's error is relative to what the nominal simulator lacks; at-zero \
         is a learner's model with everything that it learned set to zero; on-noise is the model with noise \
         in place of past and input"
            .to_owned(),
    ];
    parts.extend(result.problems.iter().map(|problem| described(problem, result)));
    let shown = folder.display();
    parts.push(format!("{:.1} s\nrun: {shown}\nreport: {shown}/report.html", result.seconds));
    parts.join("\n\n")
}

fn described(problem: &LearnProblem, result: &LearnResult) -> String {
    let head = format!("{} ({})", problem.title, problem.origin.name().to_uppercase());
    if let Some(reason) = &problem.absent {
        return format!("{head}\nABSENT: {reason}");
    }
    let data = &problem.data;
    let facts = format!(
        "{head}: {} records, {} stretches learned from ({} samples at {:.4} Hz), {} to choose, {} to test on; noise {} {}, \
         predictions from {:.3} s over {:.2} s{}",
        data.records,
        data.train,
        problem.training_samples,
        problem.rate_hz,
        data.validation,
        data.test,
        two_digits(problem.noise),
        problem.unit,
        problem.warm_up_s,
        problem.test_s,
        problem
            .input_between_samples()
            .map_or_else(String::new, |does| format!("; input between its samples: {does}")),
    );
    let own: Vec<&LearnRow> = result.results.iter().filter(|row| row.problem == problem.id).collect();
    let mut lines = vec![facts];
    lines.extend(problem.missing.iter().cloned());
    lines.push(match problem.parts.is_empty() {
        true => table(&HEADER, own.iter().map(|row| cells(row)).collect()),
        false => table_of_parts(problem, &own),
    });
    for row in &own {
        if let Some(failure) = &row.failure {
            lines.push(format!("{}: {failure}", row.id));
        }
        if let Some(equation) = &row.equation {
            lines.push(format!("{}: {equation}", row.id));
        }
    }
    lines.join("\n")
}

/// Formats the errors on each stated test part, and below them what others published.
fn table_of_parts(problem: &LearnProblem, rows: &[&LearnRow]) -> String {
    let names = problem.parts.iter().map(|part| part.id.as_str());
    let header: Vec<&str> =
        ["method"].into_iter().chain(names).chain(["validation", "numbers", "s"]).collect();
    let in_unit =
        |error: Option<f64>| error.map_or_else(|| "∞".to_owned(), |error| prefixed(error, &problem.unit));
    let own = |row: &&LearnRow| {
        // Over several seeds, the median and the range.
        let ranged = |own: Option<f64>, of: &dyn Fn(&LearnDraw) -> Option<f64>| {
            row.range_stated(of, |error| in_unit(Some(error))).unwrap_or_else(|| in_unit(own))
        };
        let error = |part: &LearnPart| {
            let errors = row.test.as_ref().map(|test| &test.parts);
            let own = errors.and_then(|errors| errors.iter().find(|own| own.part == part.id)?.free_run_rmse);
            ranged(own, &|draw| draw.on(&part.id))
        };
        let validation = row.validation.map(|validation| validation.free_run_rmse);
        let validation = ranged(validation, &|draw| draw.validation_rmse);
        let numbers = [validation, row.parameters.to_string(), format!("{:.1}", row.seconds)];
        [named(row)].into_iter().chain(problem.parts.iter().map(error)).chain(numbers).collect()
    };
    let mut published: Vec<&str> = Vec::new();
    for name in problem.parts.iter().flat_map(|part| &part.published).map(|own| own.name.as_str()) {
        if !published.contains(&name) {
            published.push(name);
        }
    }
    let of_others = |name: &str| {
        let error = |part: &LearnPart| {
            let own = part.published.iter().find(|own| own.name == name);
            own.map_or_else(String::new, |own| prefixed(own.free_run_rmse, &problem.unit))
        };
        let cells = problem.parts.iter().map(error).chain(std::iter::repeat_n(String::new(), 3));
        [format!("{name} (published)")].into_iter().chain(cells).collect()
    };
    let cells = rows.iter().map(own).chain(published.into_iter().map(of_others)).collect();
    table(&header, cells)
}

/// Returns the name of a row's method; a method that is no learner says what it is.
fn named(row: &LearnRow) -> String {
    match row.kind {
        LearnKind::Learner => row.id.clone(),
        kind => format!("{} ({})", row.id, kind.name()),
    }
}

fn cells(row: &LearnRow) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or_else(|| "∞".to_owned(), two_digits);
    // An ablation is a free run of a model that was trained already: it has no one-step error and no duration
    // of its own.
    let own = |cell: String| if row.kind == LearnKind::Ablation { String::new() } else { cell };
    // Over several seeds, the median and the range.
    let free_run = |own: Option<f64>| {
        row.range_stated(|draw| draw.free_run_rmse, two_digits).unwrap_or_else(|| number(own))
    };
    let mut cells = vec![named(row)];
    match &row.test {
        None => cells.extend(vec![
            row.reached.name().to_owned(),
            String::new(),
            String::new(),
            String::new(),
            String::new(),
        ]),
        Some(test) => cells.extend([
            free_run(test.free_run_rmse),
            number(test.over_noise),
            format!("{:.2}", test.horizon_s),
            own(number(test.one_step_rmse)),
            test.coverage_95.map_or_else(String::new, |share| format!("{:.1} %", 100.0 * share)),
        ]),
    }
    cells.push(row.torque_error.map_or_else(String::new, |error| format!("{} %", two_digits(100.0 * error))));
    cells.push(row.parameters.to_string());
    cells.push(own(format!("{:.2}", row.seconds)));
    cells
}
