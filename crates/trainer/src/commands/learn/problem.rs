//! Data sets of a learning study, read or simulated.

use crate::configured::read_document;
use crate::error::{LearnCommandError, TrainerError};
use crate::folders::resume::DataFile;
use ::learn::LearnError;
use ::learn::data::{Making, Parts, Trajectory};
use dynamics::NominalSimulator;
use experiment::{DataSettings, LearnSource, LearningProblem, PartUse, StatedPart};
use record::{Clock, Origin, read_file};
use runs::digest;
use simulator::{Plan, generate};
use std::path::{Path, PathBuf};
use workflow::learning::{Ready, check_record, trajectory};
use workflow::nominal;

/// Data set by name, ready or absent.
pub(crate) struct Prepared {
    pub(crate) id: String,
    pub(crate) title: String,
    pub(crate) origin: Origin,
    /// Data set, or the reason why its records are missing.
    pub(crate) ready: Result<Ready, String>,
    /// Files that it depends on.
    pub(crate) files: Vec<DataFile>,
}

/// Reads or simulates a data set. Missing files are not an error; an unusable data set is.
pub(crate) fn prepare(problem: &LearningProblem) -> Result<Prepared, TrainerError> {
    let prepared = |origin, files, ready| Prepared {
        id: problem.id.clone(),
        title: problem.title.clone(),
        origin,
        ready,
        files,
    };
    let (ready, origin, read) = match &problem.source {
        LearnSource::Simulation(file) => simulated(problem, file)?,
        LearnSource::Files { reading, .. } | LearnSource::Parts { reading, .. }
            if let Some(lacking) = lacking(&problem.source) =>
        {
            let origin = reading.statements().origin.unwrap_or_default();
            return Ok(prepared(origin, Vec::new(), Err(absence(problem, &lacking, reading))));
        }
        LearnSource::Files { folder, records, reading } => files(problem, folder, records, reading)?,
        LearnSource::Parts { folder, parts, reading } => parted(problem, folder, parts, reading)?,
    };
    Ok(prepared(origin, read, Ok(ready)))
}

/// Returns what is not there of a data set's files; `None` if everything is.
fn lacking(source: &LearnSource) -> Option<String> {
    let (folder, names): (&String, Vec<&String>) = match source {
        LearnSource::Simulation(_) => return None,
        LearnSource::Files { folder, .. } => (folder, Vec::new()),
        LearnSource::Parts { folder, parts, .. } => (folder, parts.iter().map(|part| &part.file).collect()),
    };
    if !Path::new(folder).is_dir() {
        return Some(format!("the folder {folder}"));
    }
    let missing = names.into_iter().map(|name| Path::new(folder).join(name)).find(|path| !path.is_file());
    missing.map(|path| format!("the file {}", path.display()))
}

/// Returns the sentence that tells where to get an absent data set.
fn absence(problem: &LearningProblem, lacking: &str, reading: &DataSettings) -> String {
    let id = &problem.id;
    let source = reading
        .source
        .as_ref()
        .map(|source| format!(" Get it from {source}, and name its folder with problem.{id}.folder=DIR"));
    let source = source.unwrap_or_default();
    format!("problem.{id}: {lacking} is not there; its rows are left out.{source}")
}

fn refused(problem: &LearningProblem) -> impl Fn(LearnError) -> TrainerError + '_ {
    |source| LearnCommandError::Data { problem: problem.id.clone(), source }.into()
}

fn simulated(problem: &LearningProblem, file: &str) -> Result<(Ready, Origin, Vec<DataFile>), TrainerError> {
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
        let made = trajectory(problem, &name, &record, record.stamps_s());
        trajectories.push(made.map_err(refused(problem))?);
    }
    let nominal = match &problem.nominal {
        Some(path) => nominal::read(Path::new(path))?.simulator,
        None => NominalSimulator::from(&drawn.nominal),
    };
    let making =
        Making { unit: unit.to_owned(), nominal: Some(nominal), ..problem.making(rate_hz(&trajectories)) };
    let data = ::learn::data_set(&trajectories, making).map_err(refused(problem))?;
    let truth = drawn.truths.into_iter().next().map(|truth| truth.system);
    let files =
        [Some(file), problem.nominal.as_deref()].into_iter().flatten().map(held).collect::<Result<_, _>>()?;
    let records = trajectories.len();
    Ok((Ready { data, records, missing: Vec::new(), truth, parts: Vec::new() }, Origin::Simulated, files))
}

