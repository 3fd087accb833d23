//! Frozen list of a sweep: created and checked before the first run, or reopened.

use super::arguments::SweepArguments;
use super::study::Study;
use crate::commands::learn::problem::files_of;
use crate::configured::registries;
use crate::error::SweepCommandError;
use crate::error::TrainerError;
use crate::folders::environment::Environment;
use crate::folders::resume::DataFile;
use crate::terminal::console;
use experiment::sweep::{PlannedRun, RunData, Swept, first_difference};
use results::{SWEEP_SCHEMA, SweepAxis, SweepLine, SweepManifest, SweepRecord, SweepSearch, SweepState};
use runs::{RunError, RunFolder, SweepFolder, default_root};
use serde_json::json;
use settings::Document;
use std::path::Path;

/// Run to be made: its line and its configuration.
pub(super) type Job<'a> = (&'a SweepLine, &'a str);

/// Sweep whose list of runs is frozen.
pub(super) struct FrozenSweep {
    pub(super) folder: SweepFolder,
    pub(super) manifest: SweepManifest,
    /// Configurations of the runs, in the list's order.
    pub(super) configs: Vec<String>,
}

impl FrozenSweep {
    /// Returns every run with its configuration, in the list's order.
    pub(super) fn jobs(&self) -> impl Iterator<Item = Job<'_>> {
        self.manifest.runs.iter().zip(self.configs.iter().map(String::as_str))
    }
}

/// Freezes a new sweep, or reopens the one that the arguments name.
pub(super) fn settle(arguments: &SweepArguments) -> Result<FrozenSweep, TrainerError> {
    let planned = match &arguments.config {
        Some(path) => Some((path.display().to_string(), planned(arguments, path)?)),
        None => None,
    };
    let joins = arguments.run.resume || arguments.share.shard.is_some();
    if let Some(path) = arguments.run.out.as_ref().filter(|path| SweepFolder::is_one(path)) {
        if !joins {
            return Err(SweepCommandError::Begun { folder: path.display().to_string() }.into());
        }
        return take_up(SweepFolder::open(path), planned.map(|(_, planned)| planned));
    }
    let Some((config, planned)) = planned else {
        let folder = arguments.run.out.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
        return Err(SweepCommandError::NoSweep { folder }.into());
    };
    let manifest = manifest(config, &planned)?;
    let folder = match &arguments.run.out {
        Some(path) if joins => beginning(path)?,
        Some(path) => RunFolder::create_at(path)?,
        None => RunFolder::create(&default_root(), &manifest.name)?,
    };
    let folder = SweepFolder::open(folder.path());
    let configs: Vec<String> = planned.runs.iter().map(|run| run.config.clone()).collect();
    let digests: Vec<&str> = manifest.records.iter().map(|record| record.digest.as_str()).collect();
    let environment = Environment::new(arguments.threads(), &digests.join(" "));
    let environment = serde_json::to_vec_pretty(&environment)
        .map_err(|error| TrainerError::System { what: "environment.json", problem: error.to_string() })?;
    let beside = [("config.toml", planned.text.clone().into_bytes()), ("environment.json", environment)];
    if !folder.freeze(&manifest, &configs, &beside)? {
        // Another process froze the sweep first.
        return take_up(folder, Some(planned));
    }
    folder.folder().record_event("start", &json!({ "name": manifest.name, "runs": manifest.runs.len() }))?;
    Ok(FrozenSweep { folder, manifest, configs })
}

/// Plan that results from a configuration and axes.
struct Planned {
    name: String,
    /// Text of the configuration file.
    text: String,
    axes: Vec<SweepAxis>,
    search: Option<SweepSearch>,
    runs: Vec<PlannedRun>,
}

fn planned(arguments: &SweepArguments, config: &Path) -> Result<Planned, TrainerError> {
    let study = Study::of_arguments(arguments, config)?;
    let runs = study.first_runs(arguments.search.trials())?;
    let (search, axes, name) = (study.search(arguments, &runs)?, study.axes(), study.name(config));
    Ok(Planned { name, text: study.text, axes, search, runs })
}

