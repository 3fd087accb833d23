//! A spring whose torque is a sine.

use crate::make::integrator::{Moment, TorqueLaw};

/// 6·k₃·(sin(s·x) − s·x)/s³: its leading term is −k₃·x³, and it has every odd power beyond. With an
/// imaginary s, for a spring that stiffens more than its cube, the sine is hyperbolic.
pub(crate) struct SineSpring {
    /// As the cubic stiffness's.
    pub(crate) coefficient: f64,
    /// Reciprocal of the deflection at which the further powers matter, in 1/rad.
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
