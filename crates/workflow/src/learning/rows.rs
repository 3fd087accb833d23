//! Rows of a learning study's result.

use super::method::Method;
use super::{Ready, Tried};
use learn::LearnError;
use learn::data::Trajectory;
use learn::judge::{Run, Score, Truth, run_error, runs, runs_on_noise, score_of_runs};
use learn::learners::find;
use record::Origin;
use results::{
    LearnCoefficient, LearnData, LearnDraw, LearnEnd, LearnKind, LearnPart, LearnPartError, LearnProblem,
    LearnPublished, LearnRow, LearnTest, LearnValidation, Reached,
};
use seed::Seed;
use std::collections::BTreeMap;

/// Builds a method's row in the table of results. `problem` names the data set; `model` names the file that
/// stores the model, if the model can be stored.
#[must_use]
pub fn row(
    problem: &str,
    ready: &Ready,
    method: &Method<'_>,
    tried: &Tried,
    truth: Option<&Truth>,
    model: Option<String>,
) -> LearnRow {
    let mut row = LearnRow {
        problem: problem.to_owned(),
        id: method.id.to_owned(),
        title: method.title.to_owned(),
        kind: method.kind,
        test: None,
        validation: None,
        draws: Vec::new(),
        coefficients: None,
        equation: None,
        torque_error: None,
        parameters: 0,
        seconds: tried.seconds,
        reached: LearnEnd::Failed,
        failure: None,
        model: None,
    };
    match &tried.fitted {
        Err(LearnError::Interrupted) => {
            row.reached = LearnEnd::Trained(Reached::Interrupted);
            let seen = tried.steps.iter().filter_map(|step| step.validation);
            row.validation = validation(seen.fold(f64::INFINITY, f64::min), ready);
        }
        Err(error) => row.failure = Some(error.to_string()),
        Ok(judged) => {
            let made = judged.model.as_ref();
            let parts = part_errors(&judged.runs, ready);
            row.test = Some(LearnTest { parts, ..test(&judged.score, &ready.data.unit) });
            row.validation = validation(judged.validation, ready);
            row.coefficients = coefficients(made, truth);
            row.equation = made.equation();
            row.torque_error =
                truth.and_then(|truth| truth.torque_error(made)).filter(|error| error.is_finite());
            row.parameters = made.parameters();
            row.reached = LearnEnd::Trained(judged.reached);
            row.model = model.filter(|_| made.stored().is_some());
        }
    }
    row
}

/// Returns the errors of an attempt with one of several seeds.
#[must_use]
pub fn draw(seed: u64, ready: &Ready, tried: &Tried) -> LearnDraw {
    let finite = |error: f64| Some(error).filter(|error| error.is_finite());
    let Ok(judged) = &tried.fitted else {
        return LearnDraw { seed, free_run_rmse: None, validation_rmse: None, parts: Vec::new() };
    };
    LearnDraw {
        seed,
        free_run_rmse: finite(judged.score.free_run_rmse),
        validation_rmse: finite(judged.validation),
        parts: part_errors(&judged.runs, ready),
    }
}

/// Builds the ablation rows of a learner's model: one with everything that it learned set to zero, one with
/// noise in place of past and input. Empty for other methods, which learned nothing, and for a model that
/// cannot be stored.
#[must_use]
pub fn ablation_rows(
    problem: &str,
    ready: &Ready,
    method: &Method<'_>,
    tried: &Tried,
    seed: &Seed,
) -> Vec<LearnRow> {
    let (LearnKind::Learner, Ok(judged)) = (method.kind, &tried.fitted) else { return Vec::new() };
    let (data, model) = (&ready.data, judged.model.as_ref());
    let Some(zero) = model.stored().map(|stored| stored.at_zero()) else { return Vec::new() };
    let at_zero = find(&zero.learner).map(|entry| (entry.restore)(&zero));
    let at_zero = at_zero.map(|zero| zero.map(|zero| score_of_runs(&runs(zero.as_ref(), data), data)));
    let on_noise = Ok(score_of_runs(&runs_on_noise(model, data, seed), data));
    let row = |suffix: &str, words: &str, score: Result<Score, LearnError>| LearnRow {
        problem: problem.to_owned(),
        id: format!("{}:{suffix}", method.id),
        title: format!("{}, {words}", method.title),
        kind: LearnKind::Ablation,
        test: score.as_ref().ok().map(|score| LearnTest { coverage_95: None, ..test(score, &data.unit) }),
        validation: None,
        draws: Vec::new(),
        coefficients: None,
        equation: None,
        torque_error: None,
        parameters: model.parameters(),
        seconds: 0.0,
        reached: if score.is_ok() { LearnEnd::Trained(judged.reached) } else { LearnEnd::Failed },
        failure: score.err().map(|error| error.to_string()),
        model: None,
    };
    let zero = at_zero.map(|score| row("at-zero", "what it learned at zero", score));
    zero.into_iter().chain([row("on-noise", "given noise", on_noise)]).collect()
}

