//! Input of an experiment's fits, read from the file that its configuration names.

use crate::error::TrainerError;
use experiment::{DataSettings, Experiment};
use record::{RecordError, read_file};
use std::path::Path;
pub(crate) use workflow::estimate::Input;

/// Reads the record of an experiment and extracts its envelope.
pub(crate) fn read(experiment: &Experiment) -> Result<Input, TrainerError> {
    let data = &experiment.data;
    let (record, source) =
        read_file(Path::new(&data.path), &data.read_options()).map_err(|error| absent(error, data))?;
    Ok(Input::of(record, source, data.clock, &experiment.envelope)?)
}

/// Converts a record's error; if the file is missing, the error includes the source that the configuration
/// names.
fn absent(error: RecordError, data: &DataSettings) -> TrainerError {
    match &data.source {
        Some(source) if !Path::new(&data.path).exists() => {
            TrainerError::AbsentRecord { error, source_of: source.clone() }
        }
        _ => error.into(),
    }
}
