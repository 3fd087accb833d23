//! What can be wrong with a system or a simulation.

use crate::description::Range;
use thiserror::Error;

/// A system that cannot be, or a motion that cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DynamicsError {
    /// A nominal coefficient outside its range.
    #[error("nominal `{parameter}` is {value}; expected {range}")]
    NominalOutOfRange {
        /// The coefficient's name.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What is admitted.
        range: Range,
    },
    /// An id that is not in the registry.
    #[error("unknown effect `{id}`; known are {}", known.join(", "))]
    UnknownEffect {
        /// The id as given.
        id: String,
        /// Every known id.
        known: Vec<&'static str>,
    },
    /// A parameter that the effect does not have.
    #[error("`{effect}` has no parameter `{parameter}`; it has {}", known.join(", "))]
    UnknownParameter {
        /// The effect's id.
        effect: &'static str,
        /// The name as given.
        parameter: String,
        /// The parameters it has.
        known: Vec<&'static str>,
    },
    /// A parameter without a value.
    #[error("`{effect}` lacks its parameter `{parameter}` ({meaning}); expected {range}")]
    MissingParameter {
        /// The effect's id.
        effect: &'static str,
        /// The parameter's name.
        parameter: &'static str,
        /// What it means.
        meaning: &'static str,
        /// What is admitted.
        range: Range,
    },
    /// The wrong number of values.
    #[error("`{effect}` takes {expected} values, not {found}")]
    WrongNumberOfValues {
        /// The effect's id.
        effect: &'static str,
        /// How many parameters it has.
        expected: usize,
        /// How many values were given.
        found: usize,
    },
    /// A parameter outside its range.
    #[error("`{effect}`: `{parameter}` is {value}; expected {range}")]
    OutOfRange {
        /// The effect's id.
        effect: &'static str,
        /// The parameter's name.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What is admitted.
        range: Range,
    },
    /// Two parameters that contradict each other.
    #[error("`{effect}`: `{parameter}` is {value}, but must be {relation} {bound} ({reason})")]
    Contradiction {
        /// The effect's id.
        effect: &'static str,
        /// The parameter's name.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// The relation demanded, such as `at least`.
        relation: &'static str,
        /// The number it is compared with.
        bound: f64,
        /// What that number is.
        reason: &'static str,
    },
    /// One effect twice.
    #[error("`{effect}` is given twice; combine the two into one")]
    Duplicate {
        /// The effect's id.
        effect: &'static str,
    },
    /// An effect of the measuring chain where one of the system is expected.
    #[error(
        "`{effect}` belongs to the measurement chain and does not change the motion; apply it to the samples"
    )]
    NotInTheSystem {
        /// The effect's id.
        effect: &'static str,
    },
    /// An effect in the system where one of the measuring chain is expected.
    #[error("`{effect}` changes the motion and does not belong to the measurement chain")]
    NotInTheChain {
        /// The effect's id.
        effect: &'static str,
    },
    /// A sensor on which the effect has no meaning.
    #[error("`{effect}` needs {needs}")]
    NotForThisSensor {
        /// The effect's id.
        effect: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// A standard deviation of noise that is none.
    #[error("the sensor's noise is {value}; expected a finite number of 0 or above")]
    BadNoise {
        /// The standard deviation as given.
        value: f64,
    },
    /// Columns of a sampled motion that do not belong together.
    #[error("the sampled {what} holds {found} numbers for {times} times; expected one each, at least two")]
    UnequalLengths {
        /// The column.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Number of times.
        times: usize,
    },
    /// A release from rest inside the dead zone: the spring does not pull.
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
    /// An input that is no function of time.
    #[error("the input's {what} at index {index}: {value}; {remedy}")]
    BadInput {
        /// What is wrong.
        what: &'static str,
        /// Where, from 0.
        index: usize,
        /// The number there.
        value: f64,
        /// What to do.
        remedy: &'static str,
    },
    /// Times that do not increase, or are not finite.
    #[error("time {index} is {value} s; times must be finite and never decrease")]
    BadTimes {
        /// Position in the list, from 0.
        index: usize,
        /// The time there, in seconds.
        value: f64,
    },
    /// A start state that is not finite.
    #[error("the start's {what} is {value}; it must be finite")]
    BadStart {
        /// Which part of the state.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter named as free that the system does not have.
    #[error("`{parameter}` cannot be free: {reason}")]
    NotFree {
        /// The parameter as named.
        parameter: String,
        /// Why it is not to be had.
        reason: &'static str,
    },
    /// The motion runs away.
    #[error(
        "the motion diverges at {time_s} s (position {position}): is there a negative stiffness without a stop?"
    )]
    Diverged {
        /// When, in seconds.
        time_s: f64,
        /// Where, in the coordinate's unit.
        position: f64,
    },
    /// The step would have to be smaller than rounding allows.
    #[error("at {time_s} s the step shrinks to {step_s} s without reaching the tolerance; loosen it")]
    StepTooSmall {
        /// When, in seconds.
        time_s: f64,
        /// The step tried, in seconds.
        step_s: f64,
    },
    /// The work allotted is spent.
    #[error("{steps} steps reach only {time_s} s; loosen the tolerance, or raise the bound on the steps")]
    TooManySteps {
        /// Steps taken.
        steps: usize,
        /// The time reached, in seconds.
        time_s: f64,
    },
}
