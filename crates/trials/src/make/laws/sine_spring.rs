//! Sine spring: a spring whose torque is a sine.

use crate::make::integrator::{Moment, TorqueLaw};

/// 6·k₃·(sin(s·x) − s·x)/s³: the leading term is −k₃·x³, and all higher odd powers follow. For a spring that
/// hardens more than its cubic term, s is imaginary and the sine is hyperbolic.
pub(crate) struct SineSpring {
    /// k₃, as in the cubic stiffness.
    pub(crate) coefficient: f64,
    /// s, in 1/rad: reciprocal of the deflection at which higher powers matter.
    pub(crate) steepness: f64,
    pub(crate) hyperbolic: bool,
}

impl TorqueLaw for SineSpring {
    fn torque(&self, moment: &Moment) -> f64 {
        let argument = self.steepness * moment.deflection;
        let beyond = if self.hyperbolic { argument - argument.sinh() } else { argument.sin() - argument };
        6.0 * self.coefficient * beyond / self.steepness.powi(3)
    }
}
