//! Errors of a system or a simulation.

use crate::description::Range;
use thiserror::Error;

/// Error for an invalid system, or for a motion that cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DynamicsError {
    /// A nominal coefficient is outside its range.
    #[error("nominal `{parameter}` is {value}; expected {range}")]
    NominalOutOfRange {
        /// Name of the coefficient.
        parameter: &'static str,
        /// Value of the coefficient.
        value: f64,
        /// Admissible range.
        range: Range,
    },
    /// An id is not in the registry.
    #[error("unknown effect `{id}`; known are {}", known.join(", "))]
    UnknownEffect {
        /// Id as given.
        id: String,
        /// Every known id.
        known: Vec<&'static str>,
    },
    /// A parameter is unknown to the effect.
    #[error("`{effect}` has no parameter `{parameter}`; it has {}", known.join(", "))]
    UnknownParameter {
        /// Id of the effect.
        effect: &'static str,
        /// Name as given.
        parameter: String,
        /// Names of the effect's parameters.
        known: Vec<&'static str>,
    },
    /// A parameter has no value.
    #[error("`{effect}` lacks its parameter `{parameter}` ({meaning}); expected {range}")]
    MissingParameter {
        /// Id of the effect.
        effect: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Meaning of the parameter.
        meaning: &'static str,
        /// Admissible range.
        range: Range,
    },
    /// The number of values is wrong.
    #[error("`{effect}` takes {expected} values, not {found}")]
    WrongNumberOfValues {
        /// Id of the effect.
        effect: &'static str,
        /// Number of the effect's parameters.
        expected: usize,
        /// Number of values given.
        found: usize,
    },
    /// The number of hidden states is wrong.
    #[error("`{effect}` has {expected} hidden states, not {found}")]
    WrongNumberOfStates {
        /// Id of the effect.
        effect: &'static str,
        /// Number of the effect's hidden states.
        expected: usize,
        /// Number of states given.
        found: usize,
    },
    /// A parameter is outside its range.
    #[error("`{effect}`: `{parameter}` is {value}; expected {range}")]
    OutOfRange {
        /// Id of the effect.
        effect: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Admissible range.
        range: Range,
    },
    /// Two parameters contradict each other.
    #[error("`{effect}`: `{parameter}` is {value}, but must be {relation} {bound} ({reason})")]
    Contradiction {
        /// Id of the effect.
        effect: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Required relation, such as `at least`.
        relation: &'static str,
        /// Number that the value is compared with.
        bound: f64,
        /// Meaning of that number.
        reason: &'static str,
    },
    /// An effect is given twice.
    #[error("`{effect}` is given twice; combine the two into one")]
    Duplicate {
        /// Id of the effect.
        effect: &'static str,
    },
    /// An effect of the measurement chain is given where one of the system is expected.
    #[error(
        "`{effect}` belongs to the measurement chain and does not change the motion; apply it to the samples"
    )]
    NotInTheSystem {
        /// Id of the effect.
        effect: &'static str,
    },
    /// An effect of the system is given where one of the measurement chain is expected.
    #[error("`{effect}` changes the motion and does not belong to the measurement chain")]
    NotInTheChain {
        /// Id of the effect.
        effect: &'static str,
    },
    /// The effect has no meaning for this sensor.
    #[error("`{effect}` needs {needs}")]
    NotForThisSensor {
        /// Id of the effect.
        effect: &'static str,
        /// Requirement of the effect.
        needs: &'static str,
    },
    /// The standard deviation of the noise is invalid.
    #[error("the sensor's noise is {value}; expected a finite number of 0 or above")]
    BadNoise {
        /// Standard deviation as given.
        value: f64,
    },
    /// The columns of a sampled motion differ in length.
    #[error("the sampled {what} holds {found} numbers for {times} times; expected one each, at least two")]
    UnequalLengths {
        /// Name of the column.
        what: &'static str,
        /// Length of the column.
        found: usize,
        /// Number of times.
        times: usize,
    },
    /// A release from rest is inside the dead zone, where the spring does not pull.
    #[error(
        "the dead zone of `backlash`, ±{half_width}, is wider than the release, {release} from the rest \
         angle: nothing would move. Release from farther out or narrow the dead zone"
    )]
    ReleaseInsideDeadZone {
        /// Half the width of the dead zone.
        half_width: f64,
        /// Distance of the release from the rest angle.
        release: f64,
    },
    /// An input is not a function of time.
    #[error("the input's {what} at index {index}: {value}; {remedy}")]
    BadInput {
        /// Number that is wrong.
        what: &'static str,
        /// Index of the sample, from 0.
        index: usize,
        /// Number at that index.
        value: f64,
        /// Advice that makes the input valid.
        remedy: &'static str,
    },
    /// Times decrease, or are not finite.
    #[error("time {index} is {value} s; times must be finite and never decrease")]
    BadTimes {
        /// Index in the list, from 0.
        index: usize,
        /// Time at that index, in seconds.
        value: f64,
    },
    /// A start state is not finite.
    #[error("the start's {what} is {value}; it must be finite")]
    BadStart {
        /// Part of the state: `position` or `velocity`.
        what: &'static str,
        /// Value of that part.
        value: f64,
    },
    /// A parameter is named as free that the system does not have.
    #[error("`{parameter}` cannot be free: {reason}")]
    NotFree {
        /// Parameter as named.
        parameter: String,
        /// Reason why it cannot be free.
        reason: &'static str,
    },
    /// The motion diverges.
    #[error(
        "the motion diverges at {time_s} s (position {position}): is there a negative stiffness without a stop?"
    )]
    Diverged {
        /// Time of the divergence, in seconds.
        time_s: f64,
        /// Position at that time, in the coordinate's unit.
        position: f64,
    },
    /// The step would have to be smaller than rounding allows.
    #[error("at {time_s} s the step shrinks to {step_s} s without reaching the tolerance; loosen it")]
    StepTooSmall {
        /// Start of the step, in seconds.
        time_s: f64,
        /// Length of the step tried, in seconds.
        step_s: f64,
    },
    /// The maximum number of steps is used up.
    #[error("{steps} steps reach only {time_s} s; loosen the tolerance, or raise the bound on the steps")]
    TooManySteps {
        /// Number of steps taken.
        steps: usize,
        /// Time reached, in seconds.
        time_s: f64,
    },
}
