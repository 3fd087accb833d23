//! Forcing whose phase wanders.

use crate::make::integrator::{Moment, TorqueLaw};

/// τ_f·sin(Ω·t + φ + m·sin(ω_m·t)): an unbalanced fan whose speed oscillates.
pub(crate) struct WanderingForcing {
    pub(crate) torque: f64,
    /// Ω in rad/s.
    pub(crate) frequency: f64,
    pub(crate) phase: f64,
    /// m in rad.
    pub(crate) wander: f64,
    /// ω_m in rad/s.
    pub(crate) wander_frequency: f64,
}

impl TorqueLaw for WanderingForcing {
    fn torque(&self, moment: &Moment) -> f64 {
        let wandering = self.wander * (self.wander_frequency * moment.time).sin();
        self.torque * (self.frequency * moment.time + self.phase + wandering).sin()
    }
}
