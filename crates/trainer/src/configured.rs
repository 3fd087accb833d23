//! Reading and checking configurations of any task.

use crate::error::TrainerError;
use crate::options::{ExperimentArguments, Output};
use ::learn::learners::LEARNERS;
use clap::Args;
use experiment::sweep::{Registries, apply_override};
use experiment::{
    Experiment, LearnStudy, PredictionStudy, is_learning, is_prediction, resolve, resolve_learning,
    resolve_prediction,
};
use oracle::classical::CLASSICAL;
use registry::ESTIMATORS;
use settings::{Document, Resolved, nearest};
use simulator::Plan;
use std::path::{Path, PathBuf};
use trials::TrialPlan;

/// Configuration and its overrides.
#[derive(Debug, Args)]
pub(crate) struct ConfigArguments {
    /// The experiment: a TOML file
    pub(crate) config: PathBuf,
    /// Values that override the file's, by dotted key: estimator.hidden=[64] seed=3
    #[arg(value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Overrides the configuration's seed
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Tasks of configurations.
const TASKS: [&str; 6] = ["estimate", "compare", "learn", "predict", "simulate", "trials"];

/// Checked configuration.
pub(crate) enum Configured {
    /// One estimator, or a comparison.
    Experiment(Box<Experiment>),
    /// Dynamics learned from records.
    Learning(Box<LearnStudy>),
    /// Held-out prediction.
    Prediction(Box<PredictionStudy>),
    /// Records of systems drawn from priors.
    Simulation(Box<Plan>),
    /// Withheld-effect trials.
    Trials(Box<TrialPlan>),
}

impl Configured {
    /// Checks a document against the keys of its task.
    pub(crate) fn resolve(document: &Document) -> Result<Self, TrainerError> {
        let classical = classical();
        Ok(if is_simulation(document) {
            Self::Simulation(Box::new(Plan::resolve(document)?))
        } else if is_trials(document) {
            Self::Trials(Box::new(TrialPlan::resolve(document)?))
        } else if is_learning(document) {
            Self::Learning(Box::new(resolve_learning(document, LEARNERS)?))
        } else if is_prediction(document) {
            Self::Prediction(Box::new(resolve_prediction(document, ESTIMATORS, &classical)?))
        } else {
            Self::Experiment(Box::new(resolve(document, ESTIMATORS, &classical)?))
        })
    }

    /// Returns all values in force.
    pub(crate) fn resolved(&self) -> &Resolved {
        match self {
            Self::Experiment(experiment) => &experiment.resolved,
            Self::Learning(study) => &study.resolved,
            Self::Prediction(study) => &study.resolved,
            Self::Simulation(plan) => &plan.resolved,
            Self::Trials(plan) => &plan.resolved,
        }
    }
}

/// Checks that a document is for the task that a command runs, or names no known task.
///
/// # Errors
/// [`TrainerError::OtherTask`] with the place that names the other task.
pub(crate) fn check_task(
    document: &Document,
    wanted: &'static str,
    example: &'static str,
) -> Result<(), TrainerError> {
    let told = match document.get("task") {
        Some(leaf) => leaf.value.as_str().map(|task| (leaf, task)),
        // A configuration that names no task and chooses an estimator is an estimation.
        None => document.get("estimator.name").map(|leaf| (leaf, "estimate")),
    };
    match told.filter(|(_, task)| *task != wanted && TASKS.contains(task)) {
        None => Ok(()),
        Some((leaf, task)) => Err(TrainerError::OtherTask {
            origin: leaf.origin.clone(),
            file: document.file().to_owned(),
            task: task.to_owned(),
            wanted,
            example,
        }),
    }
}

/// Returns the ids of the classical methods.
pub(crate) fn classical() -> Vec<&'static str> {
    CLASSICAL.iter().map(|route| route.id).collect()
}

/// Returns the registries that a sweep uses.
pub(crate) fn registries() -> Registries<'static> {
    static IDS: std::sync::LazyLock<Vec<&'static str>> = std::sync::LazyLock::new(classical);
    Registries { estimators: ESTIMATORS, classical: &IDS, learners: LEARNERS }
}

/// Returns `true` if a configuration asks for a simulation.
pub(crate) fn is_simulation(document: &Document) -> bool {
    document.get("task").is_some_and(|leaf| leaf.value.as_str() == Some("simulate"))
}

/// Returns `true` if a configuration asks for trials.
pub(crate) fn is_trials(document: &Document) -> bool {
    document.get("task").is_some_and(|leaf| leaf.value.as_str() == Some("trials"))
}

/// Reads the configuration that the arguments name and applies the overrides.
pub(crate) fn read_config(arguments: &ExperimentArguments) -> Result<Document, TrainerError> {
    let path = arguments.config.as_ref().ok_or(TrainerError::NoConfig)?;
    read_document(path, &arguments.overrides, arguments.run.seed)
}

/// Reads a configuration file with its base files, and applies the overrides in their order, then the seed.
pub(crate) fn read_document(
    path: &Path,
    overrides: &[String],
    seed: Option<u64>,
) -> Result<Document, TrainerError> {
    let (_, mut document) = read_with_text(path)?;
    for argument in overrides {
        apply_override(&mut document, argument)?;
    }
    if let Some(seed) = seed {
        document.apply_override(&format!("seed={seed}"))?;
    }
    Ok(document)
}

/// Reads the text of a configuration file, and the document that it forms with its base files.
pub(crate) fn read_with_text(path: &Path) -> Result<(String, Document), TrainerError> {
    let file = path.display().to_string();
    let text = text_of(path).map_err(|problem| TrainerError::Config { file: file.clone(), problem })?;
    let document = Document::parse(&file, &text)?.on_its_bases(&mut |path| text_of(path))?;
    Ok((text, document))
}

fn text_of(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| match nearest_file(path) {
        _ if path.is_dir() => "it is a folder".to_owned(),
        Some(other) => format!("{error} (did you mean {other}?)"),
        None if path.is_relative() && !path.exists() => match std::env::current_dir() {
            Ok(here) => format!("{error} (looked for in {})", here.display()),
            Err(_) => error.to_string(),
        },
        None => error.to_string(),
    })
}

/// Returns the TOML file of which a missing one is probably a misspelling: in its folder, or in `configs`.
fn nearest_file(path: &Path) -> Option<String> {
    if path.exists() {
        return None;
    }
    let name = path.file_name()?.to_string_lossy().into_owned();
    let name = if name.ends_with(".toml") { name } else { format!("{name}.toml") };
    let own = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    [own, Path::new("configs")].into_iter().find_map(|folder| {
        let entries = std::fs::read_dir(folder).ok()?;
        let mut known: Vec<String> = entries
            .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
            .filter(|name| name.ends_with(".toml"))
            .collect();
        known.sort();
        let found = nearest(&name, &known)?;
        let shown = folder.join(found);
        Some(shown.strip_prefix(".").unwrap_or(&shown).display().to_string())
    })
}
