//! LuGre friction: dry friction by bending bristles.

use crate::make::integrator::{Hidden, Moment, TorqueLaw};

/// −σ₀·z with ż = θ̇ − σ₀·|θ̇|/g(θ̇)·z and g = τ_c + (τ_s − τ_c)·exp(−(θ̇/v_s)²); σ₀ is τ_c divided by the
/// bend of the bristles. In the limit of zero bend it is Coulomb or Stribeck friction.
///
/// # Reference
/// Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Transactions on Automatic Control 40 (1995) 419, without
/// its damping terms.
pub(crate) struct LuGre {
    pub(crate) torque: f64,
    pub(crate) static_torque: f64,
    /// v_s: Stribeck velocity in rad/s.
    pub(crate) velocity: f64,
    /// Bend of the bristles when they slip, in rad.
    pub(crate) bend: f64,
}

impl TorqueLaw for LuGre {
    fn torque(&self, moment: &Moment) -> f64 {
        // The state is the bend in units of `bend`.
        let [z, _] = moment.hidden;
        -self.torque * z
    }

    /// With the velocity held, the rate is linear in z.
    fn relax(&self, moment: &Moment, duration: f64) -> Hidden {
        let [z, _] = moment.hidden;
        let speed = moment.velocity.abs();
        let excess = self.static_torque / self.torque - 1.0;
        let slip = 1.0 + excess * (-(speed / self.velocity).powi(2)).exp();
        let end = slip * moment.velocity.signum();
        [end + (z - end) * (-speed * duration / (self.bend * slip)).exp(), 0.0]
    }
}
