//! Plots of a data set: free runs against the record, learned torques against the true ones, errors by
//! method.

use super::residuals;
use super::runs::{Drawn, drawn, named};
use results::{LearnKind, LearnProblem, LearnRow, LearnTorqueRow};

use crate::figures::{Figure, csv, figure, number};
use crate::parse::Learning;
use crate::plot::{Axis, DotRow, DotRows, Hue, Mark, Plot, Series};

pub(super) fn figures(
    id: &str,
    problem: &LearnProblem,
    rows: &[&LearnRow],
    learning: &Learning,
) -> Vec<Figure> {
    let drawn = drawn(problem, rows, &learning.runs);
    let mut all: Vec<Figure> = free_runs(id, problem, &drawn).into_iter().collect();
    all.extend(residuals::figures(id, problem, &drawn));
    all.extend(errors(id, problem, rows));
    all.extend(torques(id, problem, rows, &learning.torques));
    all.extend(losses(id, problem, rows, learning));
    all
}

fn free_runs(id: &str, problem: &LearnProblem, drawn: &[Drawn<'_>]) -> Option<Figure> {
    let (_, first) = drawn.first()?;
    let record = first.first().map(|row| row.record.clone()).unwrap_or_default();
    let mut series = vec![Series {
        label: "record".into(),
        hue: Hue::Data,
        mark: Mark::Dots,
        points: first.iter().map(|row| (row.time_s, row.observed)).collect(),
    }];
    for (index, (row, found)) in drawn.iter().enumerate() {
        series.push(Series {
            label: row.title.clone(),
            hue: Hue::of_series(index),
            mark: if index.is_multiple_of(2) { Mark::Line } else { Mark::Dashes },
            points: found.iter().map(|row| (row.time_s, row.predicted)).collect(),
        });
    }
    let table = csv(&["method", "time_s", "observed", "predicted"], first, |row| {
        vec![row.method.clone(), number(row.time_s), number(row.observed), number(row.predicted)]
    });
    let plot = Plot {
        x: Axis::linear("time (s)"),
        y: Axis::linear(format!("position ({})", problem.unit)),
        series,
        shaded: vec![],
    };
    let explanation = format!(
        "Dots are the test record {record}, which no method saw; lines are free runs from its warm-up. Only \
         the methods with the smallest errors are drawn; predictions.csv has all."
    );
    figure(format!("{id}-runs"), format!("Free runs: {}", named(problem)), &explanation, &plot, table)
}

fn errors(id: &str, problem: &LearnProblem, rows: &[&LearnRow]) -> Option<Figure> {
    let error = |row: &LearnRow| row.test.as_ref().and_then(|test| test.free_run_rmse);
    let one_step = |row: &LearnRow| row.test.as_ref().and_then(|test| test.one_step_rmse);
    let plot = DotRows {
        x: Axis::log(format!("RMS error on records never seen ({})", problem.unit)),
        rows: rows
            .iter()
            .map(|row| DotRow {
                name: row.title.clone(),
                value: error(row),
                extreme: one_step(row),
                interval: None,
            })
            .collect(),
        value_label: "free run".into(),
        extreme_label: "one step ahead".into(),
        level: Some(("noise of the sensor".into(), problem.noise)),
    };
    let title = format!("Errors by method: {}", named(problem));
    let drawing = plot.draw(&format!("{title}: {}, one row for each method.", plot.x.label))?;
    let (table, count) = csv(&["method", "free_run", "one_step"], rows, |row| {
        let cell = |value: Option<f64>| value.map_or_else(String::new, number);
        vec![row.id.clone(), cell(error(row)), cell(one_step(row))]
    });
    Some(Figure {
        id: format!("{id}-errors").into(),
        title: title.into(),
        explanation: "A dot at the dashed line predicts as well as the sensor measures.".to_owned(),
        notes: Vec::new(),
        drawing,
        csv: table,
        rows: count,
    })
}

fn torques(
    id: &str,
    problem: &LearnProblem,
    rows: &[&LearnRow],
    torques: &[LearnTorqueRow],
) -> Option<Figure> {
    let own: Vec<&LearnTorqueRow> = torques.iter().filter(|row| row.problem == problem.id).collect();
    let learners: Vec<&LearnRow> =
        rows.iter().copied().filter(|row| own.iter().any(|torque| torque.method == row.id)).collect();
    if learners.is_empty() {
        return None;
    }
    let series = learners.iter().enumerate().map(|(index, row)| Series {
        label: row.title.clone(),
        hue: Hue::of_series(index),
        mark: Mark::Dots,
        points: own
            .iter()
            .filter(|own| own.method == row.id)
            .map(|own| (own.truth, own.learned - own.truth))
            .collect(),
    });
    let plot = Plot {
        x: Axis::linear(format!("true torque over inertia ({}/s²)", problem.unit)),
        y: Axis::linear(format!("learned less true ({}/s²)", problem.unit)),
        series: series.collect(),
        shaded: vec![],
    };
    let table = csv(&["method", "position", "velocity", "input", "truth", "learned"], &own, |row| {
        let mut cells = vec![row.method.clone()];
        cells.extend([row.position, row.velocity, row.input, row.truth, row.learned].map(number));
        cells
    });
    let explanation = "Torque at the states that the test records visit: a method with all dots on zero has \
                       learned it exactly.";
    figure(format!("{id}-torque"), format!("Learned torque: {}", named(problem)), explanation, &plot, table)
}

fn losses(id: &str, problem: &LearnProblem, rows: &[&LearnRow], learning: &Learning) -> Option<Figure> {
    let own: Vec<_> = learning.trace.iter().filter(|row| row.problem == problem.id).collect();
    let series =
        rows.iter().filter(|row| row.kind == LearnKind::Learner).enumerate().map(|(index, row)| Series {
            label: row.title.clone(),
            hue: Hue::of_series(index),
            mark: if index < 4 { Mark::Line } else { Mark::Dashes },
            points: own
                .iter()
                .filter(|own| own.method == row.id)
                .map(|own| (own.step as f64, own.train))
                .collect(),
        });
    let plot = Plot {
        x: Axis::linear("training step"),
        y: Axis::log(format!("RMS residual while training ({})", problem.unit)),
        series: series.collect(),
        shaded: vec![],
    };
    let table = csv(&["method", "step", "phase", "train"], &own, |row| {
        vec![row.method.clone(), row.step.to_string(), row.phase.clone(), number(row.train)]
    });
    let explanation = "Jumps occur where the fitted pieces grow longer or a term is removed.";
    figure(format!("{id}-training"), format!("Training: {}", named(problem)), explanation, &plot, table)
}
