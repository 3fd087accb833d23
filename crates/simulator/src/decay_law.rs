//! Decay laws: the amplitude of a free oscillation from one turning point to the next.

use std::f64::consts::PI;

/// Law of decay with a closed form at the turning points.
///
/// ```
/// use simulator::DecayLaw;
///
/// let law = DecayLaw::Exponential { decay_rate: 0.2 };
/// // Turning points half a period apart: the seventh lies one second after the first.
/// let seventh = law.amplitude(0.7, 1.0 / 3.0, 6);
/// assert!((seventh - 0.7 * (-0.2_f64).exp()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DecayLaw {
    /// Viscous damping alone: A(t) = A₀·exp(−λt), exact.
    Exponential {
        /// λ, in 1/s, at least 0.
        decay_rate: f64,
    },
    /// Dry (Coulomb) friction and viscous damping. Between two turning points the motion is a damped cosine
    /// about a center shifted by the dead zone x_c, so that with ρ = exp(−λT/2)
    ///
    /// A₍ₙ₊₁₎ = ρ·Aₙ − Δ, Δ = x_c·(1 + ρ), exact at the turning points half a period T/2 apart.
    ///
    /// # Reference
    /// B. F. Feeny, J. W. Liang, J. Sound Vib. 195 (1996) 149–154.
    CoulombViscous {
        /// λ of the viscous part, in 1/s, at least 0.
        decay_rate: f64,
        /// Half-width x_c of the dead zone, in the amplitude's unit: the friction over the stiffness.
        dead_zone: f64,
    },
    /// Viscous and quadratic (drag) damping, ẍ + 2λẋ + βẋ|ẋ| + ω²x = 0, by first-order averaging:
    ///
    /// dA/dt = −λA − qA² with q = 4βω/(3π), A(t) = λA₀ / ((λ + qA₀)·exp(λt) − qA₀).
    ///
    /// The relative error of A is of the order of the damping per radian, (λ + qA₀)/ω, for a decay of any
    /// length.
    ///
    /// # Reference
    /// A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations (Wiley 1979), section 3.3.
    ViscousQuadratic {
        /// λ of the viscous part, in 1/s, at least 0.
        decay_rate: f64,
        /// q, in 1/s per unit of amplitude, at least 0.
        quadratic_rate: f64,
    },
}

impl DecayLaw {
    /// Returns λ of the viscous part, in 1/s: the limit of the decay rate for large amplitude (dry friction)
    /// or small amplitude (quadratic drag).
    #[must_use]
    pub fn viscous_rate(&self) -> f64 {
        match *self {
            Self::Exponential { decay_rate }
            | Self::CoulombViscous { decay_rate, .. }
            | Self::ViscousQuadratic { decay_rate, .. } => decay_rate,
        }
    }

    /// Returns the half-width of the dead zone, in the amplitude's unit; a turning point within it is the
    /// last. 0 without dry friction.
    #[must_use]
    pub fn dead_zone(&self) -> f64 {
        match *self {
            Self::CoulombViscous { dead_zone, .. } => dead_zone,
            Self::Exponential { .. } | Self::ViscousQuadratic { .. } => 0.0,
        }
    }

    /// Returns the amplitude at turning point `number`, counted from 0, half a `period_s` apart, from
    /// `initial` at turning point 0.
    ///
    /// With dry friction the value falls through the dead zone to negative values: amplitudes below
    /// [`DecayLaw::dead_zone`] do not occur.
    #[must_use]
    pub fn amplitude(&self, initial: f64, period_s: f64, number: usize) -> f64 {
        let half_periods = number as f64;
        let time = 0.5 * period_s * half_periods;
        match *self {
            Self::Exponential { decay_rate } => initial * libm::exp(-decay_rate * time),
            Self::CoulombViscous { decay_rate, dead_zone } => {
                let exponent = 0.5 * decay_rate * period_s;
                let ratio = libm::exp(-exponent);
                let decrement = dead_zone * (1.0 + ratio);
                // (1 − ρⁿ)/(1 − ρ), which is n without viscous damping.
                let sum = if exponent > 0.0 {
                    libm::expm1(-exponent * half_periods) / libm::expm1(-exponent)
                } else {
                    half_periods
                };
                initial * libm::exp(-exponent * half_periods) - decrement * sum
            }
            Self::ViscousQuadratic { decay_rate, quadratic_rate } => {
                // (exp(λt) − 1)/λ, which is t without viscous damping.
                let growth =
                    if decay_rate > 0.0 { libm::expm1(decay_rate * time) / decay_rate } else { time };
                initial / (libm::exp(decay_rate * time) + quadratic_rate * initial * growth)
            }
        }
    }

