//! Data sets of a learning study: read or simulated.

use crate::configured::read_document;
use crate::error::{LearnCommandError, TrainerError};
use crate::folders::resume::DataFile;
use ::learn::LearnError;
use ::learn::data::{DataSet, Making, Trajectory};
use dynamics::{NominalSimulator, System};
use experiment::{DataSettings, LearnSource, LearningProblem};
use record::{Clock, Quantity, Record, read_file};
use runs::digest;
use simulator::{Plan, generate};
use std::path::{Path, PathBuf};
use workflow::nominal;

/// A data set by name, ready or absent.
pub(crate) struct Prepared {
    pub(crate) id: String,
    pub(crate) title: String,
    pub(crate) origin: String,
    /// The set, or why its records are not there.
    pub(crate) ready: Result<Ready, String>,
}

/// A data set that can be learned from.
pub(crate) struct Ready {
    pub(crate) data: DataSet,
    pub(crate) records: usize,
    pub(crate) files: Vec<DataFile>,
    /// What generated simulated records; only the judge looks at it.
    pub(crate) truth: Option<System>,
}

/// Reads or simulates a data set. Files that are absent are no error; a set that cannot be used is.
pub(crate) fn prepare(problem: &LearningProblem) -> Result<Prepared, TrainerError> {
    let prepared = |origin: &str, ready| Prepared {
        id: problem.id.clone(),
        title: problem.title.clone(),
        origin: origin.to_owned(),
        ready,
    };
    match &problem.source {
        LearnSource::Simulation(file) => Ok(prepared("simulated", Ok(simulated(problem, file)?))),
        LearnSource::Files { folder, records, reading } if Path::new(folder).is_dir() => {
            let (ready, origin) = files(problem, folder, records, reading)?;
            Ok(prepared(&origin, Ok(ready)))
        }
        LearnSource::Files { folder, reading, .. } => {
            let source = match &reading.source {
                Some(source) => {
                    format!(" Get it from {source}, and name it with problem.{}.folder=DIR", problem.id)
                }
                None => String::new(),
            };
            let reason = format!(
                "problem.{}: the folder {folder} is not there; its rows are left out.{source}",
                problem.id
            );
            let origin = reading.statements().origin.unwrap_or_default().name().to_owned();
            Ok(prepared(&origin, Err(reason)))
        }
    }
}

fn refused(problem: &LearningProblem) -> impl Fn(LearnError) -> TrainerError + '_ {
    |source| LearnCommandError::Data { problem: problem.id.clone(), source }.into()
}

fn simulated(problem: &LearningProblem, file: &str) -> Result<Ready, TrainerError> {
    let document = read_document(Path::new(file), &[], None)?;
    let plan = Plan::resolve(&document)?;
    let wrong = |reason: String| LearnCommandError::Simulation {
        problem: problem.id.clone(),
        file: file.to_owned(),
        reason,
    };
    let drawn = plan.draw(0).map_err(|error| wrong(error.to_string()))?;
    let mut trajectories = Vec::new();
    let mut unit = "rad";
    for (number, truth) in drawn.truths.iter().enumerate() {
        let record = generate(truth).map_err(|error| wrong(format!("record {number}: {error}")))?;
        unit = record.unit();
        let name = format!("record-{number:03}");
        trajectories.push(trajectory(problem, &name, &record, record.stamps_s())?);
    }
    let nominal = match &problem.nominal {
        Some(path) => nominal::read(Path::new(path))?.simulator,
        None => NominalSimulator::from(&drawn.nominal),
    };
    let making = Making { unit: unit.to_owned(), nominal: Some(nominal), ..problem.making() };
    let data = DataSet::new(&trajectories, making).map_err(refused(problem))?;
    let truth = drawn.truths.into_iter().next().map(|truth| truth.system);
    let files =
        [Some(file), problem.nominal.as_deref()].into_iter().flatten().map(held).collect::<Result<_, _>>()?;
    Ok(Ready { data, records: trajectories.len(), files, truth })
}

