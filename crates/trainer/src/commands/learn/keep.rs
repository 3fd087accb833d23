//! What a learning study leaves: rows, tables, models, the report.

use super::method::{Method, Tried, truth_of};
use super::problem::{Prepared, Ready};
use crate::error::{LearnCommandError, TrainerError};
use crate::folders::page::write_report;
use ::learn::LearnError;
use ::learn::data::Trajectory;
use ::learn::judge::{Score, Truth};
use experiment::LearnStudy;
use results::{
    LearnCoefficient, LearnData, LearnEnd, LearnKind, LearnProblem, LearnResult, LearnRow, LearnSeriesRow,
    LearnTest, LearnTorqueRow, LearnTraceRow, RESULT_SCHEMA,
};
use runs::{RunFolder, to_csv};
use serde_json::json;
use std::collections::BTreeMap;

/// A method on a problem, with what it gave.
pub(super) struct Row<'a> {
    pub(super) problem: &'a Prepared,
    pub(super) ready: &'a Ready,
    pub(super) method: &'a Method<'a>,
    pub(super) tried: Tried,
}

impl Row<'_> {
    /// Where its model is kept, in the run's folder.
    fn model_file(&self) -> String {
        format!("model/{}/{}.safetensors", self.problem.id, self.method.id)
    }

    fn row(&self, truth: Option<&Truth>) -> LearnRow {
        let mut row = LearnRow {
            problem: self.problem.id.clone(),
            id: self.method.id.to_owned(),
            title: self.method.title.to_owned(),
            kind: self.method.kind,
            test: None,
            coefficients: None,
            equation: None,
            torque_error: None,
            parameters: 0,
            seconds: self.tried.seconds,
            reached: LearnEnd::Failed,
            failure: None,
            model: None,
        };
        match &self.tried.fitted {
            Err(LearnError::Interrupted) => row.reached = LearnEnd::Interrupted,
            Err(error) => row.failure = Some(error.to_string()),
            Ok(judged) => {
                let model = judged.model.as_ref();
                row.test = Some(test(&judged.score, &self.ready.data.unit));
                row.coefficients = coefficients(model, truth);
                row.equation = model.equation();
                row.torque_error =
                    truth.and_then(|truth| truth.torque_error(model)).filter(|error| error.is_finite());
                row.parameters = model.parameters();
                row.reached = judged.reached;
                row.model = model.stored().map(|_| self.model_file());
            }
        }
        row
    }
}

fn test(score: &Score, unit: &str) -> LearnTest {
    let finite = |value: f64| value.is_finite().then_some(value);
    LearnTest {
        free_run_rmse: finite(score.free_run_rmse),
        unit: unit.to_owned(),
        over_noise: finite(score.over_noise),
        horizon_s: score.horizon_s,
        one_step_rmse: finite(score.one_step_rmse),
        coverage_95: score.coverage_95,
    }
}

fn coefficients(
    model: &dyn ::learn::Model,
    truth: Option<&Truth>,
) -> Option<BTreeMap<String, LearnCoefficient>> {
    let errors = truth.and_then(|truth| truth.coefficient_errors(model)).unwrap_or_default();
    let true_value = |name: &str| errors.iter().find(|error| error.name == name).map(|error| error.truth);
    let mut all: BTreeMap<String, LearnCoefficient> = model
        .coefficients()
        .iter()
        .map(|own| {
            let coefficient = LearnCoefficient {
                value: own.value,
                unit: own.unit.clone(),
                interval_95: own.interval_95(),
                inclusion: own.inclusion,
                truth: true_value(&own.name),
            };
            (own.name.clone(), coefficient)
        })
        .collect();
    if all.is_empty() {
        return None;
    }
    for error in errors {
        // A term of the truth that the law lacks stands with a value of 0.
        all.entry(error.name).or_insert(LearnCoefficient {
            value: error.value,
            unit: String::new(),
            interval_95: None,
            inclusion: None,
            truth: Some(error.truth),
        });
    }
    Some(all)
}

/// The content of `result.json`.
pub(super) fn result(
    study: &LearnStudy,
    problems: &[Prepared],
    rows: &[Row<'_>],
    seconds: f64,
) -> LearnResult {
    let described: Vec<LearnProblem> = problems.iter().map(described).collect();
    let sum = |of: fn(&LearnData) -> usize| described.iter().map(|problem| of(&problem.data)).sum();
    let mut results = Vec::new();
    for problem in problems {
        let own: Vec<&Row<'_>> = rows.iter().filter(|row| row.problem.id == problem.id).collect();
        let truth = own.first().and_then(|row| truth_of(row.ready));
        let mut made: Vec<LearnRow> = own.iter().map(|row| row.row(truth.as_ref())).collect();
        let error =
            |row: &LearnRow| row.test.as_ref().and_then(|test| test.free_run_rmse).unwrap_or(f64::INFINITY);
        made.sort_by(|a, b| error(a).total_cmp(&error(b)));
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

fn described(problem: &Prepared) -> LearnProblem {
    let mut described = LearnProblem {
        id: problem.id.clone(),
        title: problem.title.clone(),
        origin: problem.origin.clone(),
        absent: problem.ready.as_ref().err().cloned(),
        unit: String::new(),
        data: LearnData::default(),
        training_samples: 0,
        rate_hz: 0.0,
        period_s: 0.0,
        warm_up_s: 0.0,
        noise: 0.0,
        test_s: 0.0,
    };
    if let Ok(ready) = &problem.ready {
        let data = &ready.data;
        described.unit.clone_from(&data.unit);
        described.data = LearnData {
            records: ready.records,
            train: data.train.len(),
            validation: data.validation.len(),
            test: data.test.len(),
        };
        described.training_samples = data.training_samples();
        described.rate_hz = data.train.first().map_or(0.0, Trajectory::rate_hz);
        described.period_s = data.period_s;
        described.warm_up_s = data.warm_up_s;
        described.noise = data.noise;
        let whole: f64 = data.test.iter().map(|part| part.duration_s() - data.warm_up_s).sum();
        described.test_s = whole / data.test.len().max(1) as f64;
    }
    described
}

/// Writes everything that is left to write, the report last.
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

/// Free runs of the first test stretch of each problem.
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

/// Learned torques of learners beside the true ones.
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
