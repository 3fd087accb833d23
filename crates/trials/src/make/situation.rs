//! What every bank draws alike: the system, its start, its input, its sensor's noise, and what is believed of it.

use super::draws::Draws;
use super::error::TrialError;
use super::ranges::Ranges;
use dynamics::chain::{SampledMotion, Samples};
use dynamics::sensitivity::{FullState, Model, Settings};
use dynamics::{Active, Coefficients, Hold, Input, Nominal, Start, System};
use seed::Seed;
use truth::{Excitation, Sampling, Waveform};

/// How the motions of a case come about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motions {
    /// One release from rest.
    Release,
    /// Two or three releases of different amplitude.
    Releases,
    /// A measured input, from rest.
    Driven,
}

/// A system as it is but for what is hidden, and how it is looked at.
#[derive(Debug, Clone)]
pub(crate) struct Situation {
    /// The oscillator.
    pub(crate) nominal: Nominal,
    /// The start of each record.
    pub(crate) starts: Vec<Start>,
    /// Largest distance from the rest angle, in rad.
    pub(crate) amplitude: f64,
    /// The input, for driven records.
    pub(crate) excitation: Option<Excitation>,
    /// When samples are taken.
    pub(crate) sampling: Sampling,
    /// Standard deviation of the sensor's white noise, in rad.
    pub(crate) noise: f64,
}

/// A motion at the samples.
#[derive(Debug, Clone, Default)]
pub(crate) struct Motion {
    pub(crate) times: Vec<f64>,
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

impl Motion {
    /// As the measurement chain takes it.
    pub(crate) fn sampled(&self) -> SampledMotion<'_, f64> {
        SampledMotion {
            times_s: &self.times,
            position: &self.position,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
        }
    }

    /// What an ideal sensor with an ideal clock makes of it.
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
    /// Draws everything anew; what is hidden has no say in it.
    pub(crate) fn draw(
        ranges: &Ranges,
        sampling: Sampling,
        seed: &Seed,
        motions: Motions,
    ) -> Result<Self, TrialError> {
        let mut draws = Draws::new(&seed.child("system"));
        let omega = std::f64::consts::TAU * draws.log_uniform(ranges.frequency_hz[0], ranges.frequency_hz[1]);
        let ratio = draws.log_uniform(ranges.damping_ratio[0], ranges.damping_ratio[1]);
        // Half of the systems per unit of inertia, half in SI units, as small as the paper's pendulum.
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
                // No body waits exactly at its rest angle.
                situation.starts = vec![release(draws.uniform(0.005, 0.02) * amplitude)];
            }
        }
        Ok(situation)
    }

    /// A chirp through the resonance or a square wave, as large as makes the swing the amplitude drawn.
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
        // From rest the response of a linear oscillator is proportional to the input.
        let rest = self.nominal.rest_angle();
        // A little off the rest angle, as below: an integrator that measures its error by the motion so far
        // needs some.
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

    /// Undamped angular frequency in rad/s.
    pub(crate) fn omega(&self) -> f64 {
        self.nominal.angular_frequency()
    }

    /// Torque of the spring at the largest swing.
    pub(crate) fn largest_torque(&self) -> f64 {
        self.nominal.stiffness() * self.amplitude
    }

    /// Velocity with which the largest swing passes the rest angle, in rad/s.
    pub(crate) fn largest_speed(&self) -> f64 {
        self.omega() * self.amplitude
    }

    /// Amplitude of the input; without one 0, as nothing drives the system.
    pub(crate) fn largest_input(&self) -> f64 {
        // No input is one of no size.
        self.excitation.map_or(0.0, |excitation| excitation.amplitude)
    }

    /// The side of the rest angle, 1 or −1, away from where the first record starts.
    pub(crate) fn far_side(&self) -> f64 {
        self.starts.first().map_or(1.0, |start| -(start.position - self.nominal.rest_angle()).signum())
    }

    /// True sampling times in seconds.
    pub(crate) fn times(&self) -> Vec<f64> {
        (0..self.sampling.samples).map(|index| index as f64 / self.sampling.rate_hz).collect()
    }

    /// Length of a record in seconds.
    pub(crate) fn duration(&self) -> f64 {
        self.sampling.samples.saturating_sub(1) as f64 / self.sampling.rate_hz
    }

    /// The input at the samples, held in between.
    pub(crate) fn input(&self) -> Result<Option<Input>, TrialError> {
        let Some(excitation) = self.excitation else { return Ok(None) };
        let (times, duration) = (self.times(), self.duration());
        let values = times.iter().map(|&time| excitation.at(time, duration)).collect();
        Ok(Some(Input::new(times, values, Hold::Zero)?))
    }

    /// The motion of each record with effects of the vocabulary.
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

/// What is believed of the oscillator, whatever is hidden: exact, or with damping and stiffness off by up to
/// a part.
///
/// 30 % off in stiffness is 14 to 20 % in frequency: within a factor of 2 by far.
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
