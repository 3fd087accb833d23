//! Drag with any power of the velocity.

use crate::make::integrator::{Moment, TorqueLaw};

/// −β·v·(|θ̇|/v)ᵖ·sign(θ̇)·v: the drag β·θ̇² at the velocity v, with the exponent p.
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