/// Builds the manifest of a sweep that begins now. An unreadable record is reported here rather than by its
/// runs.
fn manifest(config: String, planned: &Planned) -> Result<SweepManifest, TrainerError> {
    Ok(SweepManifest {
        schema: SWEEP_SCHEMA.to_owned(),
        name: planned.name.clone(),
        config,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        axes: planned.axes.clone(),
        records: records(&planned.runs)?,
        search: planned.search.clone(),
        runs: planned.runs.iter().map(line).collect(),
    })
}

/// Builds the manifest line of a run that was not begun.
pub(super) fn line(run: &PlannedRun) -> SweepLine {
    SweepLine {
        number: run.number,
        digest: run.digest.clone(),
        overrides: run.overrides.clone(),
        config: format!("configs/{:04}.toml", run.number),
        state: SweepState::Pending,
        run: None,
        message: None,
    }
}

/// Returns `true` if a run is still to be made or repeated.
pub(super) fn is_missing(line: &SweepLine, failed_too: bool) -> bool {
    match line.state {
        SweepState::Pending | SweepState::Interrupted => true,
        SweepState::Failed => failed_too,
        SweepState::Done | SweepState::Stopped => false,
    }
}

/// Lists the files that the runs read, each once.
fn records(runs: &[PlannedRun]) -> Result<Vec<SweepRecord>, TrainerError> {
    let mut records: Vec<SweepRecord> = Vec::new();
    let mut looked_at: Vec<&RunData> = Vec::new();
    for run in runs {
        if looked_at.contains(&&run.data) {
            continue;
        }
        looked_at.push(&run.data);
        let found = match &run.data {
            RunData::Record(path) => {
                let digest = record::file_digest(Path::new(path)).map_err(|source| {
                    let overrides = named(&run.overrides);
                    SweepCommandError::Record { number: run.number, overrides, source }
                })?;
                vec![DataFile { path: path.clone(), digest }]
            }
            RunData::Problems(problems) => {
                problems.iter().map(files_of).collect::<Result<Vec<_>, _>>()?.concat()
            }
        };
        for DataFile { path, digest } in found {
            if records.iter().all(|known| known.path != path) {
                records.push(SweepRecord { path, digest });
            }
        }
    }
    Ok(records)
}

/// Opens a folder in which a sweep may be frozen or may have been partly frozen: it is empty, or holds only
/// files of a sweep, at least the frozen configurations, which are written first.
fn beginning(path: &Path) -> Result<RunFolder, RunError> {
    match RunFolder::check_free(path) {
        Ok(()) => Ok(RunFolder::open(path)),
        Err(RunError::Occupied { path }) => {
            let known = [".lock", "configs", "config.toml", "environment.json", "sweep.json"];
            let is_ours = |name: &str| known.contains(&name) || name.starts_with(".tmp");
            let entries = std::fs::read_dir(&path);
            let mut names = entries.into_iter().flatten().flatten().map(|entry| entry.file_name());
            if path.join("configs").is_dir() && names.all(|name| is_ours(&name.to_string_lossy())) {
                Ok(RunFolder::open(&path))
            } else {
                Err(RunError::Occupied { path })
            }
        }
        Err(other) => Err(other),
    }
}

