//! Catalog of run folders: reads folders that other processes left, one entry for each, whatever they
//! contain.

use crate::error::RunError;
use crate::events::{EVENTS, Event, readable};
use crate::lock::LOCK;
use crate::sweep::SweepFolder;
use jiff::Timestamp;
use results::{
    ComparisonResult, DIAGNOSIS_SCHEMA, EstimationResult, JOINTS_SCHEMA, JointRow, JointsResult, LearnEnd,
    LearnKind, LearnResult, LearnRow, LearnedScores, MethodOutcome, MethodRow, RESULT_SCHEMA, RIGS_SCHEMA,
    Reached, RigsResult, RunState, RunTableRow, SweepManifest, SweepState, TRIALS_SCHEMA,
};
use serde::Deserialize;
use serde_json::Value;
use settings::Document;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Names of a run's files; every run has at least one of them.
const FILES: [&str; 7] = [
    "config.toml",
    "events.jsonl",
    "result.json",
    "diagnosis.json",
    "joints.json",
    "rigs.json",
    "environment.json",
];

/// Run folder in the state in which it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptRun {
    /// Path of the folder.
    pub path: PathBuf,
    /// Name of the folder.
    pub name: String,
    /// State of the run, such as done or interrupted.
    pub state: RunState,
    /// Reason why there is no result; empty if there is one.
    pub reason: String,
    /// Start time: time of the first event, otherwise the time at which the folder was last changed.
    pub started: Option<Timestamp>,
    /// Task of the run; empty if unknown.
    pub task: String,
    /// Name of the estimator, or the number of methods; empty if there is none.
    pub estimator: String,
    /// One-line result of a task that has no estimate; otherwise empty.
    pub summary: String,
    /// Resolved configuration, if there is one.
    pub config: Option<Document>,
    /// One row for each fitted method, without settings; a single row without numbers if there is no
    /// estimate.
    pub rows: Vec<RunTableRow>,
}

impl KeptRun {
    /// Returns the start time in UTC, to the second; empty if unknown.
    #[must_use]
    pub fn began(&self) -> String {
        self.started.map_or_else(String::new, |time| time.strftime("%Y-%m-%d %H:%M:%S").to_string())
    }
}

/// Fields that every result has.
#[derive(Deserialize)]
struct Tag {
    schema: String,
    #[serde(default)]
    task: String,
}

/// Part of a diagnosis that the catalog reads.
#[derive(Deserialize)]
struct Diagnosed {
    verdict: Verdict,
}

#[derive(Deserialize)]
struct Verdict {
    status: String,
    effects: Vec<String>,
}

/// Content of a result, in the form of the catalog.
struct Content {
    task: String,
    estimator: String,
    summary: String,
    is_interrupted: bool,
    rows: Vec<RunTableRow>,
}

/// Lists every run folder in a folder, newest first. Skips files, hidden folders, and folders without any
/// file of a run. An empty folder counts as a run that ended before its first file.
///
/// # Errors
/// [`RunError::Io`] if the folder itself cannot be listed. A run that cannot be read is an entry of its own.
pub fn list_runs(root: &Path) -> Result<Vec<KeptRun>, RunError> {
    let entries = std::fs::read_dir(root).map_err(RunError::io(root, "list"))?;
    let mut runs = Vec::new();
    for entry in entries {
        let path = entry.map_err(RunError::io(root, "list"))?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !is_hidden && !is_something_else(&path) {
            runs.push(read_run(&path));
        }
    }
    runs.sort_by(|one, other| other.started.cmp(&one.started).then_with(|| one.name.cmp(&other.name)));
    Ok(runs)
}

/// Returns `true` if a folder is not empty and holds neither files of a run or a sweep nor a lock.
fn is_something_else(path: &Path) -> bool {
    let is_empty = std::fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none());
    !is_empty && !has_run_files(path) && !path.join(LOCK).exists() && !SweepFolder::is_one(path)
}

/// Returns `true` if a folder holds any of the files that runs have.
#[must_use]
pub fn has_run_files(path: &Path) -> bool {
    FILES.iter().any(|name| path.join(name).exists())
}

