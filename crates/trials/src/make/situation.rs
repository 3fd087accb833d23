//! Situations, drawn in the same way in every bank: the system, its start, its input and its sensor's noise;
//! also the nominal simulator.

use super::draws::Draws;
use super::error::TrialError;
use super::ranges::Ranges;
use dynamics::chain::{SampledMotion, Samples};
use dynamics::sensitivity::{FullState, Model, Settings};
use dynamics::{Active, Coefficients, Hold, Input, Nominal, Start, System};
use seed::Seed;
use truth::{Excitation, Sampling, Waveform};

/// Type of the motions of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motions {
    /// One release from rest.
    Release,
    /// Two or three releases of different amplitude.
    Releases,
    /// A measured input, from rest.
    Driven,
}

/// True system, apart from what is hidden, and its measurement.
#[derive(Debug, Clone)]
pub(crate) struct Situation {
    /// The oscillator.
    pub(crate) nominal: Nominal,
    /// Initial state of each record.
    pub(crate) starts: Vec<Start>,
    /// Largest distance from the rest angle, in rad.
    pub(crate) amplitude: f64,
    /// Input of driven records; `None` for free motions.
    pub(crate) excitation: Option<Excitation>,
    /// Sample rate, number of samples, and decimals of the files.
    pub(crate) sampling: Sampling,
    /// Standard deviation of the sensor's white noise, in rad.
    pub(crate) noise: f64,
}

/// Motion at the times of the samples.
#[derive(Debug, Clone, Default)]
pub(crate) struct Motion {
    pub(crate) times: Vec<f64>,
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

impl Motion {
    /// Returns the motion in the form that the measurement chain takes.
    pub(crate) fn sampled(&self) -> SampledMotion<'_, f64> {
        SampledMotion {
            times_s: &self.times,
            position: &self.position,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
        }
    }

    /// Returns the samples of an ideal sensor with an ideal clock.
    pub(crate) fn seen(self) -> Samples<f64> {
        Samples {
            indices: (0..self.times.len()).collect(),
            times_s: self.times.clone(),
            values: self.position,
            stamps_s: self.times,
        }
    }
}

impl Situation {
    /// Draws a situation, independently of what is hidden.
    pub(crate) fn draw(
        ranges: &Ranges,
        sampling: Sampling,
        seed: &Seed,
        motions: Motions,
    ) -> Result<Self, TrialError> {
        let mut draws = Draws::new(&seed.child("system"));
        let omega = std::f64::consts::TAU * draws.log_uniform(ranges.frequency_hz[0], ranges.frequency_hz[1]);
        let ratio = draws.log_uniform(ranges.damping_ratio[0], ranges.damping_ratio[1]);
        // Half of the systems are per unit of inertia, half in SI units and as small as the paper's pendulum.
        let inertia = if draws.chance(0.5) { 1.0 } else { draws.log_uniform(2e-4, 1e-3) };
        let rest = draws.uniform(-0.05, 0.05);
        let nominal = Nominal::new(inertia, 2.0 * ratio * omega * inertia, omega * omega * inertia, rest)?;
        let noise = Draws::new(&seed.child("sensor")).log_uniform(ranges.noise[0], ranges.noise[1]);

        let mut draws = Draws::new(&seed.child("motion"));
        let amplitude = draws.uniform(ranges.release_deg[0], ranges.release_deg[1]).to_radians();
        let side = draws.sign();
        let release = |amplitude: f64| Start::release(rest + side * amplitude);
        let mut situation =
            Self { nominal, starts: vec![release(amplitude)], amplitude, excitation: None, sampling, noise };
        match motions {
            Motions::Release => {}
            Motions::Releases => {
                situation.starts.push(release(amplitude * draws.uniform(0.2, 0.5)));
                if draws.chance(0.5) {
                    situation.starts.push(release(amplitude * draws.uniform(0.08, 0.15)));
                }
            }
            Motions::Driven => {
                situation.starts = vec![Start::release(rest)];
                situation.excitation = Some(situation.drawn_excitation(&mut draws)?);
                // No real body waits exactly at its rest angle.
                situation.starts = vec![release(draws.uniform(0.005, 0.02) * amplitude)];
            }
        }
        Ok(situation)
    }

