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
use crate::terminal::interrupt;

use arguments::TrialsArguments;
use estimator::Cancel;
use experiment::sweep::first_difference;
use open::Opened;
use rayon::ThreadPool;
use results::TrialsManifest;
use runs::{Disk, RunFolder, to_csv};
use serde_json::json;
use settings::Document;
use std::collections::BTreeMap;
use std::time::Instant;
use trials::{Gate, TrialPlan, Trials, case_rows, misses_a_bar, misses_the_gate, most_common};

/// Makes, diagnoses, opens and scores; or scores again what is there.
pub(crate) fn command(arguments: &TrialsArguments) -> Result<Outcome, TrainerError> {
    run(arguments, interrupt::watch()?)
}

/// As [`command`], where who stops it is known already.
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
    let Some(made) = make::make(arguments, &plan, &folder, &pool, cancel)? else {
        return interrupted(&folder, "making the cases", &go_on(&folder));
    };
    let Some(failed) = ask::ask(arguments, &folder, &made.manifest, cancel)? else {
        return interrupted(&folder, "the diagnosis", &go_on(&folder));
    };
    folder.write_json(files::FAILED, &failed)?;
    // The last answer is in: the truths may be seen.
    for (line, sealed) in made.manifest.cases.iter().zip(&made.sealed) {
        folder.write_reproducible(&files::truth_name(&line.id), sealed.text_to_store().as_bytes())?;
    }
    folder.record_event("opened", &json!({ "truths": made.sealed.len() }))?;
    finish(arguments, &folder, &made.manifest, &pool, &failed, cancel, start)
}

/// The arguments as those of an experiment: configuration, overrides, folder, threads.
fn as_experiment(arguments: &TrialsArguments) -> ExperimentArguments {
    ExperimentArguments {
        config: arguments.config.clone(),
        overrides: arguments.overrides.clone(),
        run: arguments.run.clone(),
        output: arguments.output,
        disk: Disk::default(),
    }
}

/// The folder: a new one, or that of trials begun with the same configuration.
fn begin(
    arguments: &TrialsArguments,
    plan: &TrialPlan,
    pool: &ThreadPool,
) -> Result<RunFolder, TrainerError> {
    let config = plan.resolved.to_toml();
    if let Some(path) = arguments.run.out.as_ref().filter(|path| path.join("config.toml").exists()) {
        let shown = path.display().to_string();
        if !arguments.run.resume {
            return Err(TrialsError::Begun { folder: shown }.into());
        }
        let folder = RunFolder::resume_on(&Disk::default(), path)?;
        let file = path.join("config.toml").display().to_string();
        let begun = files::text(&folder, "config.toml")?;
        let then = Document::parse(&file, &begun)?;
        let now = Document::parse("configuration", &config)?;
        // By value: where each was written stands in the comments, and may have changed.
        if let Some(difference) = first_difference(&then, &now) {
            return Err(TrialsError::Edited { file, difference }.into());
        }
        folder.record_event("resume", &json!({ "threads": pool.current_num_threads() }))?;
        return Ok(folder);
    }
    let folder = as_experiment(arguments).new_folder(&plan.name)?;
    folder.write("config.toml", config.as_bytes())?;
    let digest = truth::digest(&config);
    folder.write_json("environment.json", &Environment::new(pool.current_num_threads(), &digest))?;
    folder.record_event("start", &json!({ "name": plan.name, "seed": plan.seed, "cases": plan.len() }))?;
    Ok(folder)
}

/// How interrupted trials go on.
fn go_on(folder: &RunFolder) -> String {
    format!("go on with the same command, --out {} and --resume", folder.path().display())
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
    folder.write_json("result.json", &result)?;
    write_report(folder)?;
    folder.record_event("end", &json!({ "cases": result.cases, "unanswered": result.unanswered }))?;
    arguments.output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(if misses_the_gate(&result) || arguments.check && misses_a_bar(&result) {
        Outcome::CheckFailed
    } else {
        Outcome::Done
    })
}
