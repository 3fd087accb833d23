//! What an effect looks like in other simulators.

/// An effect as pieces of code.
///
/// Expressions are written so that Python and Modelica read them alike: `+ - * /`, parentheses, and `sin`,
/// `exp`, `abs`, `min`, `max`, `sign`. They may use `time`, `position`, `velocity`, `direction` (the sign of
/// the velocity), `drive` (the input's torque), the nominal `inertia`, `damping`, `stiffness`, `rest_angle`,
/// and in braces the effect's own parameters and hidden states: `{torque}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Export {
    /// The torque that it adds; none where it acts otherwise, as a delay of the input does.
    pub torque: Option<&'static str>,
    /// Its hidden states.
    pub states: &'static [StateExport],
    /// Attribute of a joint in a robot's description.
    pub joint: Joint,
}

/// A hidden state as code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateExport {
    /// Its name.
    pub name: &'static str,
    /// Its time derivative.
    pub rate: &'static str,
    /// Its value at the start, from `position` and `velocity`.
    pub start: &'static str,
}

/// An effect as an attribute of a joint, by the names of its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// There is no such attribute.
    Absent,
    /// Dry friction of this torque.
    Friction(&'static str),
    /// A shift of the relaxed spring by this torque over the stiffness.
    SpringShift(&'static str),
    /// The weight of a mass with this torque when held level, at this angle from hanging straight down.
    Weight {
        /// Weight times lever arm.
        torque: &'static str,
        /// Angle from hanging straight down at position 0.
        angle: &'static str,
    },
}

impl Export {
    /// An effect that adds a torque, without hidden states or an attribute of its own.
    #[must_use]
    pub const fn torque(expression: &'static str) -> Self {
        Self { torque: Some(expression), states: &[], joint: Joint::Absent }
    }
}
