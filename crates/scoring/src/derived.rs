//! Quantities derived from a decay rate, a frequency and a moment of inertia.
//!
//! For I·θ̈ + c·θ̇ + k·θ = 0 with λ = c/(2I), ω² = k/I (small damping), ζ = λ/ω.

use std::f64::consts::{LN_2, PI};

/// Returns the quality factor Q = 1/(2ζ), for ζ > 0.
#[must_use]
pub fn quality_factor(zeta: f64) -> f64 {
    1.0 / (2.0 * zeta)
}

/// Returns the number of cycles in which the amplitude falls to 1/e: 1/(2π·ζ) = Q/π, for ζ > 0. (The *energy*
/// needs half as many cycles; after Q cycles the amplitude has fallen to e^(−π).)
#[must_use]
pub fn cycles_to_one_over_e(zeta: f64) -> f64 {
    1.0 / (2.0 * PI * zeta)
}

/// Returns the half-life of the amplitude in seconds: ln 2/λ, with λ in 1/s.
#[must_use]
pub fn half_life(decay_rate: f64) -> f64 {
    LN_2 / decay_rate
}

/// Returns the time constant of the amplitude in seconds: 1/λ, with λ in 1/s.
#[must_use]
pub fn time_constant(decay_rate: f64) -> f64 {
    1.0 / decay_rate
}

/// Returns the stiffness k = I·ω² in N·m/rad, with I in kg·m² and ω in rad/s.
#[must_use]
pub fn stiffness(inertia: f64, omega: f64) -> f64 {
    inertia * omega * omega
}

/// Returns the damping coefficient c = 2·I·λ in N·m·s/rad, with I in kg·m² and λ in 1/s.
#[must_use]
pub fn damping_coefficient(inertia: f64, decay_rate: f64) -> f64 {
    2.0 * inertia * decay_rate
}

/// Returns the critical damping 2·√(k·I) in N·m·s/rad, with I in kg·m² and k in N·m/rad.
#[must_use]
pub fn critical_damping(inertia: f64, stiffness: f64) -> f64 {
    2.0 * (stiffness * inertia).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }

    /// The amplitude e^(−λt) at the stated times.
    #[test]
    fn the_formulas_do_what_they_say() {
        let (zeta, omega) = (0.00875, 21.8);
        let rate = zeta * omega;
        let amplitude = |time: f64| (-rate * time).exp();
        let period = 2.0 * PI / omega;
        close(amplitude(cycles_to_one_over_e(zeta) * period), (-1.0_f64).exp());
        close(amplitude(quality_factor(zeta) * period), (-PI).exp());
        close(amplitude(half_life(rate)), 0.5);
        close(amplitude(time_constant(rate)), (-1.0_f64).exp());
        let inertia = 5e-4;
        let (k, c) = (stiffness(inertia, omega), damping_coefficient(inertia, rate));
        close((k / inertia).sqrt(), omega);
        close(c / critical_damping(inertia, k), zeta);
    }

    /// The paper's section 5, from its own rounded numbers.
    #[test]
    fn the_papers_derived_parameters() {
        let round = |value: f64, digits: i32| {
            let scale = 10_f64.powi(digits);
            (value * scale).round() / scale
        };
        close(round(stiffness(5e-4, 21.82), 3), 0.238);
        close(round(damping_coefficient(5e-4, 0.00875 * 21.82) * 1e4, 2), 1.91);
        close(round(critical_damping(5e-4, 0.238) * 1e2, 2), 2.18);
        close(round(quality_factor(0.00875), 0), 57.0);
        close(round(half_life(0.191), 1), 3.6);
        close(round(time_constant(0.191), 1), 5.2);
    }
}
