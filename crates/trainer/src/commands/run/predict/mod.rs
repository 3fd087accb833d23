//! `task = "predict"`: many methods, classical and learned, scored on peaks that were held out.

mod summary;
mod trials;

use crate::error::TrainerError;
use crate::fits::method::Method;
use crate::fits::watcher::{Place, Watcher};
use crate::folders::page::write_report;
use crate::folders::resume::{Beginning, Begun, DataFile, Ledger, begin, end};
use crate::options::{ExperimentArguments, Output};
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::interrupt::Saving;
use crate::terminal::progress::Progress;
use estimator::Cancel;
use experiment::PredictionStudy;
use rayon::ThreadPool;
use rayon::prelude::*;
use report::prediction_markdown;
use results::{PredictionCsvRow, PredictionResult};
use runs::{RunFolder, to_csv};
use serde_json::json;
use std::time::Instant;
use studies::{
    Missing, Placed, ProblemTrials, Ready, StudiedMethod, best_exponentials, csv_rows, prepare, result,
};
use trials::Trials;

/// Prepares every problem, fits every method on every draw and split, continues if one fails, and builds the
/// tables.
pub(crate) fn predict(
    arguments: &ExperimentArguments,
    study: &PredictionStudy,
    cancel: &'static Cancel,
) -> Result<Outcome, TrainerError> {
    let output = arguments.output;
    let problems = study
        .problems
        .iter()
        .map(|problem| prepare(study, problem))
        .collect::<Result<Vec<Result<Ready, Missing>>, _>>()?;
    let methods = Method::named(study.settings.methods.as_deref())?;
    if problems.is_empty() || methods.is_empty() {
        return Err(TrainerError::NothingToFit);
    }
    for missing in problems.iter().filter_map(|problem| problem.as_ref().err()) {
        if !output.quiet {
            console::remark(&format!("ABSENT: problem.{}: {}", missing.id, missing.reason));
        }
    }
    let pool = arguments.thread_pool()?;
    let folder = match begin(arguments, &beginning(study, &pool, &problems))? {
        Begun::Open(folder) => folder,
        Begun::Finished(outcome) => return Ok(outcome),
    };
    let ledger = Ledger::open(&folder, study.checkpoint)?;
    let start = Instant::now();
    let methods = pretrain(study, methods, &pool, cancel, &ledger)?;
    let trials = run_all(study, &problems, &methods, &pool, cancel, &ledger, output)?;
    let _saving = Saving::begin();
    // A request to stop after the last trial interrupts nothing.
    let interrupted = cancel.is_requested() && trials.iter().any(ProblemTrials::is_interrupted);
    if interrupted {
        ledger.flush()?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let columns: Vec<StudiedMethod> = methods.iter().map(Method::studied).collect();
    let rows = csv_rows(&problems, &columns, &trials);
    let result = result(study, &problems, &columns, &trials, seconds);
    keep(&folder, &result, &rows)?;
    end(&folder, interrupted, output.quiet, &json!({ "problems": result.problems.len() }))?;
    output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(Outcome::of(interrupted, true))
}

/// Returns the inputs that define the run.
fn beginning<'a>(
    study: &'a PredictionStudy,
    pool: &ThreadPool,
    problems: &[Result<Ready, Missing>],
) -> Beginning<'a> {
    let data = problems.iter().filter_map(|problem| problem.as_ref().ok()?.data.as_ref());
    let data = data.map(|data| DataFile { path: data.path.clone(), digest: data.digest.clone() }).collect();
    Beginning {
        name: &study.name,
        seed: study.seed,
        config: study.resolved.to_toml(),
        data,
        threads: pool.current_num_threads(),
    }
}

