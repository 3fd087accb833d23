//! `task = "learn"`: learners beside baselines, on records that they never saw.

mod keep;
pub(crate) mod problem;
mod summary;

use crate::error::TrainerError;
use crate::folders::resume::{Beginning, Begun, begin, end};
use crate::options::ExperimentArguments;
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::interrupt::Saving;
use crate::terminal::progress::Progress;
use ::learn::LearnError;
use estimator::Cancel;
use experiment::LearnStudy;
use keep::Row;
use problem::{Prepared, prepare};
use rayon::ThreadPool;
use rayon::prelude::*;
use results::LearnKind;
use seed::Seed;
use serde_json::json;
use std::time::Instant;
use workflow::learning::{Method, Ready, methods};

/// Prepares every data set, fits every method on each, keeps going where one fails, and puts the table together.
pub(crate) fn learn(
    arguments: &ExperimentArguments,
    study: &LearnStudy,
    cancel: &'static Cancel,
) -> Result<Outcome, TrainerError> {
    let output = arguments.output;
    let problems = study.problems.iter().map(prepare).collect::<Result<Vec<Prepared>, _>>()?;
    let methods = methods(&study.settings, &study.resolved)?;
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
    let start = Instant::now();
    let tried = try_all(study, &problems, &methods, &pool, cancel, output.quiet || output.json);
    let _saving = Saving::begin();
    let interrupted = tried.iter().any(|row| matches!(row.tried.fitted, Err(LearnError::Interrupted)));
    let result = keep::result(study, &problems, &tried, start.elapsed().as_secs_f64());
    keep::write(&folder, &result, &tried)?;
    end(&folder, interrupted, output.quiet, &json!({ "problems": result.problems.len() }))?;
    output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(if interrupted { Outcome::Interrupted } else { Outcome::Done })
}

/// What the run is made of.
fn beginning<'a>(study: &'a LearnStudy, pool: &ThreadPool, problems: &[Prepared]) -> Beginning<'a> {
    Beginning {
        name: &study.name,
        seed: study.seed,
        config: study.resolved.to_toml(),
        data: problems.iter().flat_map(|problem| problem.files.iter().cloned()).collect(),
        threads: pool.current_num_threads(),
    }
}

/// Every method on every data set that is there, in the order of the configuration, whatever the threads.
fn try_all<'a>(
    study: &LearnStudy,
    problems: &'a [Prepared],
    methods: &'a [Method<'a>],
    pool: &ThreadPool,
    cancel: &'static Cancel,
    silent: bool,
) -> Vec<Row<'a>> {
    let jobs: Vec<(&Prepared, &Ready, &Method<'_>)> = problems
        .iter()
        .filter_map(|problem| Some((problem, problem.ready.as_ref().ok()?)))
        .flat_map(|(problem, ready)| methods.iter().map(move |method| (problem, ready, method)))
        .filter(|(_, ready, method)| method.kind != LearnKind::Reference || ready.truth.is_some())
        .collect();
    let progress = Progress::over_fits(jobs.len() as u64, silent);
    let tried = pool.install(|| {
        jobs.into_par_iter()
            .map(|(problem, ready, method)| {
                let seed = Seed::new(study.seed).child("learn").child(&problem.id).child(method.id);
                let tried =
                    workflow::learning::tried(ready, method, seed, study.settings.max_steps, cancel, &|_| ());
                progress.one_of_many_done();
                Row { problem, ready, method, tried }
            })
            .collect()
    });
    progress.finish();
    tried
}
