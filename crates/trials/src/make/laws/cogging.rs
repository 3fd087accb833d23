//! Magnetic cogging.

use crate::make::integrator::{Moment, TorqueLaw};

/// −τ·sin(n·θ + φ): a motor's magnets pull toward its teeth, n times a turn.
pub(crate) struct Cogging {
    pub(crate) torque: f64,
    pub(crate) teeth: f64,
    pub(crate) phase: f64,
}

impl TorqueLaw for Cogging {
    fn torque(&self, moment: &Moment) -> f64 {
        -self.torque * (self.teeth * moment.deflection + self.phase).sin()
    }
}
