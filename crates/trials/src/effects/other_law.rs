//! Laws by which an effect acts in place of the vocabulary's own.

use crate::make::draws::Draws;
use crate::make::integrator::TorqueLaw;
use crate::make::open_law::OpenLaw;
use crate::make::situation::Situation;

/// A law unlike the vocabulary's that is the same effect.
#[derive(Clone, Copy)]
pub(crate) struct OtherLaw {
    /// Its name in hidden truths.
    pub(crate) name: &'static str,
    /// Draws its shape for a system.
    pub(crate) draw: fn(&Situation, &mut Draws) -> DrawnLaw,
}

/// A law with its shape drawn.
pub(crate) struct DrawnLaw {
    pub(crate) open: OpenLaw,
    /// Parameters by the vocabulary's law, or the nearest to them, at a size.
    pub(crate) parameters: Box<dyn Fn(f64) -> Vec<f64>>,
    /// The shape in words.
    pub(crate) words: String,
}

impl DrawnLaw {
    /// A law and its parameters by the vocabulary as functions of the size; `guess` and `most` as of an [`OpenLaw`].
    pub(crate) fn new<L: TorqueLaw + 'static>(
        guess: f64,
        most: f64,
        law: impl Fn(f64) -> L + 'static,
        parameters: impl Fn(f64) -> Vec<f64> + 'static,
        words: String,
    ) -> Self {
        Self { open: OpenLaw::new(guess, most, law), parameters: Box::new(parameters), words }
    }
}
