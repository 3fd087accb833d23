//! Reasons why records and a nominal simulator give no answer.

use diagnosis::DiagnosisError;
use identify::IdentifyError;
use record::RecordError;
use settings::SettingsError;
use thiserror::Error;

/// Reason why records and a nominal simulator give no answer; messages name the options of the command line.
#[derive(Debug, Error)]
pub enum WorkflowError {
    /// A record that cannot be read; its message names options in place of configuration keys.
    #[error("{}", in_options(&.0.to_string()))]
    Record(RecordError),
    /// A nominal simulator's file with a wrong key or value.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Records that say nothing, or are not of the nominal system.
    #[error("{file}: {}", source.to_string().replace("unit = \"deg\"", "--unit deg"))]
    Diagnosis {
        /// The record that the message is about.
        file: String,
        /// The fault.
        source: DiagnosisError,
    },
    /// A driven system whose record holds no input.
    #[error(
        "{file}: the nominal simulator has an input_gain, so an input drives the system, but the record has no input \
         column; name it with --input (the header has {columns})"
    )]
    MissingInput {
        /// The record.
        file: String,
        /// The columns that it has.
        columns: String,
    },
    /// A record in a unit that the nominal coordinate cannot have.
    #[error(
        "{file}: the record is in {found}, the nominal simulator's coordinate asks for {expected}; name the column \
         with --value, its unit with --unit, or set `coordinate` in the nominal simulator's file"
    )]
    OtherUnit {
        /// The record.
        file: String,
        /// Unit of the record.
        found: &'static str,
        /// Unit of the nominal coordinate.
        expected: &'static str,
    },
    /// A file that is no nominal simulator.
    #[error(
        "{file}: cannot be used: {problem}; expected a TOML file with inertia, damping, stiffness and rest_angle"
    )]
    Nominal {
        /// The file.
        file: String,
        /// Its fault.
        problem: String,
    },
    /// A configuration in the place of a nominal simulator.
    #[error(
        "{file}: is the configuration of an experiment, which `{command}` runs, not a nominal simulator; --nominal takes a TOML \
         file with inertia, damping, stiffness and rest_angle: `trainer init LOG` writes one"
    )]
    NominalIsConfiguration {
        /// The file.
        file: String,
        /// The command that runs it.
        command: String,
    },
    /// A folder that stands for no records.
    #[error("{folder}: {problem}; {remedy}")]
    NoLogs {
        /// The folder.
        folder: String,
        /// Its fault.
        problem: String,
        /// What to name in its place.
        remedy: String,
    },
    /// One record given twice.
    #[error(
        "{first} and {second} are the same record ({digest}), which would count as two that agree; name each record once"
    )]
    SameRecord {
        /// The first of the two.
        first: String,
        /// The other one.
        second: String,
        /// Their digest.
        digest: String,
    },
    /// A record that shows no oscillator.
    #[error("{file}: {source}")]
    Identify {
        /// The record.
        file: String,
        /// The fault.
        source: IdentifyError,
    },
}

/// A sentence that names keys of the configuration's section `data`, with the command line's options in their place:
/// `data.time_unit` becomes --time-unit.
#[must_use]
pub fn in_options(text: &str) -> String {
    let mut parts = text.split("`data.");
    // Splitting gives at least one part.
    let mut told = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (key, rest) = part.split_once('`').unwrap_or((part, ""));
        told.push_str(&format!("--{}{rest}", key.trim_end_matches("_hz").replace('_', "-")));
    }
    told.replace("data.format = \"csv\"", "--format csv")
}
