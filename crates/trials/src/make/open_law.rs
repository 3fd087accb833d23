//! Laws whose size is open.

use super::integrator::TorqueLaw;

/// A law whose size is open.
pub(crate) struct OpenLaw {
    /// A size to start from.
    pub(crate) guess: f64,
    /// The largest that makes sense.
    pub(crate) most: f64,
    /// Makes the law at a size.
    pub(crate) law: Box<dyn Fn(f64) -> Box<dyn TorqueLaw>>,
}

impl OpenLaw {
    /// A law as a function of its size.
    pub(crate) fn new<L: TorqueLaw + 'static>(
        guess: f64,
        most: f64,
        law: impl Fn(f64) -> L + 'static,
    ) -> Self {
        Self { guess, most, law: Box::new(move |size| Box::new(law(size))) }
    }
}

/// A law of the size found, and how detectable it is.
pub(crate) struct SizedLaw {
    pub(crate) law: Box<dyn TorqueLaw>,
    pub(crate) size: f64,
    pub(crate) detectability: f64,
}
