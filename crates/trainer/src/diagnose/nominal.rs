//! Reading `nominal.toml`: what is believed of a system.

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
    resolve_nominal(&Document::parse(&file, &text)?).map_err(|error| match error {
        SettingsError::Refused { file, problem } => TrainerError::Nominal { file, problem },
        other => other.into(),
    })
}
