//! Beginning and resuming runs: a resumed run gives the same bits as an uninterrupted one.

mod difference;
mod ledger;

use crate::error::{ResumeError, TrainerError};
use crate::folders::environment::{self, Environment};
use crate::options::ExperimentArguments;
use crate::outcome::Outcome;
use crate::terminal::console;
use difference::differences;
use experiment::Experiment;
pub(crate) use ledger::{Ledger, Resumed};
use runs::{Disk, RunFolder, digest};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;

/// Events that record the progress of a run.
const START: &str = "start";
const RESUME: &str = "resume";
const INTERRUPTED: &str = "interrupted";
const END: &str = "end";
/// Event of a failed run; another attempt is made in another folder.
pub(crate) const FAILED: &str = "failed";

/// Record file of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DataFile {
    /// Path as configured.
    pub(crate) path: String,
    pub(crate) digest: String,
}

/// Inputs that define a run; resuming it requires the same ones.
pub(crate) struct Beginning<'a> {
    pub(crate) name: &'a str,
    pub(crate) seed: u64,
    /// Resolved configuration, which becomes `config.toml`.
    pub(crate) config: String,
    pub(crate) data: Vec<DataFile>,
    pub(crate) threads: usize,
}

impl<'a> Beginning<'a> {
    /// Collects the inputs of an experiment on one record, with the text of its `config.toml`.
    pub(crate) fn of(experiment: &'a Experiment, digest: &str, config: String, threads: usize) -> Self {
        let data = DataFile { path: experiment.data.path.clone(), digest: digest.to_owned() };
        Self { name: &experiment.name, seed: experiment.seed, config, data: vec![data], threads }
    }
}

/// Details of the event `start`: the inputs that define the run, as digests.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Start {
    name: String,
    seed: u64,
    /// Version of the program.
    version: String,
    /// Digest of `config.toml`.
    config: String,
    pub(crate) data: Vec<DataFile>,
}

/// Run that is open for work, or finished.
pub(crate) enum Begun {
    Open(RunFolder),
    Finished(Outcome),
}

/// Folder of a run that was reopened.
pub(crate) enum TakenUp {
    /// There is work left.
    Open(RunFolder),
    /// The run is finished.
    Finished(RunFolder),
}

/// Creates the run's folder or, with `--resume`, resumes the run in the folder that the arguments name.
pub(crate) fn begin(
    arguments: &ExperimentArguments,
    beginning: &Beginning<'_>,
) -> Result<Begun, TrainerError> {
    let Some(out) = arguments.run.out.as_ref().filter(|_| arguments.run.resume) else {
        return start(arguments.new_folder(beginning.name)?, beginning).map(Begun::Open);
    };
    let remark = |words: &str| {
        if !arguments.output.quiet {
            console::remark(words);
        }
    };
    match take_up(&arguments.disk, out, beginning, &remark)? {
        TakenUp::Open(folder) => Ok(Begun::Open(folder)),
        TakenUp::Finished(folder) => finished(arguments, &folder).map(Begun::Finished),
    }
}

/// Resumes the run in a folder, or begins it there if it was killed before it had begun. `remark` receives
/// messages for the user.
pub(crate) fn take_up(
    disk: &Disk,
    path: &Path,
    beginning: &Beginning<'_>,
    remark: &dyn Fn(&str),
) -> Result<TakenUp, TrainerError> {
    let folder = RunFolder::resume_on(disk, path)?;
    let log = folder.events()?;
    let shown = path.display();
    if let Some(line) = log.torn_line {
        remark(&format!("{shown}/events.jsonl:{line}: a crash cut the last line short; it is left out"));
    }
    let Some(begun) = started(&folder)? else {
        // The run was killed before anything was computed, or the folder is empty.
        return match folder.holds_only(&["config.toml", "environment.json", "events.jsonl"])? {
            true => start(folder, beginning).map(TakenUp::Open),
            false => Err(ResumeError::NoRun { folder: shown.to_string() }.into()),
        };
    };
    check(&folder, &begun, beginning)?;
    if log.last(END).is_some() {
        // If the program was killed after the last event, some checkpoints may be left.
        folder.remove_checkpoints()?;
        return Ok(TakenUp::Finished(folder));
    }
    check_data(&begun, &beginning.data)?;
    let ground = environment::changes(&folder.read("environment.json")?, &environment_of(beginning));
    remark(&format!("resuming {shown}"));
    for change in &ground {
        remark(&format!("note: {change}; the last digits may differ from those of an uninterrupted run"));
    }
    folder.record_event(RESUME, &json!({ "changes": ground }))?;
    Ok(TakenUp::Open(folder))
}

