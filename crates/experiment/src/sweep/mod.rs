//! Sweeps: an experiment over every combination of the values of some keys. All combinations are resolved and
//! checked before the first one runs.

mod axis;
mod difference;
mod error;
mod propose;
mod shard;
mod space;

pub use axis::{Axis, combinations};
pub use difference::{differing_keys, first_difference};
pub use error::SweepError;
pub use propose::{STARTING_POINTS, Sampler, TriedPoint, propose};
pub use shard::Shard;
pub use space::{Dimension, Domain};

use crate::experiment::{Experiment, Task, resolve};
use crate::learning::{LearnStudy, LearningProblem, is_learning, resolve_learning};
use settings::{Document, Resolved, SettingsError};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Largest number of runs in one sweep.
pub const MOST_RUNS: usize = 10_000;

/// Methods that a sweep's configurations may name.
#[derive(Clone, Copy)]
pub struct Registries<'a> {
    /// Entries of the estimators.
    pub estimators: &'a [estimator::Entry],
    /// Ids of the classical methods.
    pub classical: &'a [&'a str],
    /// Entries of the learners of dynamics.
    pub learners: &'a [learn::Entry],
}

/// Experiment of one combination.
pub enum Swept {
    /// An estimate or a comparison.
    Experiment(Box<Experiment>),
    /// Dynamics learned from records.
    Learning(Box<LearnStudy>),
}

impl Swept {
    /// Resolves a document; the inner error holds the name of a task that cannot be swept.
    ///
    /// # Errors
    /// The errors of [`resolve`] and [`resolve_learning`].
    pub fn resolve(
        document: &Document,
        registries: &Registries<'_>,
    ) -> Result<Result<Self, String>, SettingsError> {
        let task = document.get("task").and_then(|leaf| leaf.value.as_str());
        if let Some(task @ ("predict" | "simulate" | "trials")) = task {
            return Ok(Err(task.to_owned()));
        }
        Ok(Ok(if is_learning(document) {
            Self::Learning(Box::new(resolve_learning(document, registries.learners)?))
        } else {
            let experiment = resolve(document, registries.estimators, registries.classical)?;
            Self::Experiment(Box::new(experiment))
        }))
    }

    /// Returns all configuration values in force.
    #[must_use]
    pub fn resolved(&self) -> &Resolved {
        match self {
            Self::Experiment(experiment) => &experiment.resolved,
            Self::Learning(study) => &study.resolved,
        }
    }

    /// Returns the task of the experiment.
    #[must_use]
    pub fn task(&self) -> SweptTask {
        match self {
            Self::Learning(_) => SweptTask::Learn,
            Self::Experiment(experiment) => match experiment.task {
                Task::Estimate(_) => SweptTask::Estimate,
                Task::Compare(_) => SweptTask::Compare,
            },
        }
    }

    /// Returns the SHA-256 of all values in force: `sha256:` and 64 hexadecimal digits.
    #[must_use]
    pub fn digest(&self) -> String {
        let hash = Sha256::digest(self.resolved().values_text().as_bytes());
        hash.iter().fold("sha256:".to_owned(), |text, byte| text + &format!("{byte:02x}"))
    }
}

/// Task of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweptTask {
    /// One method on one record.
    Estimate,
    /// Many methods on one record.
    Compare,
    /// Models learned from data sets.
    Learn,
}

/// Data that a run reads.
#[derive(Debug, Clone, PartialEq)]
pub enum RunData {
    /// One record, by its path.
    Record(String),
    /// Data sets.
    Problems(Vec<LearningProblem>),
}

/// One run of a sweep, with its configuration frozen.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// Position in the list of runs, from 1.
    pub number: usize,
    /// SHA-256 of all values in force ([`settings::Resolved::values_text`]): `sha256:` and 64 hexadecimal
    /// digits.
    pub digest: String,
    /// Overrides of the combination, one argument per axis.
    pub overrides: Vec<String>,
    /// Resolved configuration, as in the run's `config.toml`.
    pub config: String,
    /// Task of the run.
    pub task: SweptTask,
    /// Data that the run reads.
    pub data: RunData,
}

/// Applies each combination to a configuration, then resolves and checks it. Runs are numbered from `first`.
///
/// # Errors
/// [`SweepError::BadCombination`] or [`SweepError::Task`] for the first combination that cannot be run, with
/// its number and overrides; [`SweepError::Repeated`] if two combinations are the same experiment.
pub fn plan(
    document: &Document,
    combinations: Vec<Vec<String>>,
    first: usize,
    registries: &Registries<'_>,
) -> Result<Vec<PlannedRun>, SweepError> {
    let mut runs: Vec<PlannedRun> = Vec::new();
    let mut seen: BTreeMap<String, (usize, String)> = BTreeMap::new();
    for (number, overrides) in (first..).zip(combinations) {
        let shown = || if overrides.is_empty() { "as it is".to_owned() } else { overrides.join(" ") };
        let swept = one(document, &overrides, registries).map_err(|fault| match fault {
            Fault::Settings(source) => SweepError::BadCombination { number, overrides: shown(), source },
            Fault::Task(task) => SweepError::Task { number, overrides: shown(), task },
        })?;
        let digest = swept.digest();
        if let Some((first, overrides)) = seen.insert(digest.clone(), (number, overrides.join(" "))) {
            return Err(SweepError::Repeated { first, overrides, second: number });
        }
        let config = swept.resolved().to_toml();
        let task = swept.task();
        let data = match swept {
            Swept::Experiment(experiment) => RunData::Record(experiment.data.path),
            Swept::Learning(study) => RunData::Problems(study.problems),
        };
        runs.push(PlannedRun { number, digest, overrides, config, task, data });
    }
    Ok(runs)
}

/// Applies one `key=value` argument to a configuration.
///
/// `estimator=NAME` chooses the estimator. If the choice changes, the file's settings below `estimator` are
/// dropped; overrides stay. Every other argument goes to [`Document::apply_override`].
///
/// # Errors
/// The errors of [`Document::apply_override`].
pub fn apply_override(document: &mut Document, argument: &str) -> Result<(), SettingsError> {
    let Some(("estimator", name)) = argument.split_once('=').map(|(key, value)| (key.trim(), value.trim()))
    else {
        return document.apply_override(argument);
    };
    let choice = format!("estimator.name={name}");
    // Names are compared as parsed values, so quoting does not matter.
    let mut chosen = document.clone();
    chosen.apply_override(&choice)?;
    let name_in = |document: &Document| document.get("estimator.name").map(|leaf| leaf.value.clone());
    if name_in(document) != name_in(&chosen) {
        document.clear_table("estimator");
    }
    document.apply_override(&choice)
}

enum Fault {
    Settings(SettingsError),
    Task(String),
}

fn one(document: &Document, overrides: &[String], registries: &Registries<'_>) -> Result<Swept, Fault> {
    let mut document = document.clone();
    // The estimator goes first, because choosing it drops the settings of another one. The order of the axes
    // then does not matter.
    let (choices, others): (Vec<&String>, Vec<&String>) =
        overrides.iter().partition(|argument| argument.starts_with("estimator="));
    for argument in choices.into_iter().chain(others) {
        apply_override(&mut document, argument).map_err(Fault::Settings)?;
    }
    Swept::resolve(&document, registries).map_err(Fault::Settings)?.map_err(Fault::Task)
}

#[cfg(test)]
mod tests;