/// Reads a run's folder. A folder that cannot be read has state [`RunState::Corrupt`], with the reason.
#[must_use]
pub fn read_run(path: &Path) -> KeptRun {
    let events = events(path);
    let mut run = KeptRun {
        path: path.to_owned(),
        name: name(path),
        state: RunState::Corrupt,
        reason: String::new(),
        started: events.as_ref().and_then(|(first, _)| first.time.parse().ok()).or_else(|| changed(path)),
        task: String::new(),
        estimator: String::new(),
        summary: String::new(),
        config: None,
        rows: Vec::new(),
    };
    if SweepFolder::is_one(path) {
        sweep(&mut run);
    } else if let Err(reason) = fill(&mut run, events.map(|(_, last)| last)) {
        run.reason = reason;
    }
    if run.rows.is_empty() {
        let row = RunTableRow::without_numbers(&run.path.display().to_string(), run.state, &run.reason);
        let (task, estimator) = (run.task.clone(), run.estimator.clone());
        run.rows.push(RunTableRow { task, estimator, ..row });
    }
    for row in &mut run.rows {
        row.run = run.path.display().to_string();
        row.state = run.state;
    }
    run
}

/// Reads the result and the configuration; an error is the reason why the folder is corrupt.
fn fill(run: &mut KeptRun, last: Option<Event>) -> Result<(), String> {
    if !has_run_files(&run.path) {
        return Err("no file of a run is in it".to_owned());
    }
    let config = text(&run.path, "config.toml")?;
    if let Some(text) = &config {
        let document = Document::parse("config.toml", text).map_err(|error| error.to_string())?;
        let word =
            |key| document.get(key).and_then(|leaf| leaf.value.as_str()).unwrap_or_default().to_owned();
        (run.task, run.estimator) = (word("task"), word("estimator.name"));
        run.config = Some(document);
    }
    let mut file = "result.json";
    let mut result = None;
    for name in ["joints.json", "rigs.json", "diagnosis.json", "result.json"] {
        if result.is_none() {
            (file, result) = (name, text(&run.path, name)?);
        }
    }
    let Some(result) = result else {
        (run.state, run.reason) = without_result(last);
        return Ok(());
    };
    let content = content(&result).map_err(|problem| format!("{file}: {problem}"))?;
    if config.is_none() && file == "result.json" {
        return Err("config.toml is missing".to_owned());
    }
    run.state = if content.is_interrupted { RunState::Interrupted } else { RunState::Done };
    (run.task, run.estimator) = (content.task, content.estimator);
    (run.summary, run.rows) = (content.summary, content.rows);
    Ok(())
}

fn without_result(last: Option<Event>) -> (RunState, String) {
    match last {
        Some(last) if last.event == "failed" => {
            let message = last.details.get("message").and_then(Value::as_str).unwrap_or("no reason was kept");
            (RunState::Failed, message.to_owned())
        }
        Some(last) if last.event == "interrupted" => {
            (RunState::Interrupted, "stopped before it had a result".to_owned())
        }
        _ => (RunState::Unfinished, "no result yet: it runs, or ended before it had one".to_owned()),
    }
}

fn content(text: &str) -> Result<Content, String> {
    let tag: Tag = parse(text)?;
    match (tag.schema.as_str(), tag.task.as_str()) {
        (DIAGNOSIS_SCHEMA, _) => {
            let Verdict { status, effects } = parse::<Diagnosed>(text)?.verdict;
            let effects =
                if effects.is_empty() { String::new() } else { format!(": {}", effects.join(", ")) };
            Ok(Content::in_words("diagnose", format!("{status}{effects}")))
        }
        (JOINTS_SCHEMA, _) => {
            let found: JointsResult = parse(text)?;
            let joint = |own: &JointRow| {
                let effects = own.diagnosis.verdict.effects.join(", ");
                format!("{}: {}", own.name, if effects.is_empty() { "nothing" } else { &effects })
            };
            let joints: Vec<String> = found.joints.iter().map(joint).collect();
            Ok(Content::in_words("joints", joints.join("; ")))
        }
        (RIGS_SCHEMA, _) => {
            let found: RigsResult = parse(text)?;
            let shared = found.classes.iter().filter(|class| class.probability >= 0.5);
            let shared: Vec<&str> = shared.map(|class| class.id.as_str()).collect();
            let mut content =
                Content::in_words("rigs", format!("{} rigs: {}", found.rigs.len(), shared.join(", ")));
            content.is_interrupted = !found.complete;
            Ok(content)
        }
        (TRIALS_SCHEMA, _) => Ok(Content::in_words("trials", String::new())),
        (RESULT_SCHEMA, "estimate") => Ok(estimation(&parse(text)?)),
        (RESULT_SCHEMA, "compare") => Ok(comparison(&parse(text)?)),
        (RESULT_SCHEMA, "learn") => Ok(learning(&parse(text)?)),
        (RESULT_SCHEMA, "") => Err("field `task` is missing".to_owned()),
        (RESULT_SCHEMA, other) => Ok(Content::in_words(other, String::new())),
        (other, _) => Err(format!("its schema is \"{other}\", which this program does not read")),
    }
}

