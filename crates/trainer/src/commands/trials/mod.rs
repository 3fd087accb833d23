//! `trainer trials`: withheld-effect trials of the diagnosis.

pub(crate) mod arguments;
mod ask;
mod baselines;
mod each;
mod files;
mod make;
mod open;
mod summary;

use crate::configured::{check_task, read_config};
use crate::error::{TrainerError, TrialsError};
use crate::folders::environment::Environment;
use crate::folders::page::write_report;
use crate::options::ExperimentArguments;
use crate::outcome::Outcome;
use crate::share::{Launcher, Work, launch};
use crate::terminal::interrupt;

use arguments::TrialsArguments;
use estimator::Cancel;
use experiment::sweep::first_difference;
use open::Opened;
use rayon::ThreadPool;
use record::counted;
use results::{RESULT_SCHEMA, TrialsManifest, TrialsResult, TrialsShare};
use runs::{Disk, RunError, RunFolder, to_csv};
use serde_json::json;
use settings::Document;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;
use trials::{Gate, TrialPlan, Trials, case_rows, misses_a_bar, misses_the_gate, most_common};

/// Name of the file with the scores.
const RESULT: &str = "result.json";

/// Creates, diagnoses, opens and scores the cases, or scores existing answers again.
pub(crate) fn command(arguments: &TrialsArguments) -> Result<Outcome, TrainerError> {
    run(arguments, interrupt::watch()?)
}

/// Runs the trials as [`command`] does, with an existing request to stop.
pub(crate) fn run(arguments: &TrialsArguments, cancel: &Cancel) -> Result<Outcome, TrainerError> {
    let start = Instant::now();
    let pool = as_experiment(arguments).thread_pool()?;
    if let Some(folder) = &arguments.score {
        let folder = RunFolder::open(folder);
        let manifest = make::read_manifest(&folder)?
            .ok_or_else(|| TrialsError::NoTrials { folder: folder.path().display().to_string() })?;
        return finish(arguments, &folder, &manifest, &pool, &open::failed(&folder)?, cancel, start);
    }
    let document = read_config(&as_experiment(arguments))?;
    check_task(&document, "trials", "configs/trials-quick.toml")?;
    let plan = TrialPlan::resolve(&document)?;
    let folder = begin(arguments, &plan, &pool)?;
    if let Some(Launcher::Slurm) = arguments.share.launcher {
        return launched(arguments, &plan, &folder);
    }
    // Cases that another share has created are used as they are.
    let published =
        arguments.share.shard.and_then(|_| make::read_manifest(&folder).transpose()).transpose()?;
    let (manifest, made) = match published {
        Some(manifest) => (manifest, None),
        None => match make::make(arguments, &plan, &folder, &pool, cancel)? {
            Some(made) => (made.manifest.clone(), Some(made)),
            None => return interrupted(&folder, "making the cases", &go_on(&folder)),
        },
    };
    // The folder is released: the diagnosis takes time, and other shares have to create cases and write
    // answers meanwhile.
    let path = folder.path().to_owned();
    drop(folder);
    let Some(failed) = ask::ask(arguments, &RunFolder::open(&path), &manifest, cancel)? else {
        let folder = RunFolder::open(&path);
        return interrupted(&folder, "the diagnosis", &go_on(&folder));
    };
    let asked = Asked { path, manifest, made, failed };
    conclude(arguments, &plan, &pool, asked, (cancel, start))
}

/// Trials whose share has been diagnosed.
struct Asked {
    /// Folder of the trials, which is not locked meanwhile.
    path: PathBuf,
    manifest: TrialsManifest,
    /// Created cases; `None` if another share has created them.
    made: Option<make::Made>,
    /// Reasons why cases of this share have no answer.
    failed: BTreeMap<String, String>,
}