fn files(
    problem: &LearningProblem,
    folder: &str,
    patterns: &[String],
    reading: &DataSettings,
) -> Result<(Ready, Origin, Vec<DataFile>), TrainerError> {
    let (mut trajectories, mut read, mut missing) = (Vec::new(), Vec::new(), Vec::new());
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
        check_record(&name, &record, &mut unit).map_err(refused(problem))?;
        missing.extend(source.reading.missing_in_words().map(|words| format!("{name}: {words}")));
        let clock = Clock::new(&record, reading.clock).map_err(|fault| fault.in_file(&source.path))?;
        let made = trajectory(problem, &name, &record, &clock.times_s);
        trajectories.push(made.map_err(refused(problem))?);
        origin = origin.or(reading.statements().origin).or(source.statements.origin);
        read.push(DataFile { path: source.path, digest: source.digest });
    }
    let nominal = problem.nominal.as_ref().map(|path| nominal::read(Path::new(path))).transpose()?;
    let making = Making {
        unit: unit.map_or("rad", |(_, unit)| unit).to_owned(),
        nominal: nominal.map(|stated| stated.simulator),
        ..problem.making(rate_hz(&trajectories))
    };
    let data = ::learn::data_set(&trajectories, making).map_err(refused(problem))?;
    let origin = origin.unwrap_or_default();
    read.extend(problem.nominal.as_deref().map(held).transpose()?);
    let records = trajectories.len();
    Ok((Ready { data, records, missing, truth: None, parts: Vec::new() }, origin, read))
}

/// Returns the sample rate of the first trajectory in Hz.
fn rate_hz(trajectories: &[Trajectory]) -> f64 {
    // Without a record there is no data set, which is refused elsewhere.
    trajectories.first().map_or(0.0, Trajectory::rate_hz)
}

/// Reads the stated parts of a data set.
fn parted(
    problem: &LearningProblem,
    folder: &str,
    stated: &[StatedPart],
    reading: &DataSettings,
) -> Result<(Ready, Origin, Vec<DataFile>), TrainerError> {
    let (mut parts, mut read, mut missing) = (Parts::default(), Vec::<DataFile>::new(), Vec::new());
    let (mut unit, mut origin) = (None, None);
    for part in stated {
        let own = reading.with_columns(part.value.as_ref(), part.input.as_ref());
        let (record, source) = read_file(&Path::new(folder).join(&part.file), &own.read_options())?;
        check_record(&part.id, &record, &mut unit).map_err(refused(problem))?;
        missing.extend(source.reading.missing_in_words().map(|words| format!("{}: {words}", part.id)));
        let clock = Clock::new(&record, own.clock).map_err(|fault| fault.in_file(&source.path))?;
        let whole = trajectory(problem, &part.id, &record, &clock.times_s).map_err(refused(problem))?;
        let rows = part.from_row..part.to_row.unwrap_or(whole.len());
        if rows.is_empty() || rows.end > whole.len() {
            let (problem, file, samples) = (problem.id.clone(), source.path, whole.len());
            let (part, from, to) = (part.id.clone(), rows.start, rows.end);
            return Err(LearnCommandError::Rows { problem, part, file, samples, from, to }.into());
        }
        let of_use = match part.usage {
            PartUse::Training => &mut parts.train,
            PartUse::Validation => &mut parts.validation,
            PartUse::Test => &mut parts.test,
        };
        of_use.push(whole.part(rows.start, rows.end));
        origin = origin.or(reading.statements().origin).or(source.statements.origin);
        if read.iter().all(|file| file.path != source.path) {
            read.push(DataFile { path: source.path, digest: source.digest });
        }
    }
    let nominal = problem.nominal.as_ref().map(|path| nominal::read(Path::new(path))).transpose()?;
    let making = Making {
        unit: unit.map_or("rad", |(_, unit)| unit).to_owned(),
        nominal: nominal.map(|stated| stated.simulator),
        ..problem.making(rate_hz(&parts.train))
    };
    let records = read.len();
    let data = ::learn::data_set_of_parts(parts, making).map_err(refused(problem))?;
    read.extend(problem.nominal.as_deref().map(held).transpose()?);
    let ready = Ready { data, records, missing, truth: None, parts: stated.to_vec() };
    Ok((ready, origin.unwrap_or_default(), read))
}

/// Lists the files that a data set depends on, without reading its records; empty if they are missing.
pub(crate) fn files_of(problem: &LearningProblem) -> Result<Vec<DataFile>, TrainerError> {
    let mut found = match &problem.source {
        LearnSource::Simulation(file) => vec![held(file)?],
        LearnSource::Files { folder, records, .. } if Path::new(folder).is_dir() => {
            let paths = records
                .iter()
                .map(|pattern| matching(problem, folder, pattern))
                .collect::<Result<Vec<_>, _>>()?
                .concat();
            paths.iter().map(|path| held(&path.display().to_string())).collect::<Result<_, _>>()?
        }
        LearnSource::Parts { folder, parts, .. } if lacking(&problem.source).is_none() => {
            let mut names: Vec<&String> = parts.iter().map(|part| &part.file).collect();
            names.dedup();
            let path = |name: &String| Path::new(folder).join(name).display().to_string();
            names.into_iter().map(|name| held(&path(name))).collect::<Result<_, _>>()?
        }
        LearnSource::Files { .. } | LearnSource::Parts { .. } => return Ok(Vec::new()),
    };
    found.extend(problem.nominal.as_deref().map(held).transpose()?);
    Ok(found)
}

/// Returns a file that the data set depends on, with the digest of its bytes.
fn held(file: &str) -> Result<DataFile, TrainerError> {
    let bytes = std::fs::read(file)
        .map_err(|error| TrainerError::Config { file: file.to_owned(), problem: error.to_string() })?;
    Ok(DataFile { path: file.to_owned(), digest: digest(&bytes) })
}

/// Returns the files of a folder that match a pattern, in alphabetical order.
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
