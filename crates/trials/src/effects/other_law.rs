//! Alternative laws of effects, in place of the vocabulary's own.

use crate::make::draws::Draws;
use crate::make::integrator::TorqueLaw;
use crate::make::open_law::OpenLaw;
use crate::make::situation::Situation;

/// Law that differs from the vocabulary's but is the same effect.
#[derive(Clone, Copy)]
pub(crate) struct OtherLaw {
    /// Name used in hidden truths.
    pub(crate) name: &'static str,
    /// Draws the law's shape for a system.
    pub(crate) draw: fn(&Situation, &mut Draws) -> DrawnLaw,
}

/// Alternative law with its shape drawn.
pub(crate) struct DrawnLaw {
    pub(crate) open: OpenLaw,
    /// Parameters of the vocabulary's law that come closest, as a function of the size.
    pub(crate) parameters: Box<dyn Fn(f64) -> Vec<f64>>,
    /// Description of the shape.
    pub(crate) words: String,
}

impl DrawnLaw {
    /// Builds a drawn law from the law and its parameters in the vocabulary, both as functions of the size;
    /// `guess` and `most` are those of [`OpenLaw`].
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
