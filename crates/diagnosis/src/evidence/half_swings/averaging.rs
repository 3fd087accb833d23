//! Laws averaged over half a swing.

use dynamics::{Coefficients, Law, Moment, Values};
use std::f64::consts::PI;

/// Restoring torque per inertia, ω²·(y + γ₃·y³ + γ₅·y⁵), as determined by the durations of the swings; y is
/// the position minus the half width b of a backlash on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Restoring {
    pub(crate) angular_frequency: f64,
    pub(crate) cubic: f64,
    pub(crate) quintic: f64,
    /// Half the width of the backlash.
    pub(crate) play: f64,
}

/// Number of quadrature nodes over half a swing.
const NODES: usize = 24;

impl Restoring {
    /// Returns the torque of a linear spring alone.
    pub(crate) fn harmonic(angular_frequency: f64) -> Self {
        Self { angular_frequency, cubic: 0.0, quintic: 0.0, play: 0.0 }
    }

    /// Returns the restoring torque whose period at amplitude A is T₀·(1 + b₁·A² + b₂·A⁴ + b₃/A).
    ///
    /// # Reference
    /// Nayfeh, Mook, Nonlinear Oscillations, Wiley 1979, section 2.3:
    /// T/T₀ = 1 − 3/8·γ₃·A² + (57/256·γ₃² − 5/16·γ₅)·A⁴. The backlash is crossed at the velocity ω·(A − b),
    /// twice in a period: T/T₀ = 1 + 2/π·b/(A − b).
    pub(crate) fn of_period(angular_frequency: f64, [first, second, inverse]: [f64; 3]) -> Self {
        let cubic = -8.0 / 3.0 * first;
        let quintic = 16.0 / 5.0 * (57.0 / 256.0 * cubic * cubic - second);
        Self { angular_frequency, cubic, quintic, play: 0.5 * PI * inverse.max(0.0) }
    }

    /// Returns the distance of a position beyond the backlash.
    fn beyond(&self, x: f64) -> f64 {
        (x.abs() - self.play).max(0.0)
    }

    /// Returns the torque per inertia over ω² at a positive position.
    fn torque(&self, x: f64) -> f64 {
        let y = self.beyond(x);
        y * (1.0 + y * y * (self.cubic + y * y * self.quintic))
    }

    /// Returns the velocity at a position in a swing of amplitude A, from its energy.
    fn velocity(&self, amplitude: f64, x: f64) -> f64 {
        let (a, s) = (self.beyond(amplitude).powi(2), self.beyond(x).powi(2));
        let bend = 0.5 * self.cubic * (a + s) + self.quintic * (a * a + a * s + s * s) / 3.0;
        self.angular_frequency * ((a - s) * (1.0 + bend).max(0.05)).max(0.0).sqrt()
    }

    /// Returns the amplitude that an effect takes from half a swing. `values` are the effect's values per
    /// unit of inertia.
    pub(crate) fn loss<L: Law>(&self, values: &Values<f64>, amplitude: f64) -> f64 {
        self.averaged(amplitude, |moment| L::torque(values, moment))
    }

    /// Returns the amplitude that viscous damping takes from half a swing. `coefficient` is per unit of
    /// inertia.
    pub(crate) fn viscous(&self, coefficient: f64, amplitude: f64) -> f64 {
        self.averaged(amplitude, |moment| -coefficient * moment.velocity)
    }

    /// Returns the work −∫ torque dx from −A to A divided by the restoring torque at A (Krylov–Bogoliubov
    /// averaging of the energy).
    fn averaged(&self, amplitude: f64, torque: impl Fn(&Moment<f64>) -> f64) -> f64 {
        let step = PI / NODES as f64;
        let nominal = Coefficients {
            inertia: 1.0,
            damping: 1.0,
            stiffness: self.angular_frequency.powi(2),
            rest_angle: 0.0,
            input_gain: 0.0,
        };
        let work: f64 = (0..NODES)
            .map(|node| {
                let (sine, cosine) = libm::sincos(step * (node as f64 + 0.5) - 0.5 * PI);
                let moment = Moment {
                    time: 0.0,
                    position: amplitude * sine,
                    velocity: self.velocity(amplitude, amplitude * sine),
                    input: 0.0,
                    input_rate: 0.0,
                    hidden: [0.0; dynamics::MOST_HIDDEN],
                    nominal,
                    direction: 1.0,
                    region: 0,
                };
                -torque(&moment) * amplitude * cosine * step
            })
            .sum();
        let force = self.torque(amplitude).max(0.05 * amplitude);
        work / (self.angular_frequency.powi(2) * force)
    }
}
