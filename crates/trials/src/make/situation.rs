//! What every bank draws alike: the system, its start, its input, its sensor, and what is believed of it.

use super::draws::Draws;
use super::error::TrialError;
use super::ranges::Ranges;
use dynamics::chain::{SampledMotion, Samples};
use dynamics::sensitivity::{FullState, Model, Settings};
use dynamics::{Active, Coefficients, Hold, Input, Nominal, Start, System};
use seed::Seed;
use truth::{Excitation, Sampling, Waveform};

/// Steps of an encoder with 12 or 13 bits a turn, in rad.
const ENCODER_STEPS: [f64; 2] = [std::f64::consts::TAU / 4096.0, std::f64::consts::TAU / 8192.0];

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

/// What the measurement chain does in every bank with the same probabilities.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Nuisances {
    /// The encoder's step, where the sensor has one; `nominal.toml` states it.
    pub(crate) encoder_step: Option<f64>,
    /// What the logger does to the stamps.
    pub(crate) clock: Option<Scatter>,
}

/// What a logger does to the stamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Scatter {
    /// Samples arrive in bursts, `interval` apart in seconds.
    Batching {
        /// Mean time between bursts.
        interval: f64,
        /// Its standard deviation as a part of the interval.
        scatter: f64,
    },
    /// Every stamp is off; its effect on the values has this root mean square, in units of the white noise.
    Jitter(f64),
}

impl Nuisances {
    /// Draws them. Nothing that tells the bank or the effect goes in, but for the seed of the case.
    pub(crate) fn draw(seed: &Seed) -> Self {
        let mut draws = Draws::new(&seed.child("nuisances"));
        let step = ENCODER_STEPS.get(draws.below(ENCODER_STEPS.len())).copied();
        let encoder_step = step.filter(|_| draws.chance(0.5));
        let interval = draws.uniform(0.01, 0.08);
        let scatter = draws.uniform(0.0, 0.1);
        let jitter = draws.uniform(0.3, 1.0);
        let clock = match draws.uniform(0.0, 1.0) {
            share if share < 0.25 => Some(Scatter::Batching { interval, scatter }),
            share if share < 0.5 => Some(Scatter::Jitter(jitter)),
            _ => None,
        };
        Self { encoder_step, clock }
    }

    /// Those that remain beside hidden effects: none does what a hidden effect does too, and none scatters
    /// stamps where their scatter is hidden.
    pub(crate) fn beside(mut self, hidden: &[&str]) -> Self {
        if hidden.contains(&"sensor_quantization") {
            self.encoder_step = None;
        }
        if hidden.iter().any(|id| ["timestamp_batching", "timestamp_jitter"].contains(id)) {
            self.clock = None;
        }
        self
    }

    /// As effects of the measurement chain, for motions with a mean square velocity.
    pub(crate) fn active(
        &self,
        situation: &Situation,
        square_velocity: f64,
    ) -> Result<Vec<Active>, TrialError> {
        let mut active = Vec::new();
        if let Some(step) = self.encoder_step {
            active.push(Active::new("sensor_quantization", &[step])?);
        }
        let period = 1.0 / situation.sampling.rate_hz;
        match self.clock {
            Some(Scatter::Batching { interval, scatter }) => {
                // A burst holds at least two samples.
                let interval = interval.clamp(2.0 * period, 0.1 * situation.duration().max(40.0 * period));
                active.push(Active::new("timestamp_batching", &[interval, scatter * interval])?);
            }
            Some(Scatter::Jitter(_)) => {
                let deviation = self.jitter_deviation(situation, square_velocity);
                active.push(Active::new("timestamp_jitter", &[deviation])?);
            }
            None => {}
        }
        Ok(active)
    }

    /// Standard deviation of the stamps in seconds; at most a third of a sample period.
    fn jitter_deviation(&self, situation: &Situation, square_velocity: f64) -> f64 {
        let Some(Scatter::Jitter(part)) = self.clock else { return 0.0 };
        let velocity = square_velocity.sqrt().max(f64::MIN_POSITIVE);
        (part * situation.noise / velocity).min(0.3 / situation.sampling.rate_hz)
    }

    /// Standard deviation of all that is white in the values: the sensor's noise, its rounding, and what
    /// scattered stamps do to them.
    pub(crate) fn white(&self, situation: &Situation, square_velocity: f64) -> f64 {
        let rounding = self.encoder_step.map_or(0.0, |step| step * step / 12.0);
        let jitter = self.jitter_deviation(situation, square_velocity).powi(2) * square_velocity;
        (situation.noise.powi(2) + rounding + jitter).sqrt()
    }
}
