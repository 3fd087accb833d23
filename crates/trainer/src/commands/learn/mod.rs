//! `task = "learn"`: learners and baselines, scored on records that they never saw.

mod keep;
mod kept;
pub(crate) mod problem;
mod summary;

use crate::error::TrainerError;
use crate::folders::resume::{Beginning, Begun, Ledger, begin, end};
use crate::options::{ExperimentArguments, Output};
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::interrupt::Saving;
use crate::terminal::progress::Progress;
use ::learn::LearnError;
use estimator::Cancel;
use experiment::{CheckpointSettings, LearnSettings, LearnStudy};
use keep::Row;
use kept::Trying;
use problem::{Prepared, prepare};
use rayon::ThreadPool;
use rayon::prelude::*;
use results::LearnKind;
use runs::RunFolder;
use serde_json::json;
use std::time::Instant;
use workflow::learning::{Method, Ready, ablation_rows, draw, methods};

/// Checkpoint settings of a training: every ten seconds, at the end of an epoch.
const KEPT: CheckpointSettings = CheckpointSettings { interval_s: 10.0, interval_steps: None };

/// Prepares every data set, fits every method on each, continues if one fails, and builds the table.
pub(crate) fn learn(
    arguments: &ExperimentArguments,
    study: &LearnStudy,
    cancel: &'static Cancel,
) -> Result<Outcome, TrainerError> {
    let output = arguments.output;
    let problems = study.problems.iter().map(prepare).collect::<Result<Vec<Prepared>, _>>()?;
    for absent in problems.iter().filter_map(|problem| problem.ready.as_ref().err()) {
        if !output.quiet {
            console::remark(&format!("ABSENT: {absent}"));
        }
    }
    let pool = arguments.thread_pool()?;
    let folder = match begin(arguments, &beginning(study, &pool, &problems))? {
        Begun::Open(folder) => folder,
        Begun::Finished(outcome) => return Ok(outcome),
    };
    perform(&Study { study, problems, folder, pool, cancel, pause_after: None, output })
}

/// Study whose folder is open for work.
pub(crate) struct Study<'a> {
    pub(crate) study: &'a LearnStudy,
    pub(crate) problems: Vec<Prepared>,
    pub(crate) folder: RunFolder,
    pub(crate) pool: ThreadPool,
    pub(crate) cancel: &'static Cancel,
    /// Number of steps of its trace after which each training pauses, to be resumed later.
    pub(crate) pause_after: Option<u64>,
    pub(crate) output: Output,
}

/// Fits every method on each data set, continues if one fails, and builds the table.
pub(crate) fn perform(of: &Study<'_>) -> Result<Outcome, TrainerError> {
    let Study { study, problems, folder, pool, output, .. } = of;
    let methods = methods(&study.settings, &study.resolved)?;
    let start = Instant::now();
    let ledger = Ledger::open(folder, KEPT)?;
    let trying = Trying {
        seed: study.seed,
        max_steps: study.settings.max_steps,
        cancel: of.cancel,
        pause_after: of.pause_after,
        ledger: &ledger,
        mark: "",
    };
    let tried = try_all(&trying, problems, &methods, pool, (output.quiet || output.json, &study.settings))?;
    let _saving = Saving::begin();
    let interrupted = tried.iter().any(|row| matches!(row.tried.fitted, Err(LearnError::Interrupted)));
    let result = keep::result(study, problems, &tried, start.elapsed().as_secs_f64());
    if interrupted {
        ledger.flush()?;
    }
    keep::write(folder, &result, &tried)?;
    end(folder, interrupted, output.quiet, &json!({ "problems": result.problems.len() }))?;
    output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(Outcome::of(interrupted, true))
}

/// Returns the inputs that define the run.
pub(crate) fn beginning<'a>(
    study: &'a LearnStudy,
    pool: &ThreadPool,
    problems: &[Prepared],
) -> Beginning<'a> {
    Beginning {
        name: &study.name,
        seed: study.seed,
        config: study.resolved.to_toml(),
        data: problems.iter().flat_map(|problem| problem.files.iter().cloned()).collect(),
        threads: pool.current_num_threads(),
    }
}

/// Fits every method on every available data set. The order is that of the configuration, whatever the number
/// of threads.
fn try_all<'a>(
    trying: &Trying<'_>,
    problems: &'a [Prepared],
    methods: &'a [Method<'a>],
    pool: &ThreadPool,
    (silent, settings): (bool, &LearnSettings),
) -> Result<Vec<Row<'a>>, TrainerError> {
    let seeds = |method: &Method<'_>| match settings.redrawn.iter().any(|name| name == method.id) {
        true => settings.seeds,
        false => 1,
    };
    let jobs: Vec<(&Prepared, &Ready, &Method<'_>, u64)> = problems
        .iter()
        .filter_map(|problem| Some((problem, problem.ready.as_ref().ok()?)))
        .flat_map(|(problem, ready)| methods.iter().map(move |method| (problem, ready, method)))
        .filter(|(_, ready, method)| method.kind != LearnKind::Reference || ready.truth.is_some())
        .flat_map(|(problem, ready, method)| {
            (0..seeds(method)).map(move |draw| (problem, ready, method, draw))
        })
        .collect();
    let progress = Progress::over(jobs.len() as u64, "fits", silent);
    let all: Result<Vec<(Row<'a>, u64)>, TrainerError> = pool.install(|| {
        jobs.into_par_iter()
            .map(|(problem, ready, method, draw)| {
                let mark = if draw == 0 {
                    String::new()
                } else {
                    format!("/seed-{}", trying.seed.wrapping_add(draw))
                };
                let trying = Trying { seed: trying.seed.wrapping_add(draw), mark: &mark, ..*trying };
                let tried = trying.tried(&problem.id, ready, method)?;
                let seed = trying.seed_of(&problem.id, method);
                let ablated = match settings.ablations && draw == 0 {
                    true => ablation_rows(&problem.id, ready, method, &tried, &seed),
                    false => Vec::new(),
                };
                progress.one_of_many_done();
                Ok((Row { problem, ready, method, tried, ablated, draws: Vec::new() }, trying.seed))
            })
            .collect()
    });
    progress.finish();
    Ok(with_draws(all?, trying.seed))
}

/// Collects the rows of further seeds in those of the study's own seed.
fn with_draws<'a>(all: Vec<(Row<'a>, u64)>, own: u64) -> Vec<Row<'a>> {
    let mut rows: Vec<Row<'a>> = Vec::new();
    for (row, seed) in all {
        let told = draw(seed, row.ready, &row.tried);
        match rows.last_mut().filter(|_| seed != own) {
            None => rows.push(Row { draws: vec![told], ..row }),
            Some(first) => {
                first.draws.push(told);
                // A study that was stopped in one of its seeds goes on there.
                if matches!(row.tried.fitted, Err(LearnError::Interrupted)) {
                    first.tried.fitted = Err(LearnError::Interrupted);
                }
            }
        }
    }
    rows
}
