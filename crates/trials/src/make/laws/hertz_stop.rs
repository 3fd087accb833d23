//! End stop with a curved contact (Hertz).

use crate::make::integrator::{Moment, TorqueLaw};

/// −k·p^1.5·max(0, 1 + χ·ṗ), directed away from the stop, where p is the depth of penetration.
///
/// # Reference
/// Hunt, Crossley, Journal of Applied Mechanics 42 (1975) 440, with Hertz's power of 3/2.
pub(crate) struct HertzStop {
    /// Distance of the stop from the rest angle, in rad; the sign gives the side.
    pub(crate) deflection: f64,
    /// k, in torque per rad^1.5.
    pub(crate) stiffness: f64,
    /// χ, in s/rad.
    pub(crate) dissipation: f64,
}

impl TorqueLaw for HertzStop {
    fn torque(&self, moment: &Moment) -> f64 {
        let side = self.deflection.signum();
        let depth = (moment.deflection - self.deflection) * side;
        if depth <= 0.0 {
            return 0.0;
        }
        let loss = (1.0 + self.dissipation * moment.velocity * side).max(0.0);
        -self.stiffness * depth * depth.sqrt() * loss * side
    }
}
