//! Running the experiment of a configuration: what every task shares.

use crate::Outcome;
use crate::cli::{ExperimentArguments, Output};
use crate::compare::compare;
use crate::configured::{Configured, read_document};
use crate::console;
use crate::error::TrainerError;
use crate::estimate::estimate;
use crate::fit::SeedFit;
use crate::input::Input;
use crate::interrupt;
use crate::learn::learn;
use crate::method::Method;
use crate::predict::predict;
use crate::resume::{Beginning, Begun, Ledger, begin};
use crate::simulate::simulate;
use crate::trials;
use estimator::Cancel;
use experiment::{Experiment, Task};
use rayon::ThreadPool;
use runs::result::SeedRow;
use runs::{RunFolder, default_root};
use serde::Serialize;
use settings::Document;

/// An experiment that is ready to be fitted.
pub(crate) struct Run<'a> {
    pub(crate) experiment: &'a Experiment,
    pub(crate) input: Input,
    pub(crate) folder: RunFolder,
    pub(crate) ledger: Ledger,
    pub(crate) pool: ThreadPool,
    pub(crate) cancel: &'static Cancel,
    pub(crate) output: Output,
}

/// Reads, fits, compares, writes and prints.
pub(crate) fn run(arguments: &ExperimentArguments) -> Result<Outcome, TrainerError> {
    run_until(arguments, interrupt::watch()?)
}

/// As [`run`], where who stops it is known already.
pub(crate) fn run_until(
    arguments: &ExperimentArguments,
    cancel: &'static Cancel,
) -> Result<Outcome, TrainerError> {
    let experiment = match Configured::resolve(&read_config(arguments)?)? {
        Configured::Simulation(plan) => return simulate(arguments, &plan, cancel),
        Configured::Trials(_) => return trials::run(&arguments.into(), cancel),
        Configured::Learning(study) => return learn(arguments, &study, cancel),
        Configured::Prediction(study) => return predict(arguments, &study, cancel),
        Configured::Experiment(experiment) => experiment,
    };
    let input = Input::read(&experiment)?;
    let pool = thread_pool(arguments)?;
    let config = experiment.resolved.to_toml();
    let beginning = Beginning::of(&experiment, &input, config, pool.current_num_threads());
    let folder = match begin(arguments, &beginning)? {
        Begun::Open(folder) => folder,
        Begun::Finished(outcome) => return Ok(outcome),
    };
    let ledger = Ledger::open(&folder, experiment.checkpoint)?;
    let input = input.with_pipelines(&experiment);
    let run = Run { experiment: &experiment, input, folder, ledger, pool, cancel, output: arguments.output };
    run.perform()
}

/// The folder that the arguments name, or a new one below the default root.
pub(crate) fn new_folder(arguments: &ExperimentArguments, name: &str) -> Result<RunFolder, TrainerError> {
    Ok(match &arguments.run.out {
        Some(path) => RunFolder::create_at_on(&arguments.disk, path)?,
        None => RunFolder::create_on(&arguments.disk, &default_root(), name)?,
    })
}

/// As many threads as asked for.
pub(crate) fn thread_pool(arguments: &ExperimentArguments) -> Result<ThreadPool, TrainerError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.run.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })
}

impl Run<'_> {
    /// Fits, compares, writes and prints.
    pub(crate) fn perform(&self) -> Result<Outcome, TrainerError> {
        match &self.experiment.task {
            Task::Estimate(single) => estimate(self, &Method::of(single)?),
            Task::Compare(comparison) => compare(self, comparison),
        }
    }

    /// A fit as a row, beside the oracle's decay rate.
    pub(crate) fn row(&self, fit: &SeedFit) -> SeedRow {
        fit.row(&self.input.extraction.envelope, self.input.oracle.decay_rate)
    }

    /// Whether progress is to be kept off the terminal.
    pub(crate) fn is_silent(&self) -> bool {
        self.output.quiet || self.output.json
    }

    /// Prints a result as [`Output::print`].
    pub(crate) fn print(
        &self,
        result: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), TrainerError> {
        self.output.print(result, text)
    }
}

impl Output {
    /// Prints a result as asked for: as JSON, as the given text, or not at all.
    pub(crate) fn print(
        self,
        result: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), TrainerError> {
        if self.json {
            let json = serde_json::to_string_pretty(result)
                .map_err(|error| TrainerError::System { what: "the result", problem: error.to_string() })?;
            console::result(&json);
        } else if !self.quiet {
            console::result(&text());
        }
        Ok(())
    }
}

/// Reads the configuration that the arguments name, overrides applied.
pub(crate) fn read_config(arguments: &ExperimentArguments) -> Result<Document, TrainerError> {
    let path = arguments.config.as_ref().ok_or(TrainerError::NoConfig)?;
    read_document(path, &arguments.overrides, arguments.run.seed)
}
