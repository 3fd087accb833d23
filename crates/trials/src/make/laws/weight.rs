//! Gravity: the weight of an arm.

use crate::make::integrator::{Moment, TorqueLaw};

/// −m·g·l·sin(x + φ), where φ is the arm's angle from hanging straight down, at the rest angle.
pub(crate) struct Weight {
    /// m·g·l.
    pub(crate) torque: f64,
    /// φ in rad.
    pub(crate) angle: f64,
}

impl TorqueLaw for Weight {
    fn torque(&self, moment: &Moment) -> f64 {
        -self.torque * (moment.deflection + self.angle).sin()
    }
}