/// Begins a run in a folder of its own.
pub(crate) fn start(folder: RunFolder, beginning: &Beginning<'_>) -> Result<RunFolder, TrainerError> {
    let config = &beginning.config;
    folder.write("config.toml", config.as_bytes())?;
    folder.write_json("environment.json", &environment_of(beginning))?;
    let start = Start {
        name: beginning.name.to_owned(),
        seed: beginning.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        config: digest(config.as_bytes()),
        data: beginning.data.clone(),
    };
    folder.record_event(START, &start)?;
    Ok(folder)
}

fn environment_of(beginning: &Beginning<'_>) -> Environment {
    let digests: Vec<&str> = beginning.data.iter().map(|data| data.digest.as_str()).collect();
    Environment::new(beginning.threads, &digests.join(" "))
}

/// Reads the inputs with which a run was begun; `None` if its log has no start event.
pub(crate) fn started(folder: &RunFolder) -> Result<Option<Start>, TrainerError> {
    let Some(event) = folder.events()?.last(START).cloned() else { return Ok(None) };
    let begun = serde_json::from_value(event.details);
    begun.map(Some).map_err(|_| {
        let shown = folder.path().display().to_string();
        let asks = |command| ResumeError::OfAnotherCommand { folder: shown.clone(), command };
        let holds = |file| folder.path().join(file).exists();
        if holds("diagnosis.json") {
            asks("diagnose").into()
        } else if holds("cases") {
            asks("trials").into()
        } else {
            ResumeError::NoRun { folder: shown }.into()
        }
    })
}

/// Returns `true` if a run's log states that it is finished.
pub(crate) fn is_finished(folder: &RunFolder) -> Result<bool, TrainerError> {
    Ok(folder.events()?.last(END).is_some())
}

/// Reads the configuration of a run, if it is unchanged since the run was begun.
pub(crate) fn config_of(folder: &RunFolder, begun: &Start) -> Result<String, TrainerError> {
    let bytes = folder.read("config.toml")?;
    let touched =
        || ResumeError::ConfigTouched { file: folder.path().join("config.toml").display().to_string() };
    if digest(&bytes) != begun.config {
        return Err(touched().into());
    }
    Ok(String::from_utf8(bytes).map_err(|_| touched())?)
}

/// Checks that this version of the program began the run, with the same configuration.
fn check(folder: &RunFolder, begun: &Start, beginning: &Beginning<'_>) -> Result<(), TrainerError> {
    let shown = folder.path().display().to_string();
    let version = env!("CARGO_PKG_VERSION");
    if begun.version != version {
        return Err(ResumeError::OtherVersion { folder: shown, begun: begun.version.clone(), version }.into());
    }
    let differences = differences(&config_of(folder, begun)?, &beginning.config)?;
    if differences.is_empty() {
        return Ok(());
    }
    Err(ResumeError::OtherConfig { folder: shown, differences: differences.join("; ") }.into())
}

/// Checks that the records are those with which the run was begun.
pub(crate) fn check_data(begun: &Start, data: &[DataFile]) -> Result<(), ResumeError> {
    for expected in &begun.data {
        let file = expected.path.clone();
        match data.iter().find(|found| found.path == expected.path) {
            None => return Err(ResumeError::NoData { file }),
            Some(found) if found != expected => {
                let (expected, found) = (expected.digest.clone(), found.digest.clone());
                return Err(ResumeError::OtherData { file, expected, found });
            }
            Some(_) => {}
        }
    }
    Ok(())
}

/// Shows a finished run unchanged and returns its outcome again: a run that failed its check has not passed
/// since.
fn finished(arguments: &ExperimentArguments, folder: &RunFolder) -> Result<Outcome, TrainerError> {
    if arguments.output.json {
        console::result(String::from_utf8_lossy(&folder.read("result.json")?).trim_end());
    } else if !arguments.output.quiet {
        console::result(&format!("{}: this run is finished; nothing was changed", folder.path().display()));
    }
    let log = folder.events()?;
    let has_failed = log.last(END).is_some_and(|end| end.details.get("pass") == Some(&false.into()));
    Ok(if has_failed { Outcome::CheckFailed } else { Outcome::Done })
}

/// Writes the last event: the run is finished, or was interrupted and can be resumed. The checkpoints of a
/// finished run are removed.
pub(crate) fn end(
    folder: &RunFolder,
    interrupted: bool,
    quiet: bool,
    details: &impl Serialize,
) -> Result<(), TrainerError> {
    if interrupted {
        folder.record_event(INTERRUPTED, details)?;
        if !quiet {
            let shown = folder.path().display();
            console::remark(&format!(
                "interrupted; continue with the same command, --out {shown} and --resume"
            ));
        }
        return Ok(());
    }
    folder.record_event(END, details)?;
    folder.remove_checkpoints()?;
    Ok(())
}
