//! `trainer CONFIG`: running the experiment of a configuration.

mod compare;
mod estimate;
mod predict;
mod ready;
#[cfg(test)]
mod resume_tests;
mod summary;

use crate::commands::{learn, simulate, trials};
use crate::configured::{Configured, read_config};
use crate::error::TrainerError;
use crate::fits::input;
use crate::fits::method::Method;
use crate::folders::resume::{Beginning, Begun, Ledger, begin};
use crate::options::ExperimentArguments;
use crate::outcome::Outcome;
use crate::terminal::interrupt;
use compare::compare;
use estimate::estimate;
use estimator::Cancel;
use experiment::Task;
use predict::predict;
pub(crate) use ready::Run;

/// Reads, fits, compares, writes and prints.
pub(crate) fn run(arguments: &ExperimentArguments) -> Result<Outcome, TrainerError> {
    run_until(arguments, interrupt::watch()?)
}

/// Runs an experiment as [`run`] does, with an existing request to stop.
pub(crate) fn run_until(
    arguments: &ExperimentArguments,
    cancel: &'static Cancel,
) -> Result<Outcome, TrainerError> {
    let experiment = match Configured::resolve(&read_config(arguments)?)? {
        Configured::Simulation(plan) => return simulate::simulate(arguments, &plan, cancel),
        Configured::Trials(_) => return trials::run(&arguments.into(), cancel),
        Configured::Learning(study) => return learn::learn(arguments, &study, cancel),
        Configured::Prediction(study) => return predict(arguments, &study, cancel),
        Configured::Experiment(experiment) => experiment,
    };
    let input = input::read(&experiment)?;
    let pool = arguments.thread_pool()?;
    let config = experiment.resolved.to_toml();
    let beginning = Beginning::of(&experiment, &input.source.digest, config, pool.current_num_threads());
    let folder = match begin(arguments, &beginning)? {
        Begun::Open(folder) => folder,
        Begun::Finished(outcome) => return Ok(outcome),
    };
    let ledger = Ledger::open(&folder, experiment.checkpoint)?;
    let input = input.with_pipelines(&experiment.envelope);
    let output = arguments.output;
    perform(&Run { experiment: &experiment, input, folder, ledger, pool, cancel, pause_after: None, output })
}

/// Fits, compares, writes and prints.
pub(crate) fn perform(run: &Run<'_>) -> Result<Outcome, TrainerError> {
    match &run.experiment.task {
        Task::Estimate(single) => estimate(run, &Method::of(single)?),
        Task::Compare(comparison) => compare(run, comparison),
    }
}
