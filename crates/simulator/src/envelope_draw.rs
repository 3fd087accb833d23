//! Envelopes of a decay law, with scatter drawn on them.

use crate::decay_law::DecayLaw;
use crate::error::SimulationError;
use envelope::Envelope;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use std::f64::consts::TAU;

/// Smallest amplitude that is simulated with additive scatter, in its standard deviations. The recommended
/// pipeline ends an envelope there too. Draws that turn it negative do not occur (6e-16 each).
pub const SMALLEST_IN_SCATTER: f64 = 8.0;

/// Independent Gaussian scatter of the peaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scatter {
    /// Added to the amplitude, as a sensor's noise is: the scatter of ln A grows as A falls. Standard
    /// deviation in the amplitude's unit.
    Amplitude(f64),
    /// Added to ln A: the same relative scatter at every amplitude. Standard deviation of ln A.
    Logarithm(f64),
}

/// Oscillation whose peaks are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvelopeSimulation {
    /// Decay law.
    pub law: DecayLaw,
    /// Amplitude of the first peak, above 0.
    pub initial_amplitude: f64,
    /// Period, in seconds; the peaks of both sides are half of it apart.
    pub period_s: f64,
    /// Number of peaks, at least 3.
    pub peaks: usize,
    /// Scatter of the peaks.
    pub scatter: Scatter,
}

/// Noise-free peaks, which a prediction is scored against and no estimator reads.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvelopeTruth {
    times_s: Vec<f64>,
    amplitudes: Vec<f64>,
    omega_rad_s: f64,
    scatter: Scatter,
}

impl EnvelopeSimulation {
    /// Computes the noise-free peaks.
    ///
    /// # Errors
    /// Returns [`SimulationError`] for a parameter out of its range, a motion that comes to rest before the
    /// last peak, or peaks that additive scatter would drown.
    pub fn truth(&self) -> Result<EnvelopeTruth, SimulationError> {
        let (size, scatter_name) = match self.scatter {
            Scatter::Amplitude(size) => (size, "the scatter of the amplitude"),
            Scatter::Logarithm(size) => (size, "the scatter of ln A"),
        };
        positive("the initial amplitude", self.initial_amplitude)?;
        positive("the period", self.period_s)?;
        not_negative(scatter_name, size)?;
        not_negative("the viscous decay rate", self.law.viscous_rate())?;
        not_negative("the dead zone", self.law.dead_zone())?;
        if let DecayLaw::ViscousQuadratic { quadratic_rate, .. } = self.law {
            not_negative("the quadratic rate", quadratic_rate)?;
        }
        let amplitude = |number| self.law.amplitude(self.initial_amplitude, self.period_s, number);
        let amplitudes: Vec<f64> = (0..self.peaks).map(amplitude).collect();
        let dead_zone = self.law.dead_zone();
        // A turning point inside the dead zone is the last one.
        let stopped = amplitudes.iter().position(|&amplitude| amplitude <= dead_zone);
        if let Some(at) = stopped.filter(|at| at + 1 < self.peaks || amplitude(*at) <= 0.0) {
            return Err(SimulationError::ComesToRest {
                reached: at + 1,
                peaks: self.peaks,
                amplitude: amplitude(at),
                dead_zone,
            });
        }
        let smallest = amplitudes.iter().copied().fold(f64::INFINITY, f64::min);
        if matches!(self.scatter, Scatter::Amplitude(_)) && smallest < SMALLEST_IN_SCATTER * size {
            return Err(SimulationError::BelowTheScatter {
                smallest,
                ratio: smallest / size,
                least: SMALLEST_IN_SCATTER,
            });
        }
        Ok(EnvelopeTruth {
            times_s: (0..self.peaks).map(|number| 0.5 * self.period_s * number as f64).collect(),
            amplitudes,
            omega_rad_s: TAU / self.period_s,
            scatter: self.scatter,
        })
    }
}

impl EnvelopeTruth {
    /// Returns the times of the peaks after the first, in seconds.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Returns ln A of the noise-free peaks, with the amplitude in its own unit.
    #[must_use]
    pub fn log_amplitudes(&self) -> Vec<f64> {
        self.amplitudes.iter().map(|amplitude| libm::log(*amplitude)).collect()
    }

