//! Exponential spring: a spring that is stiffer on one side.

use crate::make::integrator::{Moment, TorqueLaw};

/// −2·k₂·(e^(s·x) − 1 − s·x)/s²: the leading term is −k₂·x², and all higher powers follow.
pub(crate) struct ExponentialSpring {
    /// k₂, as in the asymmetric stiffness.
    pub(crate) coefficient: f64,
    /// s, in 1/rad: reciprocal of the deflection at which higher powers matter.
    pub(crate) steepness: f64,
}

impl TorqueLaw for ExponentialSpring {
    fn torque(&self, moment: &Moment) -> f64 {
        let argument = self.steepness * moment.deflection;
        -2.0 * self.coefficient * (argument.exp_m1() - argument) / self.steepness.powi(2)
    }
}