    /// Draws a chirp through the resonance or a square wave, scaled so that the swing has the drawn
    /// amplitude.
    fn drawn_excitation(&self, draws: &mut Draws) -> Result<Excitation, TrialError> {
        let frequency = self.omega() / std::f64::consts::TAU;
        let unscaled = if draws.chance(0.5) {
            let (start, end) = (draws.uniform(0.2, 0.5), draws.uniform(1.6, 2.5));
            Excitation {
                waveform: Waveform::Chirp,
                amplitude: self.nominal.stiffness() * self.amplitude,
                frequency_hz: start * frequency,
                end_frequency_hz: end * frequency,
            }
        } else {
            let frequency_hz = draws.uniform(0.08, 0.3) * frequency;
            Excitation {
                waveform: Waveform::Square,
                amplitude: self.nominal.stiffness() * self.amplitude,
                frequency_hz,
                end_frequency_hz: frequency_hz,
            }
        };
        // From rest, the response of a linear oscillator is proportional to the input.
        let rest = self.nominal.rest_angle();
        // The start is slightly off the rest angle, as below: an integrator that scales its error tolerance
        // by the motion so far needs some motion.
        let starts = vec![Start::release(rest + 1e-3 * self.amplitude)];
        let trial = Self { excitation: Some(unscaled), starts, ..self.clone() };
        let largest = trial
            .motions(&[])?
            .iter()
            .flat_map(|motion| &motion.position)
            .map(|position| (position - rest).abs())
            .fold(f64::MIN_POSITIVE, f64::max);
        Ok(Excitation { amplitude: unscaled.amplitude * self.amplitude / largest, ..unscaled })
    }

    /// Returns the undamped angular frequency in rad/s.
    pub(crate) fn omega(&self) -> f64 {
        self.nominal.angular_frequency()
    }

    /// Returns the torque of the spring at the largest swing.
    pub(crate) fn largest_torque(&self) -> f64 {
        self.nominal.stiffness() * self.amplitude
    }

    /// Returns the velocity at which the largest swing passes the rest angle, in rad/s.
    pub(crate) fn largest_speed(&self) -> f64 {
        self.omega() * self.amplitude
    }

    /// Returns the amplitude of the input; 0 without an input.
    pub(crate) fn largest_input(&self) -> f64 {
        self.excitation.map_or(0.0, |excitation| excitation.amplitude)
    }

    /// Returns the side of the rest angle, 1 or −1, opposite to the start of the first record.
    pub(crate) fn far_side(&self) -> f64 {
        self.starts.first().map_or(1.0, |start| -(start.position - self.nominal.rest_angle()).signum())
    }

    /// Returns the true sampling times in seconds.
    pub(crate) fn times(&self) -> Vec<f64> {
        (0..self.sampling.samples).map(|index| index as f64 / self.sampling.rate_hz).collect()
    }

    /// Returns the length of a record in seconds.
    pub(crate) fn duration(&self) -> f64 {
        self.sampling.samples.saturating_sub(1) as f64 / self.sampling.rate_hz
    }

    /// Returns the input at the samples, held in between; `None` for free motions.
    pub(crate) fn input(&self) -> Result<Option<Input>, TrialError> {
        let Some(excitation) = self.excitation else { return Ok(None) };
        let (times, duration) = (self.times(), self.duration());
        let values = times.iter().map(|&time| excitation.at(time, duration)).collect();
        Ok(Some(Input::new(times, values, Hold::Zero)?))
    }

    /// Simulates the motion of each record with effects of the vocabulary.
    pub(crate) fn motions(&self, effects: &[Active]) -> Result<Vec<Motion>, TrialError> {
        let system = System::new(self.nominal, effects.to_vec())?;
        let settings = Settings { velocity: true, acceleration: true, ..Settings::default() };
        let mut model = Model::new(&system, &[], settings)?;
        let (times, input) = (self.times(), self.input()?);
        self.starts
            .iter()
            .map(|&start| {
                let response = model.run(FullState::from(start), input.as_ref(), &times)?;
                Ok(Motion {
                    times: times.clone(),
                    position: response.position,
                    velocity: response.velocity,
                    acceleration: response.acceleration,
                })
            })
            .collect()
    }
}

/// Returns the nominal oscillator: exact, or with damping and stiffness wrong by up to the relative error
/// `off`. It does not depend on what is hidden.
///
/// An error of 30 % in stiffness is 14 to 20 % in frequency, far within a factor of 2.
pub(crate) fn believed(nominal: &Nominal, off: Option<f64>, seed: &Seed) -> Result<Nominal, TrialError> {
    let Some(off) = off else { return Ok(*nominal) };
    let mut draws = Draws::new(&seed.child("belief"));
    let is = nominal.coefficients();
    Ok(nominal.with_coefficients(Coefficients {
        damping: is.damping * (1.0 + draws.uniform(-off, off)),
        stiffness: is.stiffness * (1.0 + draws.uniform(-off, off)),
        ..is
    })?)
}
