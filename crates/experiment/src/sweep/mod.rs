//! Sweeps: an experiment over every combination of some keys' values, resolved and checked before the first runs.

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

/// Most runs of one sweep.
pub const MOST_RUNS: usize = 10_000;

/// What there is to choose from.
#[derive(Clone, Copy)]
pub struct Registries<'a> {
    /// The estimators.
    pub estimators: &'a [estimator::Entry],
    /// Ids of the classical methods.
    pub classical: &'a [&'a str],
    /// The learners of dynamics.
    pub learners: &'a [learn::Entry],
}

/// An experiment that a sweep may make.
pub enum Swept {
    /// An estimate or a comparison.
    Experiment(Box<Experiment>),
    /// Dynamics learned from records.
    Learning(Box<LearnStudy>),
}

impl Swept {
    /// Resolves a document; the error holds the task where a sweep cannot be over it.
    ///
    /// # Errors
    /// As [`resolve`] and [`resolve_learning`].
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

    /// Every value in force.
    #[must_use]
    pub fn resolved(&self) -> &Resolved {
        match self {
            Self::Experiment(experiment) => &experiment.resolved,
            Self::Learning(study) => &study.resolved,
        }
    }

    /// What it is asked for.
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

    /// SHA-256 of every value in force, `sha256:` and 64 hexadecimal digits.
    #[must_use]
    pub fn digest(&self) -> String {
        let hash = Sha256::digest(self.resolved().values_text().as_bytes());
        hash.iter().fold("sha256:".to_owned(), |text, byte| text + &format!("{byte:02x}"))
    }
}

/// What a run is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweptTask {
    /// One method on one record.
    Estimate,
    /// Many methods on one record.
    Compare,
    /// Models learned from data sets.
    Learn,
}

/// What a run reads.
#[derive(Debug, Clone, PartialEq)]
pub enum RunData {
    /// One record.
    Record(String),
    /// Data sets.
    Problems(Vec<LearningProblem>),
}

/// One run of a sweep, frozen.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// Position in the list, from 1.
    pub number: usize,
    /// SHA-256 of every value in force ([`settings::Resolved::values_text`]): `sha256:` and 64 hexadecimal digits.
    pub digest: String,
    /// What the combination overrides, an argument for each axis.
    pub overrides: Vec<String>,
    /// The resolved configuration, as a run's `config.toml` has it.
    pub config: String,
    /// What it is asked for.
    pub task: SweptTask,
    /// What it reads.
    pub data: RunData,
}

/// Resolves and checks combinations on top of a configuration; they are numbered from `first`.
///
/// # Errors
/// The first combination that cannot be run, with its number and its overrides; two that are the same experiment.
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
/// `estimator=NAME` chooses the estimator: the file's settings of another one are left out, those of this one and
/// overrides stay. Everything else is [`Document::apply_override`].
///
/// # Errors
/// As [`Document::apply_override`].
pub fn apply_override(document: &mut Document, argument: &str) -> Result<(), SettingsError> {
    let Some(("estimator", name)) = argument.split_once('=').map(|(key, value)| (key.trim(), value.trim()))
    else {
        return document.apply_override(argument);
    };
    let choice = format!("estimator.name={name}");
    // However the name is quoted, it is the value that chooses.
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
    // The estimator first: choosing it leaves the settings of another one out, whatever the order of the axes.
    let (choices, others): (Vec<&String>, Vec<&String>) =
        overrides.iter().partition(|argument| argument.starts_with("estimator="));
    for argument in choices.into_iter().chain(others) {
        apply_override(&mut document, argument).map_err(Fault::Settings)?;
    }
    Swept::resolve(&document, registries).map_err(Fault::Settings)?.map_err(Fault::Task)
}

#[cfg(test)]
mod tests;
