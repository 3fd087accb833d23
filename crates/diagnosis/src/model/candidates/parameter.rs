//! Parameters as a fit moves them.

/// A parameter that a fit moves. Its name and unit go to the answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) name: &'static str,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Whether the effect is gone where this parameter is 0 (and 0 is its bound): a fit that ends there
    /// rejects the effect.
    pub(crate) strength: bool,
    /// Whether it says how the effect looks rather than how large it is: a width, a frequency, a phase. It means
    /// nothing while the effect has no size.
    pub(crate) shape: bool,
    /// Whether the effect is another, simpler one where this parameter is at its lower end: a fit that ends
    /// there rejects it too. Stribeck friction whose excess is gone at the slowest speeds is Coulomb
    /// friction.
    pub(crate) simpler: bool,
}

impl Parameter {
    /// A number of either sign.
    pub(crate) const fn any(name: &'static str) -> Self {
        Self::within(name, f64::NEG_INFINITY, f64::INFINITY)
    }

    /// A number between two bounds.
    pub(crate) const fn within(name: &'static str, lower: f64, upper: f64) -> Self {
        Self { name, lower, upper, strength: false, shape: false, simpler: false }
    }

    /// A size from 0, without which the effect is gone.
    pub(crate) const fn strength(name: &'static str) -> Self {
        Self::strength_up_to(name, f64::INFINITY)
    }

    /// The same with an upper bound.
    pub(crate) const fn strength_up_to(name: &'static str, upper: f64) -> Self {
        Self { strength: true, ..Self::within(name, 0.0, upper) }
    }

    /// A shape between two bounds.
    pub(crate) const fn shape(name: &'static str, lower: f64, upper: f64) -> Self {
        Self { shape: true, ..Self::within(name, lower, upper) }
    }

    /// A shape at whose lower bound the effect is another, simpler one.
    pub(crate) const fn simplifying_shape(name: &'static str, lower: f64, upper: f64) -> Self {
        Self { simpler: true, ..Self::shape(name, lower, upper) }
    }
}
