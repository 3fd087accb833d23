//! One log with its nearest linear oscillator.

use crate::error::{WorkflowError, in_options};
use crate::guess;
use crate::logs::Log;
use crate::modes::{mode_rows, resonance};
use crate::read::{Reading, bias, centered, coordinate_of};
use identify::{Estimated, LinearOscillator, Mode, identify};
use record::{Clock, ColumnLook, Look, ReadOptions};
use results::Resonance;
use serde_json::{Value, json};

/// Damping ratio from which no swing is seen.
pub(super) const CRITICAL: f64 = 0.95;
/// Number of cycles below which a record says little about a decay: a diagnosis needs segments of them to
/// hold out.
pub(super) const FEW_CYCLES: f64 = 3.0;

/// Log with its nearest linear oscillator.
pub struct Looked {
    /// Findings of the reader.
    pub look: Look,
    /// `true` if an input of the file was left out, since the motion does not follow it: the log is then read in the
    /// same way with the input `none`.
    pub without_input: bool,
    /// Nearest linear oscillator: that of the strongest mode if there are several.
    pub oscillator: LinearOscillator,
    /// Modes of a free decay, and steady lines beside them.
    pub modes: Vec<Mode>,
}

impl Looked {
    /// Reads a log and identifies its oscillator.
    ///
    /// # Errors
    /// [`WorkflowError::Record`] with the place in the file and the option to set, [`WorkflowError::Identify`] for a
    /// record that shows no oscillator.
    pub fn of(log: &Log, reading: &Reading) -> Result<Self, WorkflowError> {
        let look = read(log, reading)?;
        // A force, a command or a voltage in the file may drive the system; it counts as an input if the motion
        // follows it.
        let input = look.source.reading.input.as_ref().map(|input| input.column.clone());
        let found = identified(log, look);
        let follows = match &found {
            Ok(found) => found.oscillator.input_gain.is_some_and(Estimated::is_significant),
            // A constant input cannot be distinguished from a rest position.
            Err(WorkflowError::Identify { .. }) => false,
            Err(_) => true,
        };
        let is_asked = reading.options.columns.input.is_some();
        let Some(input) = input.filter(|_| !follows && !is_asked) else { return found };
        let mut look = read(log, &reading.clone().input("none"))?;
        look.source.findings.push(format!(
            "`{input}` was not taken as the input, since the motion does not follow it; name it with `data.input` if it \
             drives the system"
        ));
        Ok(Self { without_input: true, ..identified(log, look)? })
    }

    /// Returns the length of the record in seconds, by the believed clock.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.look.clock.duration_s()
    }

    /// Returns `true` if the oscillator swings visibly.
    #[must_use]
    pub fn swings(&self) -> bool {
        self.oscillator.damping_ratio().is_some_and(|ratio| ratio.value < CRITICAL)
    }

    /// Returns the sharpness of the oscillator's resonance; `None` if it has none.
    #[must_use]
    pub fn resonance(&self) -> Option<Resonance> {
        let oscillator = &self.oscillator;
        resonance(oscillator.natural_frequency_hz()?, oscillator.damping_ratio()?)
    }

    /// Returns the number of cycles in the record; `None` without a natural frequency.
    #[must_use]
    pub fn cycles(&self) -> Option<f64> {
        Some(self.oscillator.natural_frequency_hz()?.value * self.duration_s())
    }

    /// Returns `true` if a diagnosis can take the record: it is driven, or has a spring and enough cycles.
    #[must_use]
    pub fn is_diagnosable(&self) -> bool {
        self.oscillator.input_gain.is_some() || self.cycles().is_some_and(|cycles| cycles >= FEW_CYCLES)
    }

    /// Returns the remarks of the reader, in sentences that name options of the command line.
    #[must_use]
    pub fn findings(&self) -> Vec<String> {
        let read = self.look.source.findings.iter().map(|finding| in_options(finding));
        read.chain(bias(&self.look.record)).collect()
    }

    /// Returns what was found, as JSON: `record`, `oscillator` and `modes`.
    #[must_use]
    pub fn json(&self, findings: &[String]) -> Value {
        let (look, oscillator, resonance) = (&self.look, &self.oscillator, self.resonance());
        let number = |estimated: Option<Estimated>| {
            estimated.map(|found| json!({ "value": found.value, "std_error": found.std_error }))
        };
        let column = |column: &ColumnLook| {
            json!({
                "title": column.title, "unit": column.unit, "role": column.role, "holds": column.holds,
                "because": column.because,
            })
        };
        json!({
            "record": {
                "path": look.source.path,
                "digest": look.source.digest,
                "samples": look.record.len(),
                "duration_s": self.duration_s(),
                "sample_rate_hz": look.clock.sample_rate_hz,
                "clock": look.clock.kind.name(),
                "clock_reason": look.clock.reason,
                "columns": look.columns.iter().map(column).collect::<Vec<_>>(),
                "reading": look.source.reading,
                "findings": findings,
            },
            "oscillator": {
                "coordinate": guess::name(coordinate_of(look.source.reading.coordinate)),
                "natural_frequency_hz": number(oscillator.natural_frequency_hz()),
                "damping_ratio": number(oscillator.damping_ratio()),
                "quality_factor": resonance.map(|found| found.quality_factor),
                "half_power_width_hz": resonance.map(|found| found.half_power_width_hz),
                "damping_per_inertia": number(Some(oscillator.damping)),
                "rest": number(oscillator.rest),
                "input_gain_per_inertia": number(oscillator.input_gain),
                "basis": guess::basis(oscillator),
            },
            "modes": mode_rows(&self.modes),
        })
    }
}

/// Reads a log by the options; compares the rate that it states with its stamps.
fn read(log: &Log, reading: &Reading) -> Result<Look, WorkflowError> {
    let fault = |fault: record::Fault| WorkflowError::Record(fault.in_file(&log.name));
    let options = ReadOptions { driven: true, ..reading.options.clone() };
    let mut look = record::look(&log.name, &log.bytes, &options).map_err(WorkflowError::Record)?;
    if reading.remove_mean {
        look.record = centered(&look.record).map_err(fault)?;
    }
    look.clock = Clock::new(&look.record, reading.clock).map_err(fault)?;
    look.source.findings.extend(look.source.statements.contradictions(look.record.len(), &look.clock));
    Ok(look)
}

fn identified(log: &Log, look: Look) -> Result<Looked, WorkflowError> {
    let oscillator = identify(&look.record, &look.clock)
        .map_err(|source| WorkflowError::Identify { file: log.name.clone(), source })?;
    let modes = identify::modes(&look.record, &look.clock);
    let oscillator = match modes.as_slice() {
        [strongest, _, ..] => {
            strongest.oscillator(oscillator, modes.iter().filter(|mode| !mode.is_steady).count())
        }
        _ => oscillator,
    };
    Ok(Looked { look, without_input: false, oscillator, modes })
}
