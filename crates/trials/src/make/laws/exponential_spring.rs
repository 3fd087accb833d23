//! A spring that is stiffer on one side.

use crate::make::integrator::{Moment, TorqueLaw};

/// −2·k₂·(e^(s·x) − 1 − s·x)/s²: its leading term is −k₂·x², and it has every power beyond.
pub(crate) struct ExponentialSpring {
    /// As the asymmetric stiffness's.
    pub(crate) coefficient: f64,
    /// Reciprocal of the deflection at which the further powers matter, in 1/rad.
    pub(crate) steepness: f64,
}

impl TorqueLaw for ExponentialSpring {
    fn torque(&self, moment: &Moment) -> f64 {
        let argument = self.steepness * moment.deflection;
        -2.0 * self.coefficient * (argument.exp_m1() - argument) / self.steepness.powi(2)
    }
}
