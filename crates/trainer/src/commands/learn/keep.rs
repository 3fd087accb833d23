//! Output of a learning study: rows, tables, models, the report.

use super::problem::Prepared;
use crate::error::{LearnCommandError, TrainerError};
use crate::folders::page::write_report;
use experiment::LearnStudy;
use results::{
    LearnData, LearnDraw, LearnKind, LearnProblem, LearnResult, LearnRow, LearnSeriesRow, LearnTorqueRow,
    LearnTraceRow, RESULT_SCHEMA,
};
use runs::{RunFolder, to_csv};
use serde_json::json;
use workflow::learning::{Method, Ready, Tried, described, row, sort, truth_of};

/// Result of a method on a problem.
pub(super) struct Row<'a> {
    pub(super) problem: &'a Prepared,
    pub(super) ready: &'a Ready,
    pub(super) method: &'a Method<'a>,
    pub(super) tried: Tried,
    /// Rows of the model with everything that it learned set to zero, and with noise as its input.
    pub(super) ablated: Vec<LearnRow>,
    /// Errors with every seed, those of this row's own seed first.
    pub(super) draws: Vec<LearnDraw>,
}

impl Row<'_> {
    /// Returns the name of the model's file in the run's folder.
    fn model_file(&self) -> String {
        format!("model/{}/{}.safetensors", self.problem.id, self.method.id)
    }
}

/// Builds the content of `result.json`.
pub(super) fn result(
    study: &LearnStudy,
    problems: &[Prepared],
    rows: &[Row<'_>],
    seconds: f64,
) -> LearnResult {
    let told = |own: &Prepared| described(&own.id, &own.title, own.origin, own.ready.as_ref());
    let described: Vec<LearnProblem> = problems.iter().map(told).collect();
    let sum = |of: fn(&LearnData) -> usize| described.iter().map(|problem| of(&problem.data)).sum();
    let mut results = Vec::new();
    for problem in problems {
        let own: Vec<&Row<'_>> = rows.iter().filter(|row| row.problem.id == problem.id).collect();
        let truth = own.first().and_then(|row| truth_of(row.ready));
        let told = |own: &&Row<'_>| {
            let file = Some(own.model_file());
            let made = row(&problem.id, own.ready, own.method, &own.tried, truth.as_ref(), file);
            LearnRow { draws: if own.draws.len() > 1 { own.draws.clone() } else { Vec::new() }, ..made }
        };
        let mut made: Vec<LearnRow> = own.iter().map(told).collect();
        made.extend(own.iter().flat_map(|row| row.ablated.iter().cloned()));
        sort(&mut made);
        results.extend(made);
    }
    LearnResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "learn".to_owned(),
        seed: study.seed,
        data: LearnData {
            records: sum(|data| data.records),
            train: sum(|data| data.train),
            validation: sum(|data| data.validation),
            test: sum(|data| data.test),
        },
        problems: described,
        results,
        seconds,
    }
}

/// Writes the models, tables and results that are not written yet, with the report last.
pub(super) fn write(folder: &RunFolder, result: &LearnResult, rows: &[Row<'_>]) -> Result<(), TrainerError> {
    for row in rows {
        let Ok(judged) = &row.tried.fitted else { continue };
        let Some(stored) = judged.model.stored() else { continue };
        let data = &row.ready.data;
        let about = json!({
            "unit": data.unit,
            "warm_up_s": data.warm_up_s,
            "period_s": data.period_s,
            "noise": data.noise,
            "driven": data.is_driven(),
        });
        let bytes = stored
            .about(about)
            .to_bytes()
            .map_err(|source| LearnCommandError::Model { file: row.model_file(), source })?;
        folder.write(&row.model_file(), &bytes)?;
    }
    folder.write("trace.csv", &to_csv("trace.csv", &traces(rows))?)?;
    folder.write("predictions.csv", &to_csv("predictions.csv", &series(rows))?)?;
    folder.write("series.csv", &to_csv("series.csv", &torques(rows))?)?;
    folder.write_json("result.json", result)?;
    write_report(folder)
}

fn traces(rows: &[Row<'_>]) -> Vec<LearnTraceRow> {
    let of = |row: &Row<'_>| -> Vec<LearnTraceRow> {
        let steps = row.tried.steps.iter().enumerate();
        let made = steps.map(|(number, step)| LearnTraceRow {
            problem: row.problem.id.clone(),
            method: row.method.id.to_owned(),
            step: number as u64 + 1,
            phase: step.phase.clone(),
            train: step.train,
            validation: step.validation,
        });
        made.collect()
    };
    rows.iter().filter(|row| row.method.kind == LearnKind::Learner).flat_map(of).collect()
}

/// Collects the free runs of the first test stretch of each problem.
fn series(rows: &[Row<'_>]) -> Vec<LearnSeriesRow> {
    let mut all = Vec::new();
    for row in rows {
        let Ok(judged) = &row.tried.fitted else { continue };
        let Some(run) = judged.runs.first() else { continue };
        let Ok(predicted) = &run.predicted else { continue };
        let stds = predicted.std.iter().flatten().copied().map(Some).chain(std::iter::repeat(None));
        for (((time, observed), value), std) in
            run.times_s.iter().zip(&run.observed).zip(&predicted.values).zip(stds)
        {
            all.push(LearnSeriesRow {
                problem: row.problem.id.clone(),
                method: row.method.id.to_owned(),
                record: run.name.clone(),
                time_s: *time,
                observed: *observed,
                predicted: *value,
                std,
            });
        }
    }
    all
}

/// Collects the torques of the learners beside the true ones.
fn torques(rows: &[Row<'_>]) -> Vec<LearnTorqueRow> {
    let mut all = Vec::new();
    for row in rows.iter().filter(|row| row.method.kind == LearnKind::Learner) {
        let (Ok(judged), Some(truth)) = (&row.tried.fitted, truth_of(row.ready)) else { continue };
        for [position, velocity, input, truth, learned, std] in truth.rows(judged.model.as_ref()) {
            all.push(LearnTorqueRow {
                problem: row.problem.id.clone(),
                method: row.method.id.to_owned(),
                position,
                velocity,
                input,
                truth,
                learned,
                std: std.is_finite().then_some(std),
            });
        }
    }
    all
}