fn files(
    problem: &LearningProblem,
    folder: &str,
    patterns: &[String],
    reading: &DataSettings,
) -> Result<(Ready, String), TrainerError> {
    let (mut trajectories, mut read) = (Vec::new(), Vec::new());
    let mut unit: Option<(String, &'static str)> = None;
    let mut origin = None;
    for path in patterns
        .iter()
        .map(|pattern| matching(problem, folder, pattern))
        .collect::<Result<Vec<_>, _>>()?
        .concat()
    {
        let (record, source) = read_file(&path, &reading.read_options())?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if record.quantity() != Quantity::Position {
            let quantity = if record.quantity() == Quantity::Velocity { "velocity" } else { "acceleration" };
            return Err(refused(problem)(LearnError::NoPosition { record: name, quantity }));
        }
        match &unit {
            Some((first, known)) if *known != record.unit() => {
                return Err(refused(problem)(LearnError::MixedUnits {
                    first: first.clone(),
                    first_unit: (*known).to_owned(),
                    other: name,
                    other_unit: record.unit().to_owned(),
                }));
            }
            Some(_) => {}
            None => unit = Some((name.clone(), record.unit())),
        }
        let clock = Clock::new(&record, reading.clock).map_err(|fault| fault.in_file(&source.path))?;
        trajectories.push(trajectory(problem, &name, &record, &clock.times_s)?);
        origin = origin.or(reading.statements().origin).or(source.statements.origin);
        read.push(DataFile { path: source.path, digest: source.digest });
    }
    let nominal = problem.nominal.as_ref().map(|path| nominal::read(Path::new(path))).transpose()?;
    let making = Making {
        unit: unit.map_or("rad", |(_, unit)| unit).to_owned(),
        nominal: nominal.map(|stated| stated.simulator),
        ..problem.making()
    };
    let data = DataSet::new(&trajectories, making).map_err(refused(problem))?;
    let origin = origin.unwrap_or_default().name().to_owned();
    read.extend(problem.nominal.as_deref().map(held).transpose()?);
    Ok((Ready { data, records: trajectories.len(), files: read, truth: None }, origin))
}

/// A file that the data set depends on, held to its bytes.
fn held(file: &str) -> Result<DataFile, TrainerError> {
    let bytes = std::fs::read(file)
        .map_err(|error| TrainerError::Config { file: file.to_owned(), problem: error.to_string() })?;
    Ok(DataFile { path: file.to_owned(), digest: digest(&bytes) })
}

/// The files of a folder that a name stands for, in alphabetical order.
fn matching(problem: &LearningProblem, folder: &str, pattern: &str) -> Result<Vec<PathBuf>, TrainerError> {
    let whole = Path::new(folder).join(pattern).to_string_lossy().into_owned();
    let found = glob::glob(&whole).map_err(|error| LearnCommandError::Pattern {
        problem: problem.id.clone(),
        pattern: pattern.to_owned(),
        reason: error.to_string(),
    })?;
    let found: Vec<PathBuf> = found.filter_map(Result::ok).collect();
    if found.is_empty() {
        let (problem, folder, pattern) = (problem.id.clone(), folder.to_owned(), pattern.to_owned());
        return Err(LearnCommandError::NoFile { problem, folder, pattern }.into());
    }
    Ok(found)
}

/// One sample of so many, on the clock that is believed, counted from its first.
fn trajectory(
    problem: &LearningProblem,
    name: &str,
    record: &Record,
    times_s: &[f64],
) -> Result<Trajectory, TrainerError> {
    let centered = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.iter().map(|value| if problem.remove_mean { value - mean } else { *value }).collect()
    };
    let thin = |values: &[f64]| values.iter().step_by(problem.every).copied().collect::<Vec<f64>>();
    let first = times_s.first().copied().unwrap_or_default();
    let times = thin(times_s).iter().map(|time| time - first).collect();
    let input = record.input().map(|input| thin(&centered(input)));
    Trajectory::new(name, times, thin(&centered(record.values())), input).map_err(refused(problem))
}