    /// Returns the law in symbols.
    #[must_use]
    pub fn equation(&self) -> &'static str {
        match self {
            Self::Exponential { .. } => "A(t) = A₀ exp(−λt)",
            Self::CoulombViscous { .. } => "Aₙ₊₁ = exp(−λT/2) Aₙ − Δ, Δ = x_c (1 + exp(−λT/2))",
            Self::ViscousQuadratic { .. } => "dA/dt = −λA − qA²",
        }
    }

    /// Returns the exactness of the closed form, in words.
    #[must_use]
    pub fn exactness(&self) -> &'static str {
        match self {
            Self::Exponential { .. } => "exact",
            Self::CoulombViscous { .. } => "exact at the turning points",
            Self::ViscousQuadratic { .. } => "averaged to first order in the damping per radian",
        }
    }

    /// Returns the damping per radian at the start, (λ + qA₀)·T/(2π), which is the order of the averaged
    /// law's relative error; `None` for a law that is exact.
    #[must_use]
    pub fn averaging_error(&self, initial: f64, period_s: f64) -> Option<f64> {
        match *self {
            Self::ViscousQuadratic { decay_rate, quadratic_rate } => {
                Some((decay_rate + quadratic_rate * initial) * period_s / (2.0 * PI))
            }
            Self::Exponential { .. } | Self::CoulombViscous { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::DecayLaw;
    use crate::oscillator::Oscillator;
    use std::f64::consts::PI;

    #[test]
    fn dry_friction_is_exact_at_the_turning_points() {
        let (rate, dead_zone, omega) = (0.2, 0.004, 6.0);
        let oscillator = Oscillator { omega, linear: rate, quadratic: 0.0, dead_zone };
        // Between turning points the damped period.
        let period = 2.0 * PI / f64::sqrt(omega * omega - rate * rate);
        let law = DecayLaw::CoulombViscous { decay_rate: rate, dead_zone };
        for (number, (time, amplitude)) in oscillator.turning_points(0.5, 12).into_iter().enumerate() {
            assert!((time - 0.5 * period * number as f64).abs() < 1e-8, "{number}: {time}");
            let stated = law.amplitude(0.5, period, number);
            assert!((stated - amplitude).abs() < 1e-9, "{number}: {stated} and {amplitude}");
        }
    }

    #[test]
    fn quadratic_damping_is_averaged_to_first_order() {
        let omega = 6.0;
        let largest = |scale: f64| {
            let (rate, beta) = (0.1 * scale, 0.3 * scale);
            let oscillator = Oscillator { omega, linear: rate, quadratic: beta, dead_zone: 0.0 };
            let law = DecayLaw::ViscousQuadratic {
                decay_rate: rate,
                quadratic_rate: 4.0 * beta * omega / (3.0 * PI),
            };
            let period = 2.0 * PI / omega;
            let order = law.averaging_error(1.0, period).unwrap();
            // The same number of e-foldings at either scale.
            let count = (24.0 / scale) as usize;
            let points = oscillator.turning_points(1.0, count).into_iter().enumerate();
            let error = points
                .map(|(number, (_, amplitude))| (law.amplitude(1.0, period, number) / amplitude - 1.0).abs())
                .fold(0.0, f64::max);
            (error, order)
        };
        let (coarse, order) = largest(1.0);
        let (fine, _) = largest(0.5);
        assert!(coarse < order, "{coarse} and {order}");
        assert!(fine < 0.6 * coarse, "{fine} and {coarse}");
    }

    #[test]
    fn closed_forms_meet_where_a_term_is_absent() {
        let (initial, period) = (0.7, 0.3);
        for number in [0, 1, 50] {
            let time = 0.5 * period * number as f64;
            let exponential = DecayLaw::Exponential { decay_rate: 0.4 }.amplitude(initial, period, number);
            assert!((exponential - initial * (-0.4 * time).exp()).abs() < 1e-15);
            for law in [
                DecayLaw::CoulombViscous { decay_rate: 0.4, dead_zone: 0.0 },
                DecayLaw::ViscousQuadratic { decay_rate: 0.4, quadratic_rate: 0.0 },
            ] {
                assert!((law.amplitude(initial, period, number) - exponential).abs() < 1e-15);
            }
            let dry = DecayLaw::CoulombViscous { decay_rate: 0.0, dead_zone: 0.001 };
            let lost = 2.0 * 0.001 * number as f64;
            assert!((dry.amplitude(initial, period, number) - (initial - lost)).abs() < 1e-15);
            let drag = DecayLaw::ViscousQuadratic { decay_rate: 0.0, quadratic_rate: 0.5 };
            let stated = initial / (1.0 + 0.5 * initial * time);
            assert!((drag.amplitude(initial, period, number) - stated).abs() < 1e-15);
        }
    }

    /// The recursion and the differential equation of the documentation.
    #[test]
    fn the_laws_obey_their_equations() {
        let (initial, period) = (0.5, 0.29);
        let law = DecayLaw::CoulombViscous { decay_rate: 0.15, dead_zone: 0.003 };
        let ratio = f64::exp(-0.15 * period / 2.0);
        for number in 0..30 {
            let next = ratio * law.amplitude(initial, period, number) - 0.003 * (1.0 + ratio);
            assert!((next - law.amplitude(initial, period, number + 1)).abs() < 1e-14);
        }
        let law = DecayLaw::ViscousQuadratic { decay_rate: 0.15, quadratic_rate: 0.4 };
        let (time, step) = (3.0, 1e-5);
        let at = |time: f64| law.amplitude(initial, 2.0 * time, 1);
        let slope = (at(time + step) - at(time - step)) / (2.0 * step);
        let stated = -0.15 * at(time) - 0.4 * at(time).powi(2);
        assert!((slope - stated).abs() < 1e-9, "{slope} and {stated}");
    }
}
