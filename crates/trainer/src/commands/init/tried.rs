//! The commands that `init` prints, tried as far as they refuse a log: everything but the fits.

use crate::configured::classical;
use crate::error::TrainerError;
use crate::fits::input;
use envelope::Extraction;
use registry::ESTIMATORS;
use settings::Document;
use std::path::{Path, PathBuf};
use workflow::{Question, nominal};

/// Reads a log by the text of a configuration, as an estimate does, and returns the envelope that is fitted.
pub(super) fn estimate(file: &Path, text: &str) -> Result<Extraction, TrainerError> {
    let document = Document::parse(&file.display().to_string(), text)?;
    let experiment = experiment::resolve(&document, ESTIMATORS, &classical())?;
    Ok(input::read(&experiment)?.extraction)
}

/// Reads logs with the text of a nominal simulator, and checks them as a diagnosis does.
pub(super) fn diagnosis(
    log: &Path,
    (file, text): (&Path, &str),
    reading: &workflow::Reading,
) -> Result<(), TrainerError> {
    let stated = nominal::parse(&file.display().to_string(), text)?;
    let records: [PathBuf; 1] = [log.to_owned()];
    Ok(Question::read_with(&records, stated, file, reading)?.check()?)
}