/// Opens the seals and scores once all answers are in; before that, reports the number of missing answers.
fn conclude(
    arguments: &TrialsArguments,
    plan: &TrialPlan,
    pool: &ThreadPool,
    asked: Asked,
    (cancel, start): (&Cancel, Instant),
) -> Result<Outcome, TrainerError> {
    let folder = RunFolder::wait(&asked.path)?;
    let (failed, open) = ask::answered(&folder, &asked.manifest, asked.failed);
    if open > 0 {
        return share_done(arguments, &folder, &asked.manifest, open);
    }
    if arguments.share.shard.is_some() && asked.path.join(RESULT).exists() {
        // Another share was the last to finish and has already scored.
        let file = asked.path.join(RESULT).display().to_string();
        let result = serde_json::from_str(&files::text(&folder, RESULT)?);
        let result = result.map_err(|error| TrialsError::Unreadable { file, problem: error.to_string() })?;
        return shown(arguments, &folder, &result);
    }
    let made = match asked.made {
        Some(made) => Some(made),
        None => make::make(arguments, plan, &folder, pool, cancel)?,
    };
    let Some(made) = made else { return interrupted(&folder, "making the cases", &go_on(&folder)) };
    folder.write_json(files::FAILED, &failed)?;
    // All answers are in, so the truths may be written.
    for (line, sealed) in made.manifest.cases.iter().zip(&made.sealed) {
        folder.write_reproducible(&files::truth_name(&line.id), sealed.text_to_store().as_bytes())?;
    }
    folder.record_event("opened", &json!({ "truths": made.sealed.len() }))?;
    finish(arguments, &folder, &made.manifest, pool, &failed, cancel, start)
}

/// Submits the shares to a batch system.
fn launched(
    arguments: &TrialsArguments,
    plan: &TrialPlan,
    folder: &RunFolder,
) -> Result<Outcome, TrainerError> {
    let path = folder.path().canonicalize().unwrap_or_else(|_| folder.path().to_owned());
    let mut words = vec!["trials".to_owned()];
    words.extend(arguments.config.as_ref().map(|config| config.display().to_string()));
    words.extend(arguments.overrides.iter().cloned());
    words.extend(arguments.run.seed.into_iter().flat_map(|seed| ["--seed".to_owned(), seed.to_string()]));
    words.extend(arguments.check.then(|| "--check".to_owned()));
    words.extend(["--out".to_owned(), path.display().to_string()]);
    let threads = arguments.run.threads.unwrap_or(1);
    let work = Work { name: &plan.name, folder, parts: plan.len(), part: "case", words, threads };
    launch(&arguments.share, &work, arguments.output)
}

/// Reports that a share is done while others still lack answers; the seals stay closed.
fn share_done(
    arguments: &TrialsArguments,
    folder: &RunFolder,
    manifest: &TrialsManifest,
    open: usize,
) -> Result<Outcome, TrainerError> {
    let shard = arguments.share.shard().to_string();
    folder.record_event("share", &json!({ "shard": shard, "open": open }))?;
    let result = TrialsShare {
        schema: RESULT_SCHEMA.to_owned(),
        task: "trials-share".to_owned(),
        shard,
        cases: manifest.cases.len(),
        open,
    };
    arguments.output.print(&result, || {
        format!(
            "share {} is done; {} of {} have no answer yet, and the share that gives the last one opens the seals",
            result.shard,
            open,
            counted(result.cases, "case")
        )
    })?;
    Ok(Outcome::Done)
}

/// Converts the arguments into those of an experiment: configuration, overrides, folder, threads.
fn as_experiment(arguments: &TrialsArguments) -> ExperimentArguments {
    ExperimentArguments {
        config: arguments.config.clone(),
        overrides: arguments.overrides.clone(),
        run: arguments.run.clone(),
        output: arguments.output,
        disk: Disk::default(),
    }
}