    /// Draws the peaks with scatter from `seed`. An estimator gets nothing else.
    ///
    /// # Errors
    /// Returns [`SimulationError::Envelope`] for fewer than three peaks, or logarithms that are not finite.
    pub fn draw(&self, seed: &Seed) -> Result<Envelope, SimulationError> {
        let mut generator = seed.child("scatter").generator();
        let logs = self
            .amplitudes
            .iter()
            .map(|amplitude| {
                let normal: f64 = StandardNormal.sample(&mut generator);
                match self.scatter {
                    Scatter::Amplitude(size) => libm::log(amplitude + size * normal),
                    Scatter::Logarithm(size) => libm::log(*amplitude) + size * normal,
                }
            })
            .collect();
        Ok(Envelope::new(self.times_s.clone(), logs, self.omega_rad_s)?)
    }
}

fn positive(name: &'static str, value: f64) -> Result<(), SimulationError> {
    let fits = value.is_finite() && value > 0.0;
    if fits { Ok(()) } else { Err(SimulationError::Parameter { name, value, expected: "a number above 0" }) }
}

fn not_negative(name: &'static str, value: f64) -> Result<(), SimulationError> {
    let fits = value.is_finite() && value >= 0.0;
    if fits {
        Ok(())
    } else {
        Err(SimulationError::Parameter { name, value, expected: "a number from 0 up" })
    }
}

#[cfg(test)]
mod tests {
    use super::{EnvelopeSimulation, Scatter};
    use crate::{DecayLaw, SimulationError};
    use seed::Seed;

    const DRY: EnvelopeSimulation = EnvelopeSimulation {
        law: DecayLaw::CoulombViscous { decay_rate: 0.1, dead_zone: 0.002 },
        initial_amplitude: 0.5,
        period_s: 0.3,
        peaks: 60,
        scatter: Scatter::Amplitude(0.002),
    };

    #[test]
    fn a_draw_scatters_about_the_truth_as_stated() {
        for (scatter, expected) in [
            // The logarithm of A + s scatters by s/A.
            (Scatter::Amplitude(0.002), (|amplitude: f64| 0.002 / amplitude) as fn(f64) -> f64),
            (Scatter::Logarithm(0.03), |_| 0.03),
        ] {
            let truth = EnvelopeSimulation { scatter, ..DRY }.truth().unwrap();
            let logs = truth.log_amplitudes();
            let draws = 400;
            let mut squares = vec![0.0; logs.len()];
            for draw in 0..draws {
                let envelope = truth.draw(&Seed::new(draw)).unwrap();
                for ((square, log), drawn) in squares.iter_mut().zip(&logs).zip(envelope.log_amplitudes()) {
                    *square += ((drawn - log) / expected(log.exp())).powi(2);
                }
            }
            let mean = squares.iter().sum::<f64>() / (draws as usize * logs.len()) as f64;
            // A mean of 24 000 squares of mean 1 and variance 2; the curvature of the logarithm adds 1 %.
            assert!((mean - 1.0).abs() < 0.05, "{mean}");
        }
    }

    #[test]
    fn draws_depend_on_the_seed_alone() {
        let truth = DRY.truth().unwrap();
        let draw = |seed| truth.draw(&Seed::new(seed)).unwrap();
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        assert_eq!(draw(1).times_s(), truth.times_s());
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_with_numbers() {
        let message = |simulation: EnvelopeSimulation| simulation.truth().unwrap_err().to_string();
        let rest = message(EnvelopeSimulation { peaks: 1000, ..DRY });
        assert!(rest.starts_with("dry friction ends the motion at turning point "), "{rest}");
        let drowned = message(EnvelopeSimulation { scatter: Scatter::Amplitude(0.05), ..DRY });
        assert!(drowned.contains("standard deviations of the scatter"), "{drowned}");
        let negative = message(EnvelopeSimulation { period_s: -1.0, ..DRY });
        assert_eq!(negative, "the period is -1e0; expected a number above 0");
        let few = EnvelopeSimulation { peaks: 2, ..DRY }.truth().unwrap().draw(&Seed::new(0));
        assert!(matches!(few, Err(SimulationError::Envelope(_))));
    }
}
