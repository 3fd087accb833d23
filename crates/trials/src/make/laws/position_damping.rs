//! A damping that grows with the deflection.

use crate::make::integrator::{Moment, TorqueLaw};

/// −c₂·x²·θ̇, as van der Pol's.
pub(crate) struct PositionDamping {
    pub(crate) coefficient: f64,
}

impl TorqueLaw for PositionDamping {
    fn torque(&self, moment: &Moment) -> f64 {
        -self.coefficient * moment.deflection * moment.deflection * moment.velocity
    }
}