impl Content {
    fn in_words(task: &str, summary: String) -> Self {
        Self {
            task: task.to_owned(),
            estimator: String::new(),
            summary,
            is_interrupted: false,
            rows: Vec::new(),
        }
    }
}

fn estimation(result: &EstimationResult) -> Content {
    let estimate = &result.estimate;
    let row = RunTableRow {
        task: result.task.clone(),
        estimator: result.estimator.clone(),
        origin: Some(result.data.origin),
        zeta: Some(estimate.zeta),
        zeta_std_error: estimate.zeta_std_error,
        zeta_interval_95: estimate.zeta_interval_95,
        decay_rate: Some(estimate.decay_rate),
        oracle_zeta: Some(result.oracle.zeta),
        error_percent: Some(result.error_percent),
        worst_error_percent: Some(result.worst_error_percent),
        tolerance_percent: Some(result.tolerance_percent),
        reached: Some(estimate.reached),
        steps: Some(result.steps),
        parameters: Some(result.parameters),
        seconds: Some(result.seconds),
        pass: Some(result.pass),
        ..RunTableRow::without_numbers("", RunState::Done, "")
    };
    let is_interrupted = estimate.reached == Reached::Interrupted
        || result.seeds.iter().any(|seed| seed.reached == Reached::Interrupted);
    Content {
        task: result.task.clone(),
        estimator: result.estimator.clone(),
        summary: String::new(),
        is_interrupted,
        rows: vec![row],
    }
}

