//! Backlash with rounded edges.

use crate::make::integrator::{Moment, TorqueLaw};

/// +k·b·x/√(b² + x²), the torque that the spring loses: a dead zone of ±b with edges rounded over a width of
/// b.
pub(crate) struct RoundedBacklash {
    pub(crate) stiffness: f64,
    /// b: half-width of the dead zone, in rad.
    pub(crate) half_width: f64,
}

impl TorqueLaw for RoundedBacklash {
    fn torque(&self, moment: &Moment) -> f64 {
        let x = moment.deflection;
        self.stiffness * self.half_width * x / self.half_width.hypot(x)
    }
}
