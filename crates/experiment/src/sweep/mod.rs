//! Sweeps: an experiment over every combination of some keys' values, resolved and checked before the first runs.

mod axis;
mod difference;
mod error;
mod shard;

pub use axis::{Axis, combinations};
pub use difference::{differing_keys, first_difference};
pub use error::SweepError;
pub use shard::Shard;

use crate::experiment::{Experiment, resolve};
use estimator::Entry;
use settings::{Document, SettingsError};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Most runs of one sweep.
pub const MOST_RUNS: usize = 10_000;

/// One run of a sweep, frozen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedRun {
    /// Position in the list, from 1.
    pub number: usize,
    /// SHA-256 of every value in force ([`settings::Resolved::values_text`]): `sha256:` and 64 hexadecimal digits.
    pub digest: String,
    /// What the combination overrides, an argument for each axis.
    pub overrides: Vec<String>,
    /// The resolved configuration, as a run's `config.toml` has it.
    pub config: String,
    /// The record that it reads.
    pub data_path: String,
}

/// Resolves and checks every combination of the axes on top of a configuration.
///
/// # Errors
/// The first combination that cannot be run, with its number and its overrides; two that are the same experiment;
/// and what [`combinations`] refuses.
pub fn plan(
    document: &Document,
    axes: &[Axis],
    registry: &[Entry],
    classical: &[&str],
) -> Result<Vec<PlannedRun>, SweepError> {
    let mut runs: Vec<PlannedRun> = Vec::new();
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for (at, overrides) in combinations(axes)?.into_iter().enumerate() {
        let number = at + 1;
        let shown = || if overrides.is_empty() { "as it is".to_owned() } else { overrides.join(" ") };
        let experiment = one(document, &overrides, registry, classical).map_err(|fault| match fault {
            Fault::Settings(source) => SweepError::BadCombination { number, overrides: shown(), source },
            Fault::Task(task) => SweepError::Task { number, overrides: shown(), task },
        })?;
        let digest = digest(&experiment);
        if let Some(&first) = seen.get(&digest) {
            // The first of two equal runs is in the list, whose numbers begin at 1.
            let overrides = runs.get(first - 1).map(|run| run.overrides.join(" ")).unwrap_or_default();
            return Err(SweepError::Repeated { first, overrides, second: number });
        }
        seen.insert(digest.clone(), number);
        let config = experiment.resolved.to_toml();
        runs.push(PlannedRun { number, digest, overrides, config, data_path: experiment.data.path });
    }
    Ok(runs)
}

/// SHA-256 of every value in force, `sha256:` and 64 hexadecimal digits.
#[must_use]
pub fn digest(experiment: &Experiment) -> String {
    let hash = Sha256::digest(experiment.resolved.values_text().as_bytes());
    hash.iter().fold("sha256:".to_owned(), |text, byte| text + &format!("{byte:02x}"))
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

fn one(
    document: &Document,
    overrides: &[String],
    registry: &[Entry],
    classical: &[&str],
) -> Result<Experiment, Fault> {
    let mut document = document.clone();
    // The estimator first: choosing it leaves the settings of another one out, whatever the order of the axes.
    let (choices, others): (Vec<&String>, Vec<&String>) =
        overrides.iter().partition(|argument| argument.starts_with("estimator="));
    for argument in choices.into_iter().chain(others) {
        apply_override(&mut document, argument).map_err(Fault::Settings)?;
    }
    let task = document.get("task").and_then(|leaf| leaf.value.as_str());
    if let Some(task @ ("learn" | "predict" | "simulate" | "trials")) = task {
        return Err(Fault::Task(task.to_owned()));
    }
    resolve(&document, registry, classical).map_err(Fault::Settings)
}

#[cfg(test)]
mod tests;
