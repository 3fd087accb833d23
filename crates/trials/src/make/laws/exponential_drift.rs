//! Stiffness or damping that settles at another value.

use crate::make::integrator::{Moment, TorqueLaw};

/// Coefficient that drifts.
#[derive(Clone, Copy)]
pub(crate) enum Drifting {
    /// Spring, with this stiffness.
    Stiffness(f64),
    /// Damper, with this damping.
    Damping(f64),
}

/// −k·x·a·(1 − e^(−t/T))·T, or the same with c·θ̇: a warm-up that comes to an end, with the initial rate a.
pub(crate) struct ExponentialDrift {
    pub(crate) of: Drifting,
    /// a: relative change per second at the start.
    pub(crate) rate: f64,
    /// T: time constant in seconds.
    pub(crate) settling: f64,
}

impl TorqueLaw for ExponentialDrift {
    fn torque(&self, moment: &Moment) -> f64 {
        let change = -self.rate * self.settling * (-moment.time / self.settling).exp_m1();
        match self.of {
            Drifting::Stiffness(stiffness) => -stiffness * change * moment.deflection,
            Drifting::Damping(damping) => -damping * change * moment.velocity,
        }
    }
}
