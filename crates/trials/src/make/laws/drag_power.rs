//! Drag with any power of the velocity.

use crate::make::integrator::{Moment, TorqueLaw};

/// −β·v²·(|θ̇|/v)ᵖ·sign(θ̇): at the velocity v as large as the quadratic drag β·θ̇², with the exponent p.
pub(crate) struct DragPower {
    /// As the quadratic drag's.
    pub(crate) coefficient: f64,
    pub(crate) exponent: f64,
    /// Velocity at which the drag is that of exponent 2.
    pub(crate) velocity: f64,
}

impl TorqueLaw for DragPower {
    fn torque(&self, moment: &Moment) -> f64 {
        let relative = (moment.velocity / self.velocity).abs().powf(self.exponent);
        -self.coefficient * self.velocity * self.velocity * relative * moment.velocity.signum()
    }
}
