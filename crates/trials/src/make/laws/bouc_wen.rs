//! Bouc–Wen hysteresis, with a knee of any sharpness.

use crate::make::integrator::{Hidden, Moment, TorqueLaw};

/// −τ_h·z with ż = θ̇/δ·(1 − |z|ⁿ·(½ + ½·sign(θ̇·z))): unloading is elastic, loading saturates at |z| = 1;
/// the larger n, the sharper the knee.
///
/// # Reference
/// Wen, Journal of the Engineering Mechanics Division 102 (1976) 249.
pub(crate) struct BoucWen {
    pub(crate) torque: f64,
    pub(crate) displacement: f64,
    pub(crate) sharpness: f64,
}

impl TorqueLaw for BoucWen {
    fn torque(&self, moment: &Moment) -> f64 {
        let [z, _] = moment.hidden;
        -self.torque * z
    }

    /// With the factor |z|ⁿ⁻¹ held, the rate is linear in z.
    fn relax(&self, moment: &Moment, duration: f64) -> Hidden {
        let [z, _] = moment.hidden;
        let way = moment.velocity * duration / self.displacement;
        if way * z <= 0.0 {
            return [z + way, 0.0];
        }
        let factor = z.abs().powf(self.sharpness - 1.0).max(1e-6);
        let direction = way.signum();
        let end = direction / factor;
        // The held factor may overshoot; the state is clipped at the saturation of loading.
        let next = end + (z - end) * (-factor * way.abs()).exp();
        [next.clamp(-1.0_f64.max(z.abs()), 1.0_f64.max(z.abs())), 0.0]
    }
}
