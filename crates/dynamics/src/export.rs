//! Effects as code for other simulators.

/// Effect as pieces of code.
///
/// Expressions are written so that Python and Modelica read them alike: `+ - * /`, parentheses, and `sin`,
/// `exp`, `abs`, `min`, `max`, `sign`. They may use `time`, `position`, `velocity`, `direction` (the sign of
/// the velocity), `drive` (the input's torque), the nominal `inertia`, `damping`, `stiffness`, `rest_angle`,
/// and in braces the effect's own parameters and hidden states: `{torque}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Export {
    /// Torque that the effect adds; `None` if it acts otherwise, as a delay of the input does.
    pub torque: Option<&'static str>,
    /// Hidden states of the effect.
    pub states: &'static [StateExport],
    /// Attribute of a joint in a robot description.
    pub joint: Joint,
}

/// Hidden state as code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateExport {
    /// Name of the state.
    pub name: &'static str,
    /// Time derivative of the state.
    pub rate: &'static str,
    /// Value at the start, from `position` and `velocity`.
    pub start: &'static str,
}

/// Effect as an attribute of a joint, by the names of its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// No such attribute exists.
    Absent,
    /// Dry friction with this torque.
    Friction(&'static str),
    /// Shift of the relaxed spring by this torque over the stiffness.
    SpringShift(&'static str),
    /// Second body on the first, with a joint of its own of these parameters, whose two hidden states are the
    /// position and the velocity of that body.
    SecondBody {
        /// Inertia of the body.
        inertia: &'static str,
        /// Stiffness of its joint.
        stiffness: &'static str,
        /// Damping of its joint.
        damping: &'static str,
    },
    /// Weight of a mass with this torque when held level, at this angle from hanging straight down.
    Weight {
        /// Weight times lever arm.
        torque: &'static str,
        /// Angle from hanging straight down at position 0.
        angle: &'static str,
    },
}

impl Export {
    /// Creates an effect that adds a torque, without hidden states or an attribute of its own.
    #[must_use]
    pub const fn torque(expression: &'static str) -> Self {
        Self { torque: Some(expression), states: &[], joint: Joint::Absent }
    }
}
