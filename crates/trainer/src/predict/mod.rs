//! `task = "predict"`: many methods, classical and learned, scored on peaks that they did not see.

pub(crate) mod problem;
mod split;
mod summary;
mod tally;
mod trial;
mod verdict;

use crate::Outcome;
use crate::cli::{ExperimentArguments, Output};
use crate::console;
use crate::error::TrainerError;
use crate::interrupt::Saving;
use crate::method::Method;
use crate::progress::Progress;
use crate::rerender::write_report;
use crate::resume::{Beginning, Begun, DataFile, Ledger, begin, end};
use crate::run::thread_pool;
use crate::watcher::{Place, Watcher};
use estimator::Cancel;
use experiment::PredictionStudy;
use problem::{Missing, Ready, prepare};
use rayon::ThreadPool;
use rayon::prelude::*;
use report::prediction_markdown;
use runs::result::{
    ExponentialScores, NOT_BEGUN, PredictionCsvRow, PredictionOutcome, PredictionResult, PredictionRow,
    ProblemOutcome, ProblemRow, ProblemStudy, RESULT_SCHEMA, SplitSummary,
};
use runs::{RunFolder, to_csv};
use serde_json::json;
use split::SplitKind;
use std::time::Instant;
use tally::{Placed, adjust, outcome, score};
use trial::{Trials, best_exponential};

/// Name of the best exponential in `predictions.csv`.
const EXPONENTIAL: &str = "best-exponential";

/// All trials on one problem: those of the best exponential, and of every method.
struct ProblemTrials {
    exponential: Vec<Placed>,
    methods: Vec<Vec<Placed>>,
}

impl ProblemTrials {
    /// Whether some trial was not begun.
    fn is_interrupted(&self) -> bool {
        let not_begun = |placed: &Placed| placed.trial.as_ref().is_err_and(|reason| reason == NOT_BEGUN);
        self.methods.iter().flatten().any(not_begun)
    }
}

/// Prepares every problem, fits every method on every draw and split, keeps going where one fails, and puts
/// the tables together.
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
    let methods = choose(study)?;
    if problems.is_empty() || methods.is_empty() {
        return Err(TrainerError::NothingToFit);
    }
    for missing in problems.iter().filter_map(|problem| problem.as_ref().err()) {
        if !output.quiet {
            console::remark(&format!("ABSENT: problem.{}: {}", missing.id, missing.reason));
        }
    }
    let pool = thread_pool(arguments)?;
    let folder = match begin(arguments, &beginning(study, &pool, &problems))? {
        Begun::Open(folder) => folder,
        Begun::Finished(outcome) => return Ok(outcome),
    };
    let ledger = Ledger::open(&folder, study.checkpoint)?;
    let start = Instant::now();
    let methods = pretrain(study, methods, &pool, cancel, &ledger)?;
    let trials = run_all(study, &problems, &methods, &pool, cancel, &ledger, output)?;
    let _saving = Saving::begin();
    // A request that comes after the last trial interrupts nothing.
    let interrupted = cancel.is_requested() && trials.iter().any(ProblemTrials::is_interrupted);
    if interrupted {
        ledger.flush()?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let rows = csv_rows(&problems, &methods, &trials);
    let result = result(study, &problems, &methods, &trials, seconds);
    keep(&folder, &result, &rows)?;
    end(&folder, interrupted, output.quiet, &json!({ "problems": result.problems.len() }))?;
    output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(if interrupted { Outcome::Interrupted } else { Outcome::Done })
}

/// The methods named, or all that there are.
pub(crate) fn choose(study: &PredictionStudy) -> Result<Vec<Method>, TrainerError> {
    let mut methods = Method::all()?;
    if let Some(names) = &study.settings.methods {
        methods.retain(|method| names.iter().any(|name| name == method.id()));
    }
    Ok(methods)
}

/// What the run is made of.
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

/// Amortized methods are trained once, for all problems.
fn pretrain(
    study: &PredictionStudy,
    methods: Vec<Method>,
    pool: &ThreadPool,
    cancel: &'static Cancel,
    ledger: &Ledger,
) -> Result<Vec<Method>, TrainerError> {
    let (seed, cap) = (study.seed, study.settings.max_steps);
    let progress = Progress::over_fits(methods.len() as u64, true);
    let train = |method: Method| {
        let name = format!("training of {}", method.id());
        let watcher = Watcher::new(&progress, Some(Place { ledger, name: &name }))?;
        let trained = method.pretrained(seed, cap, cancel, &watcher);
        trained.map_err(|error| watcher.failure().unwrap_or(error))
    };
    pool.install(|| methods.into_par_iter().map(train).collect())
}

/// Every trial there is to make, in the order of problems, methods, draws and splits, whatever the threads.
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
    // A replicate is fitted with a seed of its own, so that its start values are no part of what they share.
    let last = study.seed.checked_add(study.settings.draws as u64);
    last.ok_or(TrainerError::TooManySeeds { seed: study.seed })?;
    // Methods innermost: the slow ones are then spread over the whole list.
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
    let progress = Progress::over_fits(jobs.len() as u64, silent);
    let trials = Trials { max_steps: study.settings.max_steps, progress: &progress, cancel, ledger };
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
            exponential: exponentials(problem),
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

fn exponentials(problem: &Ready) -> Vec<Placed> {
    let mut placed = Vec::new();
    for (draw, envelope) in problem.envelopes.iter().enumerate() {
        for split_at in problem.splits_of(draw) {
            if let Some(split) = problem.splits.get(split_at) {
                let trial = best_exponential(problem, envelope, split);
                placed.push(Placed { draw, split: split_at, trial });
            }
        }
    }
    placed
}