/// Opens the folder: a new one, or that of trials begun with the same configuration. The folder is locked;
/// shares and resumed trials wait for the lock, which is held while cases are created and answers are scored.
fn begin(
    arguments: &TrialsArguments,
    plan: &TrialPlan,
    pool: &ThreadPool,
) -> Result<RunFolder, TrainerError> {
    let config = plan.resolved.to_toml();
    let joins = arguments.run.resume || arguments.share.shard.is_some();
    let folder = match &arguments.run.out {
        Some(path) if joins => {
            let folder = RunFolder::wait(path)?;
            if path.join("config.toml").exists() {
                same(&folder, &config)?;
                folder.record_event("resume", &json!({ "threads": pool.current_num_threads() }))?;
                return Ok(folder);
            }
            if !folder.holds_only(&["environment.json"])? {
                return Err(RunError::Occupied { path: path.clone() }.into());
            }
            folder
        }
        Some(path) if path.join("config.toml").exists() => {
            return Err(TrialsError::Begun { folder: path.display().to_string() }.into());
        }
        _ => as_experiment(arguments).new_folder(&plan.name)?,
    };
    let digest = truth::digest(&config);
    folder.write_json("environment.json", &Environment::new(pool.current_num_threads(), &digest))?;
    folder.write("config.toml", config.as_bytes())?;
    folder.record_event("start", &json!({ "name": plan.name, "seed": plan.seed, "cases": plan.len() }))?;
    Ok(folder)
}

/// Checks that trials were begun with these values. The comments, which state where each value was set, may
/// differ.
fn same(folder: &RunFolder, config: &str) -> Result<(), TrainerError> {
    let file = folder.path().join("config.toml").display().to_string();
    let then = Document::parse(&file, &files::text(folder, "config.toml")?)?;
    let now = Document::parse("configuration", config)?;
    match first_difference(&then, &now) {
        Some(difference) => Err(TrialsError::Edited { file, difference }.into()),
        None => Ok(()),
    }
}

/// Returns the advice on continuing interrupted trials.
fn go_on(folder: &RunFolder) -> String {
    format!("continue with the same command, --out {} and --resume", folder.path().display())
}

fn interrupted(folder: &RunFolder, during: &str, remedy: &str) -> Result<Outcome, TrainerError> {
    folder.record_event("interrupted", &json!({ "during": during }))?;
    crate::terminal::console::remark(&format!("interrupted during {during}; {remedy}"));
    Ok(Outcome::Interrupted)
}

/// Opens the truths, scores, writes and prints.
fn finish(
    arguments: &TrialsArguments,
    folder: &RunFolder,
    manifest: &TrialsManifest,
    pool: &ThreadPool,
    failed: &BTreeMap<String, String>,
    cancel: &Cancel,
    start: Instant,
) -> Result<Outcome, TrainerError> {
    let silent = arguments.output.quiet || arguments.output.json;
    let Some(opened) = open::open(folder, manifest, pool, failed, (cancel, silent))? else {
        let score =
            format!("every answer is kept; trainer trials --score {} scores them", folder.path().display());
        return interrupted(folder, "the scoring", &score);
    };
    let Opened { cases, mut baselines } = opened;
    baselines.insert(0, most_common(&cases));
    let trials = Trials {
        name: manifest.name.clone(),
        seed: manifest.seed,
        left_out: manifest.left_out.clone(),
        gate: Gate::of(&Document::parse("config.toml", &files::text(folder, "config.toml")?)?)?,
        seconds: start.elapsed().as_secs_f64(),
    };
    let result = trials::score(&trials, &cases, &baselines);
    folder.write("cases.csv", &to_csv("cases.csv", &case_rows(&cases))?)?;
    folder.write_json(RESULT, &result)?;
    write_report(folder)?;
    folder.record_event("end", &json!({ "cases": result.cases, "unanswered": result.unanswered }))?;
    shown(arguments, folder, &result)
}

/// Prints the scores. The command ends with a failed check if they miss a gate or, with `--check`, a bar.
fn shown(
    arguments: &TrialsArguments,
    folder: &RunFolder,
    result: &TrialsResult,
) -> Result<Outcome, TrainerError> {
    arguments.output.print(result, || summary::summary(result, folder.path()))?;
    let misses = misses_the_gate(result) || arguments.check && misses_a_bar(result);
    Ok(arguments.share.outcome(if misses { Outcome::CheckFailed } else { Outcome::Done }))
}
