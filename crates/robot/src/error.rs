//! Errors of models and logs of several joints.

use dynamics::tree::TreeError;
use thiserror::Error;

/// Reason why a model or a log of several joints cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RobotError {
    /// The file is not XML.
    #[error("{file}: is no URDF: {problem}")]
    NotXml {
        /// Name of the file.
        file: String,
        /// Fault that was found, with line and column.
        problem: String,
    },
    /// An element is missing or wrong.
    #[error("{file}:{line}:{column}: {problem}")]
    Element {
        /// Name of the file.
        file: String,
        /// Line of the element, from 1.
        line: u32,
        /// Column of the element, from 1.
        column: u32,
        /// Fault that was found, and its remedy.
        problem: String,
    },
    /// The bodies form no tree.
    #[error("{file}: {source}")]
    Tree {
        /// Name of the file.
        file: String,
        /// Fault that was found.
        source: TreeError,
    },
    /// A model is read by another program, which is absent or refuses it.
    #[error("{file}: {problem}")]
    Simulator {
        /// Name of the file.
        file: String,
        /// Reason, and its remedy.
        problem: String,
    },
    /// A motion cannot be computed.
    #[error(transparent)]
    Motion(#[from] TreeError),
    /// The joints of the log are not those of the model.
    #[error(
        "{log}: no column belongs to a joint of the model, whose joints are {joints}; the header has {columns}. Expected names \
         such as {example}, or state the columns: --columns {option}"
    )]
    NoJoint {
        /// Name of the log.
        log: String,
        /// Joints of the model.
        joints: String,
        /// Columns of the log.
        columns: String,
        /// Names that would have been found.
        example: String,
        /// Value of the option.
        option: String,
    },
    /// A column is missing.
    #[error(
        "{log}: there is no column for the {quantity} of joint `{joint}` (the header has {columns}); state it: --columns {option}"
    )]
    NoColumn {
        /// Name of the log.
        log: String,
        /// Quantity that is missing: position or torque.
        quantity: &'static str,
        /// Joint that lacks it.
        joint: String,
        /// Columns of the log.
        columns: String,
        /// Value of the option.
        option: String,
    },
    /// An option names something unknown.
    #[error("`{name}` is no {what}; known are {known}")]
    Unknown {
        /// Name as given.
        name: String,
        /// Kind of thing that was asked for.
        what: &'static str,
        /// Known names.
        known: String,
    },
    /// A value of `--columns` or `--armature` has the wrong form.
    #[error("`{text}`: expected {expected}")]
    Form {
        /// Value as given.
        text: String,
        /// Expected form, with an example.
        expected: &'static str,
    },
    /// A recording is too short.
    #[error(
        "{log}: lasts {seconds:.2} s; a joint's motion is diagnosed from 1 s on: record several seconds of motion in both directions"
    )]
    Short {
        /// Name of the log.
        log: String,
        /// Length in seconds.
        seconds: f64,
    },
    /// The angles look like degrees.
    #[error(
        "{log}: joint `{joint}` moves over {span:.0} by column `{column}`, {turns:.0} full turns if these are radians: they look like degrees; set --unit deg, or --unit rad if they are radians"
    )]
    Degrees {
        /// Name of the log.
        log: String,
        /// Name of the joint.
        joint: String,
        /// Name of the column.
        column: String,
        /// Largest difference of two positions.
        span: f64,
        /// The same in full turns.
        turns: f64,
    },
    /// A joint hardly moves.
    #[error(
        "joint `{joint}` does not move in any recording; leave it out with --joint, or record a motion of it"
    )]
    Still {
        /// Name of the joint.
        joint: String,
    },
    /// The model could not be evaluated.
    #[error("the model gives no {quantity}: {problem}")]
    Model {
        /// Quantity that was asked for.
        quantity: &'static str,
        /// Fault that was found.
        problem: String,
    },
}
