//! Nuisances, which occur in records of every bank: an encoder's steps, and a logger's errors in timestamps.

use super::draws::Draws;
use super::error::TrialError;
use super::situation::Situation;
use dynamics::{Active, ChainEffect, Effect};
use seed::Seed;
use std::f64::consts::TAU;

/// Steps of an encoder with 12 or 13 bits per turn, in rad.
const ENCODER_STEPS: [f64; 2] = [TAU / 4096.0, TAU / 8192.0];

const ENCODER: Effect = Effect::MeasuringChain(ChainEffect::SensorQuantization);
const JITTER: Effect = Effect::MeasuringChain(ChainEffect::TimestampJitter);

/// Effect that describes samples with shared timestamps.
pub(crate) const BATCHING: Effect = Effect::MeasuringChain(ChainEffect::TimestampBatching);

/// Effects of the measurement chain that occur in every bank with the same probabilities.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Nuisances {
    /// Step of the encoder, in rad; `None` for a sensor without steps. `nominal.toml` states it.
    pub(crate) encoder_step: Option<f64>,
    /// Errors of the logger's timestamps; `None` for exact ones.
    pub(crate) clock: Option<Scatter>,
}

/// Part of [`Nuisances`] that does the same as some hidden effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Nuisance {
    /// [`Nuisances::encoder_step`].
    EncoderStep,
    /// [`Nuisances::clock`].
    Clock,
}

/// Errors of a logger's timestamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Scatter {
    /// Samples arrive in bursts.
    Batching {
        /// Mean time between bursts, in seconds.
        interval: f64,
        /// Standard deviation of the time between bursts, as a share of `interval`.
        scatter: f64,
    },
    /// Every timestamp has an independent error; the root mean square of its effect on the values, in units
    /// of the white noise.
    Jitter(f64),
}

impl Nuisances {
    /// Draws the nuisances. They depend only on the seed of the case, so they reveal neither bank nor effect.
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

    /// Returns the nuisances that remain beside hidden effects: none that does the same as a hidden effect,
    /// and none that scatters timestamps if a hidden effect does so.
    pub(crate) fn beside(mut self, hidden: impl IntoIterator<Item = Nuisance>) -> Self {
        for nuisance in hidden {
            match nuisance {
                Nuisance::EncoderStep => self.encoder_step = None,
                Nuisance::Clock => self.clock = None,
            }
        }
        self
    }

    /// Returns the nuisances as effects of the measurement chain, for motions with a mean square velocity.
    pub(crate) fn active(
        &self,
        situation: &Situation,
        square_velocity: f64,
    ) -> Result<Vec<Active>, TrialError> {
        let mut active = Vec::new();
        if let Some(step) = self.encoder_step {
            active.push(Active::of(ENCODER, &[step])?);
        }
        let period = 1.0 / situation.sampling.rate_hz;
        match self.clock {
            Some(Scatter::Batching { interval, scatter }) => {
                // A burst holds at least two samples.
                let interval = interval.clamp(2.0 * period, 0.1 * situation.duration().max(40.0 * period));
                active.push(Active::of(BATCHING, &[interval, scatter * interval])?);
            }
            Some(Scatter::Jitter(_)) => {
                let deviation = self.jitter_deviation(situation, square_velocity);
                active.push(Active::of(JITTER, &[deviation])?);
            }
            None => {}
        }
        Ok(active)
    }

    /// Returns the standard deviation of the timestamps in seconds: at most 0.3 sample periods, and 0 without
    /// jitter.
    fn jitter_deviation(&self, situation: &Situation, square_velocity: f64) -> f64 {
        let Some(Scatter::Jitter(part)) = self.clock else { return 0.0 };
        let velocity = square_velocity.sqrt().max(f64::MIN_POSITIVE);
        (part * situation.noise / velocity).min(0.3 / situation.sampling.rate_hz)
    }

    /// Returns the standard deviation of all white disturbances of the values: the sensor's noise, its
    /// rounding, and the effect of scattered timestamps.
    pub(crate) fn white(&self, situation: &Situation, square_velocity: f64) -> f64 {
        let rounding = self.encoder_step.map_or(0.0, |step| step * step / 12.0);
        let jitter = self.jitter_deviation(situation, square_velocity).powi(2) * square_velocity;
        (situation.noise.powi(2) + rounding + jitter).sqrt()
    }
}