/// Sorts rows by their error in free runs, the best first and failed ones last; ablations come after all
/// others.
pub fn sort(rows: &mut [LearnRow]) {
    let error =
        |row: &LearnRow| row.test.as_ref().and_then(|test| test.free_run_rmse).unwrap_or(f64::INFINITY);
    let ablated = |row: &LearnRow| row.kind == LearnKind::Ablation;
    rows.sort_by(|a, b| ablated(a).cmp(&ablated(b)).then(error(a).total_cmp(&error(b))));
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
        parts: Vec::new(),
    }
}

/// Returns the error of each free run on a stated test part; empty for records that are split.
fn part_errors(runs: &[Run], ready: &Ready) -> Vec<LearnPartError> {
    let error = |run: &Run| {
        let free_run_rmse = Some(run_error(run)).filter(|error| error.is_finite());
        LearnPartError { part: run.name.clone(), free_run_rmse }
    };
    if ready.parts.is_empty() { Vec::new() } else { runs.iter().map(error).collect() }
}

/// Returns the stated test parts of a data set, with what others published for them.
fn parts(ready: &Ready) -> Vec<LearnPart> {
    let told = |part: &Trajectory| {
        let stated = ready.parts.iter().find(|stated| stated.id == part.name())?;
        let published = stated.published().into_iter();
        let published =
            published.map(|own| LearnPublished { name: own.name, free_run_rmse: own.error }).collect();
        Some(LearnPart { id: stated.id.clone(), samples: part.len(), published })
    };
    ready.data.test.iter().filter_map(told).collect()
}

fn validation(free_run_rmse: f64, ready: &Ready) -> Option<LearnValidation> {
    let over_noise = free_run_rmse / ready.data.noise;
    over_noise.is_finite().then_some(LearnValidation { free_run_rmse, over_noise })
}

fn coefficients(
    model: &dyn learn::Model,
    truth: Option<&Truth>,
) -> Option<BTreeMap<String, LearnCoefficient>> {
    let errors: Vec<_> =
        truth.and_then(|truth| truth.coefficient_errors(model)).into_iter().flatten().collect();
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
    // A term of the truth that the law lacks is listed with a value of 0. A simulator's coefficients have
    // other names.
    let is_law = errors.iter().any(|error| all.contains_key(&error.name));
    for error in errors.into_iter().filter(|_| is_law) {
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

/// Builds a data set's row in results; `ready` is the data set, or the reason why its records are missing.
#[must_use]
pub fn described(id: &str, title: &str, origin: Origin, ready: Result<&Ready, &String>) -> LearnProblem {
    let mut described = LearnProblem {
        id: id.to_owned(),
        title: title.to_owned(),
        origin,
        absent: ready.err().cloned(),
        unit: String::new(),
        data: LearnData::default(),
        training_samples: 0,
        rate_hz: 0.0,
        period_s: 0.0,
        warm_up_s: 0.0,
        noise: 0.0,
        test_s: 0.0,
        parts: Vec::new(),
        input_hold: None,
        missing: Vec::new(),
    };
    if let Ok(ready) = ready {
        let data = &ready.data;
        described.unit.clone_from(&data.unit);
        described.missing.clone_from(&ready.missing);
        described.data = LearnData {
            records: ready.records,
            train: data.train.len(),
            validation: data.validation.len(),
            test: data.test.len(),
        };
        described.parts = parts(ready);
        described.training_samples = data.training_samples();
        if let Some(first) = data.train.first() {
            described.rate_hz = first.rate_hz();
        }
        described.period_s = data.period_s;
        described.warm_up_s = data.warm_up_s;
        described.noise = data.noise;
        described.input_hold = data.is_driven().then(|| data.hold.name().to_owned());
        let whole: f64 = data.test.iter().map(|part| part.duration_s() - data.warm_up_s).sum();
        described.test_s = whole / data.test.len().max(1) as f64;
    }
    described
}
