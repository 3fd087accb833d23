//! Reading `nominal.toml`: what is believed of a system.

use crate::configured::is_simulation;
use crate::configured::is_trials;
use crate::error::TrainerError;
use experiment::{StatedNominal, resolve_nominal};
use settings::{Document, SettingsError};
use std::path::Path;

/// Digest of all that a nominal simulator states; comments and order are not among it.
pub(super) fn digest(stated: &StatedNominal) -> String {
    runs::digest(simulator::nominal_text(&stated.simulator).as_bytes())
}

/// Reads a nominal simulator.
pub(crate) fn read(path: &Path) -> Result<StatedNominal, TrainerError> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| TrainerError::Nominal {
        file: file.clone(),
        problem: if path.is_dir() { "it is a folder".to_owned() } else { error.to_string() },
    })?;
    let document = Document::parse(&file, &text)?;
    resolve_nominal(&document).map_err(|error| match (command_for(&document), error) {
        (Some(command), _) => {
            TrainerError::NominalIsConfiguration { command: format!("{command} {file}"), file }
        }
        (None, SettingsError::Refused { file, problem }) => TrainerError::Nominal { file, problem },
        (None, other) => other.into(),
    })
}

/// The command that runs a document which is the configuration of an experiment; `None` where it is none.
fn command_for(document: &Document) -> Option<&'static str> {
    if is_trials(document) {
        Some("trainer trials")
    } else if is_simulation(document)
        || ["record", "start", "sensor"].iter().any(|key| has_section(document, key))
    {
        Some("trainer simulate")
    } else {
        let known = ["task", "base", "estimator", "data", "fit", "compare", "learn", "predict"];
        known.iter().any(|key| has_section(document, key)).then_some("trainer")
    }
}

/// Whether a document has a key or a section of this name.
fn has_section(document: &Document, name: &str) -> bool {
    let is_below =
        |key: &str| key.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    document.leaves().iter().any(|leaf| is_below(&leaf.key))
}
