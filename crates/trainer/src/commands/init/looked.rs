//! One log with its nearest linear oscillator.

use crate::commands::diagnose::arguments::Reading;
use crate::error::TrainerError;
use identify::{Estimated, LinearOscillator, Mode, identify};
use record::{Clock, Look, ReadOptions, look};
use results::Resonance;
use std::path::{Path, PathBuf};
use workflow::WorkflowError;
use workflow::read::centered;

/// Damping ratio from which no swing is seen.
pub(super) const CRITICAL: f64 = 0.95;

/// Log with its nearest linear oscillator.
pub(super) struct Looked {
    pub(super) path: PathBuf,
    /// Options that read the log in the same way: those of the user, and `none` for the input if the motion does
    /// not follow the one in the file.
    pub(super) reading: Reading,
    pub(super) look: Look,
    pub(super) oscillator: LinearOscillator,
    /// Modes of a free decay; the oscillator is the strongest if there are several.
    pub(super) modes: Vec<Mode>,
}

/// Inspects one log.
pub(super) fn looked(path: &Path, reading: &Reading) -> Result<Looked, TrainerError> {
    let look = read(path, reading)?;
    // A force, a command or a voltage in the file may drive the system; it counts as an input if the motion
    // follows it.
    let input = look.source.reading.input.as_ref().map(|input| input.column.clone());
    let found = identified(path, reading, look);
    let follows = match &found {
        Ok(found) => found.oscillator.input_gain.is_some_and(Estimated::is_significant),
        // A constant input cannot be distinguished from a rest position.
        Err(TrainerError::Workflow(WorkflowError::Identify { .. })) => false,
        Err(_) => true,
    };
    let Some(input) = input.filter(|_| !follows && reading.input.is_none()) else { return found };
    let reading = Reading { input: Some("none".to_owned()), ..reading.clone() };
    let mut look = read(path, &reading)?;
    look.source.findings.push(format!(
        "`{input}` was not taken as the input, since the motion does not follow it; name it with `data.input` if it drives \
         the system"
    ));
    identified(path, &reading, look)
}

/// Reads a log by the options; compares the rate that it states with its stamps.
fn read(path: &Path, reading: &Reading) -> Result<Look, TrainerError> {
    let plain = reading.plain();
    let file = path.display().to_string();
    let fault = |fault: record::Fault| WorkflowError::Record(fault.in_file(&file));
    let options = ReadOptions { driven: true, ..plain.options };
    let mut look = look(path, &options).map_err(WorkflowError::Record)?;
    if reading.remove_mean {
        look.record = centered(&look.record).map_err(fault)?;
    }
    look.clock = Clock::new(&look.record, plain.clock).map_err(fault)?;
    look.source.findings.extend(look.source.statements.contradictions(look.record.len(), &look.clock));
    Ok(look)
}

fn identified(path: &Path, reading: &Reading, look: Look) -> Result<Looked, TrainerError> {
    let file = path.display().to_string();
    let oscillator =
        identify(&look.record, &look.clock).map_err(|source| WorkflowError::Identify { file, source })?;
    let modes = identify::modes(&look.record, &look.clock);
    let oscillator = match modes.as_slice() {
        [strongest, _, ..] => strongest.oscillator(oscillator, modes.len()),
        _ => oscillator,
    };
    Ok(Looked { path: path.to_owned(), reading: reading.clone(), look, oscillator, modes })
}

impl Looked {
    pub(super) fn duration_s(&self) -> f64 {
        self.look.clock.duration_s()
    }

    /// Returns `true` if the oscillator swings visibly.
    pub(super) fn swings(&self) -> bool {
        self.oscillator.damping_ratio().is_some_and(|ratio| ratio.value < CRITICAL)
    }

    /// Returns the sharpness of the oscillator's resonance; `None` if it has none.
    pub(super) fn resonance(&self) -> Option<Resonance> {
        let oscillator = &self.oscillator;
        workflow::resonance(oscillator.natural_frequency_hz()?, oscillator.damping_ratio()?)
    }

    /// Returns the number of cycles in the record; `None` without a natural frequency.
    pub(super) fn cycles(&self) -> Option<f64> {
        Some(self.oscillator.natural_frequency_hz()?.value * self.duration_s())
    }
}
