//! A configuration of any task, read and checked, as the commands need it that do not run one.

use crate::cli::Output;
use crate::error::TrainerError;
use crate::simulate::is_simulation;
use crate::trials::is_trials;
use clap::Args;
use experiment::sweep::apply_override;
use experiment::{Experiment, PredictionStudy, is_prediction, resolve, resolve_prediction};
use oracle::classical::CLASSICAL;
use registry::ESTIMATORS;
use settings::{Document, Resolved};
use simulator::Plan;
use std::path::{Path, PathBuf};
use trials::TrialPlan;

/// A configuration and what overrides it.
#[derive(Debug, Args)]
pub(crate) struct ConfigArguments {
    /// The experiment: a TOML file
    pub(crate) config: PathBuf,
    /// Values that override the file's, by dotted key: estimator.hidden=[64] seed=3
    #[arg(value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// A checked configuration.
pub(crate) enum Configured {
    /// One estimator, or a comparison.
    Experiment(Box<Experiment>),
    /// Held-out prediction.
    Prediction(Box<PredictionStudy>),
    /// Records of systems drawn from priors.
    Simulation(Box<Plan>),
    /// Withheld-effect trials.
    Trials(Box<TrialPlan>),
}

impl Configured {
    /// Checks a document against the keys of the task that it asks for.
    pub(crate) fn resolve(document: &Document) -> Result<Self, TrainerError> {
        let classical = classical();
        Ok(if is_simulation(document) {
            Self::Simulation(Box::new(Plan::resolve(document)?))
        } else if is_trials(document) {
            Self::Trials(Box::new(TrialPlan::resolve(document)?))
        } else if is_prediction(document) {
            Self::Prediction(Box::new(resolve_prediction(document, ESTIMATORS, &classical)?))
        } else {
            Self::Experiment(Box::new(resolve(document, ESTIMATORS, &classical)?))
        })
    }

    /// Every value in force.
    pub(crate) fn resolved(&self) -> &Resolved {
        match self {
            Self::Experiment(experiment) => &experiment.resolved,
            Self::Prediction(study) => &study.resolved,
            Self::Simulation(plan) => &plan.resolved,
            Self::Trials(plan) => &plan.resolved,
        }
    }
}

/// Ids of the classical methods.
pub(crate) fn classical() -> Vec<&'static str> {
    CLASSICAL.iter().map(|route| route.id).collect()
}

/// Reads a configuration file with those that it stands on, and applies overrides in their order.
pub(crate) fn read_document(path: &Path, overrides: &[String]) -> Result<Document, TrainerError> {
    let (_, mut document) = read_with_text(path)?;
    for argument in overrides {
        apply_override(&mut document, argument)?;
    }
    Ok(document)
}

/// A configuration file as it is written, and what it says on those that it stands on.
pub(crate) fn read_with_text(path: &Path) -> Result<(String, Document), TrainerError> {
    let file = path.display().to_string();
    let text = text_of(path).map_err(|problem| TrainerError::Config { file: file.clone(), problem })?;
    let document = Document::parse(&file, &text)?.on_its_bases(&mut |path| text_of(path))?;
    Ok((text, document))
}

fn text_of(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path)
        .map_err(|error| if path.is_dir() { "it is a folder".to_owned() } else { error.to_string() })
}