/// Trains the amortized methods, once for all problems.
fn pretrain(
    study: &PredictionStudy,
    methods: Vec<Method>,
    pool: &ThreadPool,
    cancel: &'static Cancel,
    ledger: &Ledger,
) -> Result<Vec<Method>, TrainerError> {
    let (seed, cap) = (study.seed, study.settings.max_steps);
    let progress = Progress::over(methods.len() as u64, "fits", true);
    let train = |method: Method| {
        let name = format!("training of {}", method.id());
        let watcher = Watcher::new(&progress, Some(Place { ledger, name: &name }), None)?;
        let trained = method.pretrained(seed, cap, cancel, &watcher);
        trained.map_err(|error| watcher.failure().unwrap_or(error))
    };
    pool.install(|| methods.into_par_iter().map(train).collect())
}

/// Runs every planned trial. The order is that of problems, methods, draws and splits, whatever the number of
/// threads.
fn run_all(
    study: &PredictionStudy,
    problems: &[Result<Ready, Missing>],
    methods: &[Method],
    pool: &ThreadPool,
    cancel: &'static Cancel,
    ledger: &Ledger,
    output: Output,
) -> Result<Vec<ProblemTrials>, TrainerError> {
    let ready: Vec<&Ready> = problems.iter().filter_map(|problem| problem.as_ref().ok()).collect();
    // Each draw is fitted with its own seed, so that the draws do not share start values.
    let last = study.seed.checked_add(study.settings.draws as u64);
    last.ok_or(TrainerError::TooManySeeds { seed: study.seed })?;
    // Methods are innermost, so that the slow ones are spread over the whole list.
    let jobs: Vec<(usize, usize, usize, usize)> = ready
        .iter()
        .enumerate()
        .flat_map(|(at, problem)| {
            (0..problem.envelopes.len()).flat_map(move |draw| {
                problem.splits_of(draw).flat_map(move |split| {
                    let wanted = move |method: &usize| {
                        let seeded = methods.get(*method).is_some_and(Method::draws);
                        !seeded || draw < study.settings.draws_seeded
                    };
                    (0..methods.len()).filter(wanted).map(move |method| (at, method, draw, split))
                })
            })
        })
        .collect();
    let silent = output.quiet || output.json;
    let progress = Progress::over(jobs.len() as u64, "fits", silent);
    let trials = Trials { max_steps: study.settings.max_steps, cancel, ledger };
    let done: Result<Vec<(usize, usize, Placed)>, TrainerError> = pool.install(|| {
        jobs.into_par_iter()
            .filter_map(|(at, method_at, draw, split_at)| {
                let (problem, method) = (ready.get(at)?, methods.get(method_at)?);
                let (envelope, split) = (problem.envelopes.get(draw)?, problem.splits.get(split_at)?);
                let name = format!("{} {}, draw {draw}, split {split_at}", problem.id, method.id());
                let trial = trials.run(&name, method, envelope, split, study.seed + draw as u64);
                progress.one_of_many_done();
                Some(trial.map(|trial| (at, method_at, Placed { draw, split: split_at, trial })))
            })
            .collect()
    });
    progress.finish();
    let mut all: Vec<ProblemTrials> = ready
        .iter()
        .map(|problem| ProblemTrials {
            exponential: best_exponentials(problem),
            methods: methods.iter().map(|_| Vec::new()).collect(),
        })
        .collect();
    for (at, method, placed) in done? {
        if let Some(trials) = all.get_mut(at).and_then(|problem| problem.methods.get_mut(method)) {
            trials.push(placed);
        }
    }
    Ok(all)
}

/// Writes the tables and results that are not written yet, with the report last.
fn keep(
    folder: &RunFolder,
    result: &PredictionResult,
    rows: &[PredictionCsvRow],
) -> Result<(), TrainerError> {
    folder.write("predictions.csv", &to_csv("predictions.csv", rows)?)?;
    folder.write_json("result.json", result)?;
    let text = serde_json::to_string(result)
        .map_err(|error| TrainerError::System { what: "the result", problem: error.to_string() })?;
    folder.write("tables.md", prediction_markdown(&text)?.as_bytes())?;
    write_report(folder)?;
    Ok(())
}
