//! `task = "learn"`: learners beside baselines, on records that they never saw.

mod keep;
pub(crate) mod problem;
mod summary;

use crate::error::TrainerError;
use crate::folders::resume::{Beginning, Begun, DataFile, begin, end};
use crate::options::ExperimentArguments;
use crate::outcome::Outcome;
use crate::terminal::console;
use crate::terminal::interrupt::Saving;
use crate::terminal::progress::Progress;
use ::learn::baselines::{BASELINES, exact};
use ::learn::data::DataSet;
use ::learn::judge::{Run, Score, Truth, runs, score};
use ::learn::learners::LEARNERS;
use ::learn::{Context, Fitted, LearnError, Model, Step};
use estimator::Cancel;
use experiment::{LearnSettings, LearnStudy};
use problem::{Prepared, Ready, prepare};
use rayon::prelude::*;
use seed::Seed;
use serde_json::json;
use settings::{Resolved, SettingsError};
use std::sync::Mutex;
use std::time::Instant;

/// Form of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Learner,
    Baseline,
    Reference,
}

impl Form {
    fn name(self) -> &'static str {
        match self {
            Self::Learner => "learner",
            Self::Baseline => "baseline",
            Self::Reference => "reference",
        }
    }
}

type Make<'a> = Box<dyn Fn(&Ready, &Context<'_>) -> Result<Fitted, LearnError> + Send + Sync + 'a>;

/// A row to be: what makes its model.
pub(crate) struct Method<'a> {
    pub(crate) id: &'static str,
    pub(crate) title: &'static str,
    pub(crate) form: Form,
    make: Make<'a>,
}

/// What a method gave on a problem.
pub(crate) struct Tried {
    pub(crate) fitted: Result<Judged, LearnError>,
    pub(crate) seconds: f64,
    pub(crate) steps: Vec<Step>,
}

/// A model with its scores.
pub(crate) struct Judged {
    pub(crate) model: Box<dyn Model>,
    pub(crate) reached: &'static str,
    pub(crate) score: Score,
    pub(crate) runs: Vec<Run>,
}

/// The methods that a configuration asks for, in the order of the registries.
pub(crate) fn methods<'a>(
    settings: &LearnSettings,
    resolved: &Resolved,
) -> Result<Vec<Method<'a>>, SettingsError> {
    let wanted = |names: &Option<Vec<String>>, id: &str| {
        names.as_ref().is_none_or(|names| names.iter().any(|name| name == id))
    };
    let mut methods: Vec<Method<'a>> = Vec::new();
    for entry in LEARNERS.iter().filter(|entry| wanted(&settings.learners, entry.id)) {
        let learner = (entry.build)(resolved)?;
        let make: Make<'a> = Box::new(move |ready, context| learner.fit(&ready.data, context));
        methods.push(Method { id: entry.id, title: entry.title, form: Form::Learner, make });
    }
    for baseline in BASELINES.iter().filter(|baseline| wanted(&settings.baselines, baseline.id)) {
        let make: Make<'a> = Box::new(|ready, context| (baseline.make)(&ready.data, context));
        methods.push(Method { id: baseline.id, title: baseline.title, form: Form::Baseline, make });
    }
    let make: Make<'a> = Box::new(|ready, context| match &ready.truth {
        Some(system) => exact(system, &ready.data, context),
        None => {
            Err(LearnError::Unsolvable { what: "exact fit", problem: "the truth is not known".to_owned() })
        }
    });
    methods.push(Method { id: "exact", title: "True law, fitted exactly", form: Form::Reference, make });
    Ok(methods)
}

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
    let files =
        problems.iter().filter_map(|problem| problem.ready.as_ref().ok()).flat_map(|ready| &ready.files);
    let beginning = Beginning {
        name: &study.name,
        seed: study.seed,
        config: study.resolved.to_toml(),
        data: files.map(|file| DataFile { path: file.path.clone(), digest: file.digest.clone() }).collect(),
        threads: pool.current_num_threads(),
    };
    let folder = match begin(arguments, &beginning)? {
        Begun::Open(folder) => folder,
        Begun::Finished(outcome) => return Ok(outcome),
    };
    let start = Instant::now();
    let jobs: Vec<(&Prepared, &Ready, &Method<'_>)> = problems
        .iter()
        .filter_map(|problem| Some((problem, problem.ready.as_ref().ok()?)))
        .flat_map(|(problem, ready)| methods.iter().map(move |method| (problem, ready, method)))
        .filter(|(_, ready, method)| method.form != Form::Reference || ready.truth.is_some())
        .collect();
    let progress = Progress::over_fits(jobs.len() as u64, output.quiet || output.json);
    let tried: Vec<Tried> = pool.install(|| {
        jobs.par_iter()
            .map(|(problem, ready, method)| {
                let seed = Seed::new(study.seed).child("learn").child(&problem.id).child(method.id);
                let tried = attempt(ready, method, seed, study.settings.max_steps, cancel);
                progress.one_of_many_done();
                tried
            })
            .collect()
    });
    progress.finish();
    let _saving = Saving::begin();
    let interrupted = tried.iter().any(|tried| matches!(tried.fitted, Err(LearnError::Interrupted)));
    let tried: Vec<keep::Row<'_>> = jobs
        .iter()
        .zip(tried)
        .map(|((problem, ready, method), tried)| keep::Row { problem, ready, method, tried })
        .collect();
    let result = keep::result(study, &problems, &tried, start.elapsed().as_secs_f64());
    keep::write(&folder, &result, &tried)?;
    end(&folder, interrupted, output.quiet, &json!({ "problems": result.problems.len() }))?;
    output.print(&result, || summary::summary(&result, folder.path()))?;
    Ok(if interrupted { Outcome::Interrupted } else { Outcome::Done })
}

fn attempt(
    ready: &Ready,
    method: &Method<'_>,
    seed: Seed,
    max_steps: Option<u64>,
    cancel: &'static Cancel,
) -> Tried {
    let steps = Mutex::new(Vec::new());
    let observe = |step: &Step| {
        if let Ok(mut steps) = steps.lock() {
            steps.push(step.clone());
        }
    };
    let context = Context { seed, max_steps, cancel, observe: &observe };
    let start = Instant::now();
    let fitted = context.check().and_then(|()| (method.make)(ready, &context));
    let seconds = start.elapsed().as_secs_f64();
    let fitted = fitted.map(|fitted| judged(fitted, &ready.data));
    Tried { fitted, seconds, steps: steps.into_inner().unwrap_or_default() }
}

fn judged(fitted: Fitted, data: &DataSet) -> Judged {
    let runs = runs(fitted.model.as_ref(), data);
    let score = score(fitted.model.as_ref(), &runs, data);
    Judged { reached: fitted.reached.name(), score, runs, model: fitted.model }
}

/// The truth of a problem's records at visited states, where it is a function of the state.
pub(crate) fn truth_of(ready: &Ready) -> Option<Truth> {
    ready.truth.as_ref().and_then(|system| Truth::new(system, &ready.data).ok().flatten())
}
