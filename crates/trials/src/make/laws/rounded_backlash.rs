//! Play with round edges.

use crate::make::integrator::{Moment, TorqueLaw};

/// +k·b·x/√(b² + x²), which the spring loses: a dead zone of ±b whose edges are round over b.
pub(crate) struct RoundedBacklash {
    pub(crate) stiffness: f64,
    /// b in rad.
    pub(crate) half_width: f64,
}

impl TorqueLaw for RoundedBacklash {
    fn torque(&self, moment: &Moment) -> f64 {
        let x = moment.deflection;
        self.stiffness * self.half_width * x / self.half_width.hypot(x)
    }
}
