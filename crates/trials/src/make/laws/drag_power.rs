//! Drag with any power of the velocity.

use crate::make::integrator::{Moment, TorqueLaw};

/// −β·v²·(|θ̇|/v)ᵖ·sign(θ̇): drag with exponent p that equals the quadratic drag β·θ̇² at the velocity v.
pub(crate) struct DragPower {
    /// β, as in the quadratic drag.
    pub(crate) coefficient: f64,
    pub(crate) exponent: f64,
    /// v, in rad/s: velocity at which the drag equals that of exponent 2.
    pub(crate) velocity: f64,
}

impl TorqueLaw for DragPower {
    fn torque(&self, moment: &Moment) -> f64 {
        let relative = (moment.velocity / self.velocity).abs().powf(self.exponent);
        -self.coefficient * self.velocity * self.velocity * relative * moment.velocity.signum()
    }
}
