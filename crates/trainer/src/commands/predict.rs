//! `trainer predict`: a learned model applied to a record that it never saw.

use crate::commands::diagnose::arguments::Reading;
use crate::error::{LearnCommandError, TrainerError};
use crate::options::Output;
use crate::outcome::Outcome;
use crate::terminal::table::table;
use ::learn::data::{LEAST_PAST, Trajectory};
use ::learn::learners::{LEARNERS, find};
use ::learn::{Ahead, Past, Predicted, Stored};
use clap::Args;
use record::two_digits;
use record::{Clock, Coordinate, Record};
use results::LearnSeriesRow;
use runs::{RunFolder, to_csv};
use serde::Deserialize;
use serde_json::json;
use std::path::{Path, PathBuf};
use workflow::Loaded;

/// Runs a learned model on a record.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer predict reports/runs/RUN/model/PROBLEM/sindy.safetensors record.csv
  trainer predict MODEL record.csv --value theta --unit deg --out DIR      predictions.csv and result.json in DIR")]
pub(crate) struct PredictArguments {
    /// A model that `task = "learn"` wrote: model/PROBLEM/LEARNER.safetensors in a run's folder
    pub(crate) model: PathBuf,
    /// The record
    pub(crate) record: PathBuf,
    /// Seconds of the record that the model is given before it predicts [default: as in its training]
    #[arg(long, value_name = "S")]
    pub(crate) past: Option<f64>,
    /// Folder for predictions.csv and result.json: new or empty [default: none, only the scores are printed]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Box<Reading>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Metadata on the training in a model's file.
#[derive(Debug, Clone, Deserialize)]
struct About {
    unit: String,
    warm_up_s: f64,
    noise: f64,
    driven: bool,
}

/// Predicts, scores, writes and prints.
pub(crate) fn command(arguments: &PredictArguments) -> Result<Outcome, TrainerError> {
    let file = arguments.model.display().to_string();
    let bytes = std::fs::read(&arguments.model)
        .map_err(|error| LearnCommandError::ModelFile { file: file.clone(), reason: error.to_string() })?;
    let wrong = |source| LearnCommandError::Model { file: file.clone(), source };
    let stored = Stored::from_bytes(&bytes).map_err(wrong)?;
    let entry = find(&stored.learner).ok_or_else(|| LearnCommandError::UnknownLearner {
        file: file.clone(),
        learner: stored.learner.clone(),
        known: LEARNERS.iter().map(|entry| entry.id).collect::<Vec<_>>().join(", "),
    })?;
    let model = (entry.restore)(&stored).map_err(wrong)?;
    let about: About = stored.about_as().map_err(wrong)?;
    let part = read(&arguments.record, &arguments.reading, &about)?;
    let past_s = arguments.past.unwrap_or(about.warm_up_s);
    let now = part.samples_within(past_s).max(LEAST_PAST);
    let name = || part.name().to_owned();
    if now >= part.len() {
        return Err(LearnCommandError::NothingAhead { record: name(), samples: part.len(), past_s }.into());
    }
    let cut = |column: &'_ [f64], from: usize, to: usize| column.get(from..to).unwrap_or_default().to_vec();
    let (times, values) = (part.times_s(), part.values());
    let inputs = part.input().map(|input| (cut(input, 0, now), cut(input, now, part.len())));
    let past = Past {
        times_s: times.get(..now).unwrap_or_default(),
        values: values.get(..now).unwrap_or_default(),
        input: inputs.as_ref().map(|(before, _)| before.as_slice()),
    };
    let ahead = Ahead {
        times_s: times.get(now..).unwrap_or_default(),
        input: inputs.as_ref().map(|(_, after)| after.as_slice()),
    };
    let predicted = model
        .banded_run(&past, &ahead)
        .map_err(|source| LearnCommandError::Record { record: name(), source })?;
    let observed = values.get(now..).unwrap_or_default();
    answer(arguments, &stored.learner, &about, (ahead.times_s, observed), &predicted)
}

fn answer(
    arguments: &PredictArguments,
    learner: &str,
    about: &About,
    (times, observed): (&[f64], &[f64]),
    predicted: &Predicted,
) -> Result<Outcome, TrainerError> {
    let square: f64 = observed.iter().zip(&predicted.values).map(|(a, b)| (a - b).powi(2)).sum();
    let error = (square / observed.len().max(1) as f64).sqrt();
    let covered = predicted.std.as_ref().map(|std| {
        let pairs = observed.iter().zip(&predicted.values).zip(std);
        pairs.filter(|((a, b), std)| (*a - *b).abs() <= 1.96 * **std).count() as f64
            / observed.len().max(1) as f64
    });
    let record = arguments.record.display().to_string();
    let result = json!({
        "schema": "ringdown.result/1",
        "task": "predict-record",
        "learner": learner,
        "record": record,
        "samples": observed.len(),
        "free_run_rmse": error,
        "unit": about.unit,
        "over_noise": error / about.noise,
        "coverage_95": covered,
    });
    if let Some(out) = &arguments.out {
        let stds = predicted.std.iter().flatten().copied().map(Some).chain(std::iter::repeat(None));
        let rows = times.iter().zip(observed).zip(&predicted.values).zip(stds);
        let rows: Vec<LearnSeriesRow> = rows
            .map(|(((time_s, observed), predicted), std)| LearnSeriesRow {
                problem: String::new(),
                method: learner.to_owned(),
                record: record.clone(),
                time_s: *time_s,
                observed: *observed,
                predicted: *predicted,
                std,
            })
            .collect();
        let folder = RunFolder::create_at(out)?;
        folder.write("predictions.csv", &to_csv("predictions.csv", &rows)?)?;
        folder.write_json("result.json", &result)?;
    }
    arguments.output.print(&result, || {
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let mut rows = vec![
            row("learner", learner.to_owned()),
            row("record", record.clone()),
            row("samples predicted", observed.len().to_string()),
            row("free-run error", format!("{} {}", two_digits(error), about.unit)),
            row("× noise of its training", two_digits(error / about.noise)),
        ];
        rows.extend(covered.map(|share| row("within the 95 % band", format!("{:.1} %", 100.0 * share))));
        table(&[], rows)
    })?;
    Ok(Outcome::Done)
}

fn read(path: &Path, reading: &Reading, about: &About) -> Result<Trajectory, TrainerError> {
    let coordinate = if about.unit == "m" { Coordinate::Displacement } else { Coordinate::Angle };
    let mut plain = reading.plain();
    plain.options.coordinate = Some(coordinate);
    plain.options.driven = about.driven;
    let loaded = Loaded::read(path, &plain)?;
    let record = &loaded.record;
    let name = || path.display().to_string();
    if record.unit() != about.unit {
        let wrong = ::learn::LearnError::MixedUnits {
            first: "the model".to_owned(),
            first_unit: about.unit.clone(),
            other: name(),
            other_unit: record.unit().to_owned(),
        };
        return Err(LearnCommandError::Record { record: name(), source: wrong }.into());
    }
    if record.input().is_some() != about.driven {
        let words = |has: bool| if has { "with" } else { "without" };
        let (with, without) = (words(about.driven), words(record.input().is_some()));
        return Err(LearnCommandError::Input { record: name(), with, without }.into());
    }
    let clock = loaded.believed()?;
    trajectory(record, &clock, name())
}

fn trajectory(record: &Record, clock: &Clock, name: String) -> Result<Trajectory, TrainerError> {
    let first = clock.start_s();
    let times = clock.times_s.iter().map(|time| time - first).collect();
    let input = record.input().map(<[f64]>::to_vec);
    let made = Trajectory::new(name.clone(), times, record.values().to_vec(), input);
    made.map_err(|source| LearnCommandError::Record { record: name, source }.into())
}
