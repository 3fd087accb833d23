//! Reading `nominal.toml`, the nominal simulator of a system.

use crate::error::WorkflowError;
use experiment::{StatedNominal, resolve_nominal};
use settings::{Document, SettingsError};
use std::path::Path;

/// Computes the digest of everything that a nominal simulator states, excluding comments and order.
#[must_use]
pub fn digest(stated: &StatedNominal) -> String {
    runs::digest(export::nominal_text(&stated.simulator).as_bytes())
}

/// Reads a nominal simulator from a file.
///
/// # Errors
/// [`WorkflowError`] with line and column; for the configuration of an experiment, with the command that runs
/// it.
pub fn read(path: &Path) -> Result<StatedNominal, WorkflowError> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| WorkflowError::Nominal {
        file: file.clone(),
        problem: if path.is_dir() { "it is a folder".to_owned() } else { error.to_string() },
    })?;
    parse(&file, &text)
}

/// Reads a nominal simulator from the text of a file; `file` is its name in messages.
///
/// # Errors
/// Same as [`read`].
pub fn parse(file: &str, text: &str) -> Result<StatedNominal, WorkflowError> {
    let document = Document::parse(file, text)?;
    resolve_nominal(&document).map_err(|error| match (command_for(&document), error) {
        (Some(command), _) => WorkflowError::NominalIsConfiguration {
            command: format!("{command} {file}"),
            file: file.to_owned(),
        },
        (None, SettingsError::Refused { file, problem }) => WorkflowError::Nominal { file, problem },
        (None, other) => other.into(),
    })
}

/// Returns the command that runs a document if it is the configuration of an experiment; otherwise `None`.
fn command_for(document: &Document) -> Option<&'static str> {
    let is_task = |name| document.get("task").is_some_and(|leaf| leaf.value.as_str() == Some(name));
    if is_task("trials") {
        Some("trainer trials")
    } else if is_task("simulate")
        || ["record", "start", "sensor"].iter().any(|key| has_section(document, key))
    {
        Some("trainer simulate")
    } else {
        let known = ["task", "base", "estimator", "data", "fit", "compare", "learn", "predict"];
        known.iter().any(|key| has_section(document, key)).then_some("trainer")
    }
}

/// Returns `true` if a document has a key or a section with this name.
fn has_section(document: &Document, name: &str) -> bool {
    let is_below =
        |key: &str| key.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    document.leaves().iter().any(|leaf| is_below(&leaf.key))
}
