//! Parameters of a fit, and the hidden state variables that its segments fit.

use crate::data::scales::Scales;

/// Fit parameter. Its name goes into the answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) name: &'static str,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// `true` if the effect is absent where this parameter is 0 (and 0 is its bound): a fit that ends there
    /// rejects the effect.
    pub(crate) strength: bool,
    /// `true` if the parameter describes the form of the effect rather than its size: a width, a frequency, a
    /// phase. It is undefined while the effect has no size.
    pub(crate) shape: bool,
    /// `true` if the effect becomes another, simpler one at this parameter's lower bound: a fit that ends
    /// there rejects it too. Stribeck friction whose excess is lost at the slowest speeds is Coulomb
    /// friction.
    pub(crate) simpler: bool,
}

impl Parameter {
    /// Creates a parameter of either sign.
    pub(crate) const fn any(name: &'static str) -> Self {
        Self::within(name, f64::NEG_INFINITY, f64::INFINITY)
    }

    /// Creates a parameter between two bounds.
    pub(crate) const fn within(name: &'static str, lower: f64, upper: f64) -> Self {
        Self { name, lower, upper, strength: false, shape: false, simpler: false }
    }

    /// Creates a size from 0, at which the effect is absent.
    pub(crate) const fn strength(name: &'static str) -> Self {
        Self::strength_up_to(name, f64::INFINITY)
    }

    /// Creates a size from 0 with an upper bound.
    pub(crate) const fn strength_up_to(name: &'static str, upper: f64) -> Self {
        Self { strength: true, ..Self::within(name, 0.0, upper) }
    }

    /// Creates a shape between two bounds.
    pub(crate) const fn shape(name: &'static str, lower: f64, upper: f64) -> Self {
        Self { shape: true, ..Self::within(name, lower, upper) }
    }

    /// Creates a shape at whose lower bound the effect becomes another, simpler one.
    pub(crate) const fn simplifying_shape(name: &'static str, lower: f64, upper: f64) -> Self {
        Self { simpler: true, ..Self::shape(name, lower, upper) }
    }
}

/// Kind of a hidden state variable that segments fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hidden {
    Position,
    Velocity,
    /// Between −1 and 1.
    Share,
}

impl Hidden {
    /// Returns the size that such a variable has in a record's motion, with which a fit keeps its steps bounded. A
    /// share has none: fits that held it back needed more steps and ended no better.
    pub(crate) fn scale(self, facts: &Scales) -> Option<f64> {
        match self {
            Self::Position => Some(facts.amplitude),
            Self::Velocity => Some(facts.amplitude * facts.frequency),
            Self::Share => None,
        }
    }
}
