//! Errors of answering a question from records and a nominal simulator.

use diagnosis::DiagnosisError;
use identify::IdentifyError;
use record::RecordError;
use robot::RobotError;
use settings::SettingsError;
use thiserror::Error;

/// Reason why records and a nominal simulator give no answer. Messages name the options of the command line.
#[derive(Debug, Error)]
pub enum WorkflowError {
    /// The header states radians, and the angles are too large for it.
    #[error(
        "{file} swings out to {largest:.1} rad by its header, {:.1} full turns: these look like degrees. Set --unit deg, or \
         --unit rad if they are radians", largest / std::f64::consts::TAU
    )]
    LooksLikeDegrees {
        /// Name of the record.
        file: String,
        /// Largest distance from the middle, in the unit taken to be radians.
        largest: f64,
    },
    /// A record cannot be read; the message names options in place of configuration keys.
    #[error("{}", in_options(&.0.to_string()))]
    Record(RecordError),
    /// The file of a nominal simulator has a wrong key or value.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The records contain no usable motion, or do not belong to the nominal system.
    #[error("{file}: {}", source.to_string().replace("unit = \"deg\"", "--unit deg"))]
    Diagnosis {
        /// Record that the message is about.
        file: String,
        /// Fault that was found.
        source: DiagnosisError,
    },
    /// The nominal system is driven, but its record holds no input.
    #[error(
        "{file}: the nominal simulator has an input_gain, so an input drives the system, but the record has no input \
         column; name it with --input (the header has {columns})"
    )]
    MissingInput {
        /// Name of the record.
        file: String,
        /// Columns of the record.
        columns: String,
    },
    /// A joint stands still in every record.
    #[error(
        "{file}: the command stands still, or the joint does not follow it, in every recording: nothing tells what the \
         simulator lacks; give a recording in which this joint moves by many steps of its sensor"
    )]
    StandsStill {
        /// Name of the first record.
        file: String,
    },
    /// A column that is taken for the command follows the one that is taken for the measured position.
    #[error(
        "{file}: `{command}` was taken for the command and `{position}` for the measured position, but `{command}` follows \
         `{position}`; exchange them: --input {position} --value {command}"
    )]
    Exchanged {
        /// Name of the record.
        file: String,
        /// Column that is taken for the command.
        command: String,
        /// Column that is taken for the measured position.
        position: String,
    },
    /// The gain of an inner loop is unknown, and a record does not tell where to begin.
    #[error(
        "{file}: the gain of [actuator] is \"unknown\", and no command of this record explains its motion well enough to \
         begin from; name the command's column with --input, or state a guess, such as proportional = {{ value = 8.0, \
         tolerance = 6.0 }}"
    )]
    UnknownGain {
        /// Name of the record.
        file: String,
    },
    /// The record has a unit that the nominal coordinate cannot have.
    #[error(
        "{file}: the record is in {found}, the nominal simulator's coordinate asks for {expected}; name the column \
         with --value, its unit with --unit, or set `coordinate` in the nominal simulator's file"
    )]
    OtherUnit {
        /// Name of the record.
        file: String,
        /// Unit of the record.
        found: &'static str,
        /// Unit of the nominal coordinate.
        expected: &'static str,
    },
    /// The file is not a nominal simulator.
    #[error(
        "{file}: cannot be used: {problem}; expected a TOML file with inertia, damping, stiffness and rest_angle"
    )]
    Nominal {
        /// Name of the file.
        file: String,
        /// Fault that was found.
        problem: String,
    },
    /// The file given as nominal simulator is the configuration of an experiment.
    #[error(
        "{file}: is the configuration of an experiment, which `{command}` runs, not a nominal simulator; --nominal takes a TOML \
         file with inertia, damping, stiffness and rest_angle: `trainer init LOG` writes one"
    )]
    NominalIsConfiguration {
        /// Name of the file.
        file: String,
        /// Command that runs the configuration.
        command: String,
    },
    /// The folder holds no logs, or is that of a finished run.
    #[error("{folder}: {problem}; {remedy}")]
    NoLogs {
        /// Path of the folder.
        folder: String,
        /// Fault that was found.
        problem: String,
        /// Advice on what to name instead.
        remedy: String,
    },
    /// One record is given twice.
    #[error(
        "{first} and {second} are the same record ({digest}), which would count as two that agree; name each record once"
    )]
    SameRecord {
        /// First of the two files.
        first: String,
        /// Second of the two files.
        second: String,
        /// Digest of both.
        digest: String,
    },
    /// A robot's model or log cannot be used.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The record shows no oscillator.
    #[error("{file}: {source}")]
    Identify {
        /// Name of the record.
        file: String,
        /// Fault that was found.
        source: IdentifyError,
    },
}

/// Replaces keys of the configuration's section `data` in a sentence by the options of the command line:
/// `data.time_unit` becomes --time-unit.
#[must_use]
pub fn in_options(text: &str) -> String {
    let Some((before, rest)) = text.split_once("`data.") else { return text.to_owned() };
    let mut told = before.to_owned();
    for part in rest.split("`data.") {
        let (key, rest) = part.split_once('`').unwrap_or((part, ""));
        told.push_str(&format!(
            "--{}{rest}",
            key.trim_end_matches("_hz").trim_end_matches("_s").replace('_', "-")
        ));
    }
    told.replace("data.format = \"csv\"", "--format csv")
}