/// Reopens a frozen sweep. If the command line names a sweep, it has to be the same one.
fn take_up(folder: SweepFolder, planned: Option<Planned>) -> Result<FrozenSweep, TrainerError> {
    let shown = || folder.path().display().to_string();
    let manifest = folder
        .manifest()
        .map_err(SweepCommandError::Folder)?
        .ok_or_else(|| SweepCommandError::NoSweep { folder: shown() })?;
    if let Some(planned) = &planned
        && let Some(difference) = difference(&folder, &manifest, planned)
    {
        return Err(SweepCommandError::Edited { folder: shown(), difference }.into());
    }
    for record in &manifest.records {
        let now = record::file_digest(Path::new(&record.path))?;
        if now != record.digest {
            let (path, then) = (record.path.clone(), record.digest.clone());
            return Err(SweepCommandError::OtherRecord { path, then, now }.into());
        }
    }
    let configs = match planned {
        Some(planned) if planned.runs.len() == manifest.runs.len() => {
            planned.runs.into_iter().map(|run| run.config).collect()
        }
        _ => manifest.runs.iter().map(|line| frozen_config(&folder, line)).collect::<Result<_, _>>()?,
    };
    if manifest.version != env!("CARGO_PKG_VERSION") {
        console::remark(&format!(
            "note: version {} froze this sweep and {} continues it; their numbers may differ",
            manifest.version,
            env!("CARGO_PKG_VERSION")
        ));
    }
    Ok(FrozenSweep { folder, manifest, configs })
}

/// Reads a run's frozen configuration, if it still has the recorded digest.
fn frozen_config(folder: &SweepFolder, line: &SweepLine) -> Result<String, SweepCommandError> {
    let path = folder.path().join(&line.config);
    let file = path.display().to_string();
    let text = std::fs::read_to_string(&path).ok();
    let holds = |text: &String| {
        let swept = Document::parse(&file, text).and_then(|d| Swept::resolve(&d, &registries()));
        matches!(swept, Ok(Ok(swept)) if swept.digest() == line.digest)
    };
    let lost = || SweepCommandError::Lost { file: file.clone(), digest: line.digest.clone() };
    text.filter(holds).ok_or_else(lost)
}

/// Returns the overrides of a run in parentheses, with a leading space.
fn named(overrides: &[String]) -> String {
    if overrides.is_empty() { String::new() } else { format!(" ({})", overrides.join(" ")) }
}

/// Describes the first difference between the frozen list and the planned one.
fn difference(folder: &SweepFolder, manifest: &SweepManifest, planned: &Planned) -> Option<String> {
    if let Some(said) = other_search(manifest.search.as_ref(), planned.search.as_ref()) {
        return Some(said);
    }
    for (line, run) in manifest.runs.iter().zip(&planned.runs) {
        if line.digest == run.digest {
            continue;
        }
        let then = std::fs::read_to_string(folder.path().join(&line.config)).unwrap_or_default();
        let [then, now] = [&then, &run.config].map(|text| Document::parse("", text).unwrap_or_default());
        let said = first_difference(&then, &now).unwrap_or_else(|| "another digest".to_owned());
        return Some(format!("run {}{}: {said}", line.number, named(&line.overrides)));
    }
    let (then, now) = (manifest.runs.len(), planned.runs.len());
    // The common runs are equal: an axis has become longer or shorter at its end.
    let is_proposed_later = manifest.search.as_ref().is_some_and(|search| search.sampler.looks_at_results());
    (then != now && !(is_proposed_later && now < then)).then(|| format!("{then} runs then, {now} now"))
}

/// Describes the difference between two searches; their progress does not count.
fn other_search(then: Option<&SweepSearch>, now: Option<&SweepSearch>) -> Option<String> {
    let words = |search: Option<&SweepSearch>| {
        let Some(search) = search else { return "every combination".to_owned() };
        let aim = if search.maximize { "maximize" } else { "minimize" };
        let halving = search.halving.as_ref().map_or_else(String::new, |halving| {
            format!(", halving {} keep one in {}", halving.first_steps, halving.keep_one_in)
        });
        let SweepSearch { sampler, trials, batch, seed, measure, .. } = search;
        let sampler = sampler.name();
        format!("{sampler}, {trials} trials in batches of {batch} from seed {seed}, {aim} {measure}{halving}")
    };
    let (then, now) = (words(then), words(now));
    (then != now).then(|| format!("{then} then, {now} now"))
}
