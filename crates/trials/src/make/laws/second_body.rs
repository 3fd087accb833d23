//! Second body on a spring.

use crate::make::integrator::{Hidden, Moment, TorqueLaw};

/// I₂·(ω²·(ψ − x) + 2·ζ·ω·(ψ̇ − ẋ)), where ψ̈ is minus this torque over I₂. The second body starts at rest
/// relative to the first.
///
/// # Reference
/// Den Hartog, Mechanical Vibrations, 4th ed., McGraw-Hill 1956, section 3.1.
pub(crate) struct SecondBody {
    /// I₂.
    pub(crate) inertia: f64,
    /// ω in rad/s.
    pub(crate) frequency: f64,
    /// ζ, below 1.
    pub(crate) damping_ratio: f64,
}

impl TorqueLaw for SecondBody {
    fn torque(&self, moment: &Moment) -> f64 {
        let [position, velocity] = moment.hidden;
        let spring = self.frequency * self.frequency * (position - moment.deflection);
        let damper = 2.0 * self.damping_ratio * self.frequency * (velocity - moment.velocity);
        self.inertia * (spring + damper)
    }

    /// The exact damped oscillation about the point at which spring and damper balance, for the held
    /// velocity.
    fn relax(&self, moment: &Moment, duration: f64) -> Hidden {
        let [position, velocity] = moment.hidden;
        let center = moment.deflection + 2.0 * self.damping_ratio * moment.velocity / self.frequency;
        let decay = self.damping_ratio * self.frequency;
        let omega = self.frequency * (1.0 - self.damping_ratio * self.damping_ratio).sqrt();
        let (sine, cosine) = (omega * duration).sin_cos();
        let (from, size) = (position - center, (-decay * duration).exp());
        let second = (velocity + decay * from) / omega;
        let swing = from * cosine + second * sine;
        [center + size * swing, size * (omega * (second * cosine - from * sine) - decay * swing)]
    }

    fn start(&self, deflection: f64, velocity: f64) -> Hidden {
        [deflection, velocity]
    }
}
