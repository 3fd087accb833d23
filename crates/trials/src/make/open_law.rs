//! Laws whose size is not yet determined.

use super::integrator::TorqueLaw;

/// Law whose size is not yet determined.
pub(crate) struct OpenLaw {
    /// Size from which the search starts.
    pub(crate) guess: f64,
    /// Largest size that makes sense.
    pub(crate) most: f64,
    /// Builds the law at a size.
    pub(crate) law: Box<dyn Fn(f64) -> Box<dyn TorqueLaw>>,
}

impl OpenLaw {
    /// Wraps a law given as a function of its size.
    pub(crate) fn new<L: TorqueLaw + 'static>(
        guess: f64,
        most: f64,
        law: impl Fn(f64) -> L + 'static,
    ) -> Self {
        Self { guess, most, law: Box::new(move |size| Box::new(law(size))) }
    }
}

/// Law with a determined size, and its detectability.
pub(crate) struct SizedLaw {
    pub(crate) law: Box<dyn TorqueLaw>,
    pub(crate) size: f64,
    pub(crate) detectability: f64,
}
