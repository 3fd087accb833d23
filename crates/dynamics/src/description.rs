//! Descriptions of effects as data.

use crate::units::Quantity;

/// Part of the simulation in which an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// In the system: it changes the motion.
    System,
    /// In the measurement chain: it changes what the file says about the motion.
    MeasuringChain,
}

/// Class of the gap budget that an effect belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// Takes energy out of the motion; depends on its direction.
    Dissipative,
    /// Stores energy and gives it back; depends on position.
    Conservative,
    /// Depends on time: drifts, forcing, the input's path.
    TimeDependent,
    /// Distorts the values.
    Sensor,
    /// Distorts the times.
    Clock,
}

/// Range of values that a parameter may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower end.
    pub minimum: f64,
    /// Upper end.
    pub maximum: f64,
    /// `true` if the ends themselves are included.
    pub closed: bool,
}

impl Range {
    /// Any finite number.
    pub const ANY: Self = Self { minimum: f64::NEG_INFINITY, maximum: f64::INFINITY, closed: false };
    /// Above 0.
    pub const POSITIVE: Self = Self { minimum: 0.0, maximum: f64::INFINITY, closed: false };
    /// 0 or above.
    pub const NON_NEGATIVE: Self = Self { minimum: 0.0, maximum: f64::INFINITY, closed: true };
    /// Any finite angle up to a full turn in either direction.
    pub const TURN: Self =
        Self { minimum: -std::f64::consts::TAU, maximum: std::f64::consts::TAU, closed: true };

    /// Returns `true` if a value is finite and inside the range.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        let inside = if self.closed {
            value >= self.minimum && value <= self.maximum
        } else {
            value > self.minimum && value < self.maximum
        };
        inside && value.is_finite()
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.minimum.is_finite(), self.maximum.is_finite(), self.closed) {
            (false, false, _) => f.write_str("a finite number"),
            (true, false, true) => write!(f, "a finite number of {} or above", self.minimum),
            (true, false, false) => write!(f, "a finite number above {}", self.minimum),
            (false, true, true) => write!(f, "a finite number of {} or below", self.maximum),
            (false, true, false) => write!(f, "a finite number below {}", self.maximum),
            (true, true, true) => write!(f, "from {} to {}", self.minimum, self.maximum),
            (true, true, false) => write!(f, "between {} and {}", self.minimum, self.maximum),
        }
    }
}

/// Parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name in configurations and results, such as `torque`.
    pub name: &'static str,
    /// Symbol in equations, such as `τ_c`.
    pub symbol: &'static str,
    /// Physical quantity; its unit follows from the system's units.
    pub quantity: Quantity,
    /// Physically admissible values.
    pub range: Range,
    /// Meaning, a phrase.
    pub meaning: &'static str,
    /// Value if none is given; `None` if a value is required. Only the last parameters of an effect have a
    /// default.
    pub default: Option<f64>,
}

/// Description of an effect, shared by simulator, diagnosis, documents and listings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Description {
    /// Public id, such as `coulomb_friction`.
    pub id: &'static str,
    /// Title for tables.
    pub title: &'static str,
    /// Part of the simulation in which the effect acts.
    pub kind: Kind,
    /// Class of the gap budget.
    pub class: Class,
    /// Torque or change that the effect adds, as plain text.
    pub equation: &'static str,
    /// Equation in LaTeX.
    pub latex: &'static str,
    /// Parameters, in the order in which values are given; at most [`crate::MOST_PARAMETERS`].
    pub parameters: &'static [Parameter],
    /// Signature in a free decay, or under drive.
    pub tell_tale: &'static str,
    /// Ids of effects that it is easily confused with when the data are poor.
    pub confused_with: &'static [&'static str],
    /// Literature.
    pub reference: &'static str,
    /// `true` if the effect acts only with an input.
    pub driven_only: bool,
    /// Number of hidden state variables of the effect.
    pub hidden_states: usize,
    /// `true` if the law has a continuous derivative everywhere: no switching.
    pub smooth: bool,
    /// Values of the parameters, per unit of inertia, at which the effect is plain to see over 25 s of a swing of
    /// 3.5 Hz from 0.7 rad, or of a drive by a torque of about 12 rad/s². Tests and the book's plots use them.
    pub example: &'static [f64],
}

impl Description {
    /// Returns the position of a parameter in the order of values; `None` if there is no such parameter.
    #[must_use]
    pub fn parameter_index(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.name == name)
    }
}