fn result(
    study: &PredictionStudy,
    problems: &[Result<Ready, Missing>],
    methods: &[Method],
    trials: &[ProblemTrials],
    seconds: f64,
) -> PredictionResult {
    let mut trials = trials.iter();
    let problems = problems
        .iter()
        .map(|problem| match problem {
            Ok(ready) => ProblemRow {
                id: ready.id.clone(),
                title: ready.title.clone(),
                origin: ready.origin.clone(),
                outcome: trials.next().and_then(|trials| examine(study, ready, methods, trials)).map_or_else(
                    || absent("no exponential could be fitted"),
                    |study| ProblemOutcome::Studied(Box::new(study)),
                ),
            },
            Err(missing) => ProblemRow {
                id: missing.id.clone(),
                title: missing.title.clone(),
                origin: missing.origin.clone(),
                outcome: absent(&missing.reason),
            },
        })
        .collect();
    let settings = &study.settings;
    PredictionResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "predict".to_owned(),
        seed: study.seed,
        splits: SplitSummary {
            block_peaks: settings.block_peaks,
            every: settings.every,
            last_share: settings.last_share,
            significance: settings.significance,
        },
        problems,
        seconds,
    }
}

fn absent(reason: &str) -> ProblemOutcome {
    ProblemOutcome::Absent { reason: reason.to_owned() }
}

/// All scores of a problem; `None` where not even an exponential can be fitted.
fn examine(
    study: &PredictionStudy,
    ready: &Ready,
    methods: &[Method],
    trials: &ProblemTrials,
) -> Option<ProblemStudy> {
    let common = study.settings.draws_seeded;
    let reference = |kind| score(ready, &trials.exponential, kind, common, None);
    let exponential = ExponentialScores {
        interpolation: reference(SplitKind::Interpolation)?,
        extrapolation: reference(SplitKind::Extrapolation)?,
    };
    let mut rows: Vec<PredictionRow> = methods
        .iter()
        .zip(&trials.methods)
        .map(|(method, placed)| PredictionRow {
            number: method.number(),
            id: method.id().to_owned(),
            title: method.title().to_owned(),
            family: method.family().to_owned(),
            outcome: outcome(ready, placed, &trials.exponential, common),
        })
        .collect();
    let pairs = rows
        .iter_mut()
        .filter_map(|row| match &mut row.outcome {
            PredictionOutcome::Scored(scores) => Some(scores),
            PredictionOutcome::Failed { .. } => None,
        })
        .flat_map(|scores| [scores.interpolation.as_mut(), scores.extrapolation.as_mut()])
        .filter_map(|score| score?.against_exponential.as_mut())
        .collect();
    let comparisons = adjust(pairs);
    rows.sort_by(|one, other| error(one).total_cmp(&error(other)));
    let envelope = ready.envelopes.first()?;
    let mut found = ProblemStudy {
        unit: ready.unit.clone(),
        peaks: envelope.len(),
        duration_s: envelope.times_s().last().copied().unwrap_or_default(),
        data: ready.data.clone(),
        law: ready.truth.as_ref().map(|truth| truth.law.clone()),
        exponential,
        methods: rows,
        comparisons,
        verdict: Vec::new(),
    };
    found.verdict = verdict::verdict(&found, study.settings.significance);
    Some(found)
}

/// What rows are sorted by: the error of extrapolation; without one, after all that have one.
fn error(row: &PredictionRow) -> f64 {
    match &row.outcome {
        PredictionOutcome::Scored(scores) => scores.extrapolation.as_ref().map_or(f64::NAN, |score| {
            if score.rms_log_error.is_nan() { f64::INFINITY } else { score.rms_log_error }
        }),
        PredictionOutcome::Failed { .. } => f64::NAN,
    }
}

/// What each method says of each peak: of interpolation those held out, of extrapolation all. Of a
/// simulation the first draw.
fn csv_rows(
    problems: &[Result<Ready, Missing>],
    methods: &[Method],
    trials: &[ProblemTrials],
) -> Vec<PredictionCsvRow> {
    let mut rows = Vec::new();
    let ready = problems.iter().filter_map(|problem| problem.as_ref().ok());
    for (problem, trials) in ready.zip(trials) {
        add_rows(&mut rows, problem, EXPONENTIAL, &trials.exponential);
        for (method, placed) in methods.iter().zip(&trials.methods) {
            add_rows(&mut rows, problem, method.id(), placed);
        }
    }
    rows
}

fn add_rows(rows: &mut Vec<PredictionCsvRow>, problem: &Ready, method: &str, trials: &[Placed]) {
    let Some(envelope) = problem.envelopes.first() else { return };
    for placed in trials.iter().filter(|placed| placed.draw == 0) {
        let Some(split) = problem.splits.get(placed.split) else { continue };
        let Some(curve) = placed.trial.as_ref().ok().and_then(|trial| trial.curve.as_ref()) else { continue };
        let peaks = envelope.times_s().iter().zip(envelope.log_amplitudes()).zip(curve).zip(&split.held_out);
        for (index, (((&time_s, &log_amplitude), prediction), block)) in peaks.enumerate() {
            if split.kind == SplitKind::Interpolation && block.is_none() {
                continue;
            }
            rows.push(PredictionCsvRow {
                problem: problem.id.clone(),
                origin: problem.origin.clone(),
                split: split.kind.name().to_owned(),
                method: method.to_owned(),
                time_s,
                log_amplitude,
                truth: problem.truth.as_ref().and_then(|truth| truth.log_amplitudes.get(index).copied()),
                held_out: block.is_some(),
                predicted: prediction.log_amplitude,
                std_error: prediction.std_error,
            });
        }
    }
}

/// Writes everything that is left to write, the report last.
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