fn learning(result: &LearnResult) -> Content {
    let learners: Vec<&LearnRow> =
        result.results.iter().filter(|row| row.kind == LearnKind::Learner).collect();
    let said = |row: &&LearnRow| match (&row.failure, row.test.as_ref().and_then(|test| test.over_noise)) {
        (Some(failure), _) => format!("{} on {}: {failure}", row.id, row.problem),
        (None, Some(error)) => format!("{} on {}: {error:.2} times the noise", row.id, row.problem),
        (None, None) => format!("{} on {}: {}", row.id, row.problem, row.reached.name().replace('_', " ")),
    };
    let mut names: Vec<&str> = learners.iter().map(|row| row.id.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let only = match names.as_slice() {
        [] => String::new(),
        [name] => (*name).to_owned(),
        names => format!("{} learners", names.len()),
    };
    Content {
        task: result.task.clone(),
        estimator: only,
        summary: learners.iter().map(said).collect::<Vec<_>>().join("; "),
        is_interrupted: result
            .results
            .iter()
            .any(|row| row.reached == LearnEnd::Trained(Reached::Interrupted)),
        rows: learners.iter().map(|row| learner(result, row)).collect(),
    }
}

fn learner(result: &LearnResult, row: &LearnRow) -> RunTableRow {
    let problem = result.problems.iter().find(|problem| problem.id == row.problem);
    let (test, validation) = (row.test.as_ref(), row.validation.map(|part| part.over_noise));
    let has_scores = row.failure.is_none() && (test.is_some() || validation.is_some());
    RunTableRow {
        task: result.task.clone(),
        estimator: row.id.clone(),
        origin: problem.map(|problem| problem.origin),
        reason: row.failure.clone().unwrap_or_default(),
        reached: match row.reached {
            LearnEnd::Trained(reached) => Some(reached),
            LearnEnd::Failed => None,
        },
        parameters: Some(row.parameters),
        seconds: Some(row.seconds),
        learned: has_scores.then(|| LearnedScores {
            problem: row.problem.clone(),
            validation_over_noise: validation.filter(|error| error.is_finite()),
            test_over_noise: test.and_then(|test| test.over_noise),
            test_rmse: test.and_then(|test| test.free_run_rmse),
            unit: test.map_or_else(String::new, |test| test.unit.clone()),
            horizon_s: test.map(|test| test.horizon_s),
            coverage_95: test.and_then(|test| test.coverage_95),
        }),
        ..RunTableRow::without_numbers("", RunState::Done, "")
    }
}

fn comparison(result: &ComparisonResult) -> Content {
    Content {
        task: result.task.clone(),
        estimator: format!("{} methods", result.results.len()),
        summary: String::new(),
        is_interrupted: result.results.iter().any(|row| row.outcome.is_interrupted()),
        rows: result.results.iter().map(|row| method(result, row)).collect(),
    }
}

fn method(result: &ComparisonResult, row: &MethodRow) -> RunTableRow {
    let shared = RunTableRow {
        task: result.task.clone(),
        estimator: row.id.clone(),
        origin: Some(result.data.origin),
        oracle_zeta: Some(result.oracle.zeta),
        tolerance_percent: Some(result.tolerance_percent),
        pass: Some(false),
        ..RunTableRow::without_numbers("", RunState::Done, "")
    };
    match &row.outcome {
        MethodOutcome::Failed { reason } => RunTableRow { reason: reason.to_string(), ..shared },
        MethodOutcome::Estimate(found) => RunTableRow {
            zeta: Some(found.zeta),
            zeta_std_error: found.zeta_std_error,
            decay_rate: Some(found.decay_rate),
            error_percent: Some(found.error_percent),
            worst_error_percent: Some(found.worst_error_percent),
            reached: Some(found.reached),
            steps: Some(found.steps),
            parameters: Some(found.parameters),
            seconds: Some(found.seconds),
            pass: (!row.excused).then_some(found.pass),
            ..shared
        },
    }
}

/// Summarizes a sweep as one entry: the number of runs that are done.
fn sweep(run: &mut KeptRun) {
    run.task = "sweep".to_owned();
    match SweepFolder::open(&run.path).manifest() {
        Ok(Some(SweepManifest { runs, axes, .. })) => {
            let count = |state| runs.iter().filter(|line| line.state == state).count();
            let (done, failed) =
                (count(SweepState::Done) + count(SweepState::Stopped), count(SweepState::Failed));
            let keys: Vec<&str> = axes.iter().map(|axis| axis.key.as_str()).collect();
            run.estimator = format!("over {}", keys.join(", "));
            run.summary = format!("{done} of {} done, {failed} failed", runs.len());
            run.state = match done + failed == runs.len() {
                true => RunState::Done,
                false if count(SweepState::Interrupted) > 0 => RunState::Interrupted,
                false => RunState::Unfinished,
            };
        }
        Ok(None) => run.reason = "no file of a run is in it".to_owned(),
        Err(error) => run.reason = error.to_string(),
    }
}

fn name(path: &Path) -> String {
    // `.` and `..` have a name only after resolution.
    let resolved = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    resolved.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads an optional file of a run; an error if it exists and cannot be read.
fn text(path: &Path, name: &str) -> Result<Option<String>, String> {
    match std::fs::read_to_string(path.join(name)) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(format!("{name}: {error}")),
    }
}

/// Reads the first and the last readable event.
fn events(path: &Path) -> Option<(Event, Event)> {
    let bytes = std::fs::read(path.join(EVENTS)).ok()?;
    Some((readable(&bytes).next()?, readable(&bytes).next_back()?))
}

fn changed(path: &Path) -> Option<Timestamp> {
    Timestamp::try_from(path.metadata().ok()?.modified().ok()?).ok()
}

fn parse<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests;
