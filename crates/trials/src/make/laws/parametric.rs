//! A stiffness that is modulated.

use crate::make::integrator::{Moment, TorqueLaw};

/// −k·ε·sin(Ω·t + φ)·x.
pub(crate) struct Parametric {
    /// k·ε.
    pub(crate) stiffness: f64,
    /// Ω in rad/s.
    pub(crate) frequency: f64,
    pub(crate) phase: f64,
}

impl TorqueLaw for Parametric {
    fn torque(&self, moment: &Moment) -> f64 {
        -self.stiffness * (self.frequency * moment.time + self.phase).sin() * moment.deflection
    }
}
