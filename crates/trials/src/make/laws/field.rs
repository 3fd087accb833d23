//! A smooth torque of no known kind.

use crate::make::integrator::{Moment, TorqueLaw};

/// τ·Σ aᵢ·sin(kᵢ·x/A + lᵢ·ẋ/V + φᵢ): a random Fourier series in position and velocity.
pub(crate) struct Field {
    /// τ.
    pub(crate) torque: f64,
    /// A, in rad.
    pub(crate) swing: f64,
    /// V, in rad/s.
    pub(crate) speed: f64,
    /// aᵢ, kᵢ, lᵢ and φᵢ.
    pub(crate) terms: Vec<[f64; 4]>,
}

impl TorqueLaw for Field {
    fn torque(&self, moment: &Moment) -> f64 {
        let (x, v) = (moment.deflection / self.swing, moment.velocity / self.speed);
        self.torque * self.terms.iter().map(|[a, k, l, phase]| a * (k * x + l * v + phase).sin()).sum::<f64>()
    }
}
