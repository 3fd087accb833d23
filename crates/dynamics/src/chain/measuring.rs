//! Measurement chain: sensor, noise and the effects between a motion and a file, in the order of the
//! hardware.

#![allow(clippy::indexing_slicing, reason = "the number of times is checked before they are read")]

use super::sensor_quantization;
use super::step::{Extent, Sampled, SampledMotion, Samples};
use crate::active::Active;
use crate::error::DynamicsError;
use crate::law::Values;
use crate::registry::{ChainEffect, Effect};
use crate::units::{Coordinate, Observed};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

/// Measurement chain between a motion and a file: the sensor, its noise, and the effects that act there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Raw", into = "Raw")]
pub struct Chain {
    observed: Observed,
    noise: f64,
    steps: Vec<(ChainEffect, Active)>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    #[serde(default)]
    observed: Observed,
    #[serde(default)]
    noise: f64,
    #[serde(default)]
    effects: Vec<Active>,
}

impl Chain {
    /// Creates a chain from the observed quantity, the standard deviation of the sensor's white noise in that
    /// quantity's unit, and effects of the measurement chain, which are sorted in the order of the hardware.
    ///
    /// # Errors
    /// Returns [`DynamicsError::BadNoise`] for a noise that is negative or not finite,
    /// [`DynamicsError::Duplicate`] if an effect is given twice, and [`DynamicsError::NotInTheChain`] for an
    /// effect in the system.
    pub fn new(observed: Observed, noise: f64, effects: Vec<Active>) -> Result<Self, DynamicsError> {
        if !noise.is_finite() || noise < 0.0 {
            return Err(DynamicsError::BadNoise { value: noise });
        }
        let mut steps: Vec<(ChainEffect, Active)> = Vec::with_capacity(effects.len());
        for active in effects {
            let Effect::MeasuringChain(effect) = active.effect() else {
                return Err(DynamicsError::NotInTheChain { effect: active.id() });
            };
            if steps.iter().any(|(known, _)| *known == effect) {
                return Err(DynamicsError::Duplicate { effect: active.id() });
            }
            steps.push((effect, active));
        }
        steps.sort_by_key(|(effect, _)| ChainEffect::ALL.iter().position(|known| known == effect));
        Ok(Self { observed, noise, steps })
    }

    /// Returns the quantity that the sensor observes.
    #[must_use]
    pub fn observed(&self) -> Observed {
        self.observed
    }

    /// Returns the standard deviation of the sensor's white noise, in the observed quantity's SI unit, 0 or
    /// above.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Returns the effects, in the order in which they act.
    pub fn effects(&self) -> impl Iterator<Item = &Active> {
        self.steps.iter().map(|(_, active)| active)
    }

    /// Sends a motion through the chain. `generator` returns, for the id of each random step (`sensor_noise`
    /// for the white noise), a generator of its own, so that an additional step does not change the draws of
    /// the others.
    ///
    /// A sensor with a step reports wrong readings (`outliers`) on its lattice too.
    ///
    /// # Errors
    /// Returns [`DynamicsError::UnequalLengths`] for lists of different lengths or fewer than two samples,
    /// [`DynamicsError::BadTimes`] for times that do not increase, and [`DynamicsError::Contradiction`] or
    /// [`DynamicsError::NotForThisSensor`] for an effect that is impossible with this motion and sampling.
    pub fn observe<R: Rng>(
        &self,
        motion: &SampledMotion<'_, f64>,
        coordinate: Coordinate,
        generator: impl Fn(&'static str) -> R,
    ) -> Result<Samples<f64>, DynamicsError> {
        let extent = Extent::of(motion, self.observed, coordinate)?;
        for (effect, active) in &self.steps {
            effect.check(&active.all_values(), &extent)?;
        }
        let mut samples = Samples::new(motion, self.observed);
        let apply = |(effect, active): &(ChainEffect, Active), samples: &mut Samples<f64>| {
            let values = active.all_values();
            if effect.is_differentiable() {
                effect.transform(&values, motion, self.observed, samples);
            } else {
                effect.distort(&values, samples, &mut generator(active.id()));
            }
        };
        let (sensing, recording) =
            self.steps.split_at(self.steps.partition_point(|(effect, _)| precedes_noise(*effect)));
        for step in sensing {
            apply(step, &mut samples);
        }
        if self.noise > 0.0 {
            let mut generator = generator("sensor_noise");
            for value in &mut samples.values {
                *value += self.noise * generator.sample::<f64, _>(StandardNormal);
            }
        }
        let quantization = recording.iter().find(|(effect, _)| *effect == ChainEffect::SensorQuantization);
        let lattice = quantization.and_then(|(_, active)| active.value("step"));
        for step in recording {
            apply(step, &mut samples);
            if let (ChainEffect::Outliers, Some(lattice)) = (step.0, lattice) {
                sensor_quantization::round(lattice, &mut samples.values);
            }
        }
        Ok(samples)
    }
}

/// Returns `true` if a step acts on the signal itself, before the sensor's noise is added.
fn precedes_noise(effect: ChainEffect) -> bool {
    matches!(effect, ChainEffect::SensorLag | ChainEffect::SensorNonlinearity | ChainEffect::SensorDrift)
}

/// Applies the differentiable steps of a chain over any scalar, in the order of the hardware. The result is
/// what a fit compares with a record, with its exact derivatives.
///
/// Steps that are not differentiable are skipped: noise, rounding, wrong or lost samples and scattered stamps
/// belong to the fit's likelihood, not to its prediction.
#[must_use]
pub fn transform<S: Sampled>(
    steps: &[(ChainEffect, Values<S>)],
    motion: &SampledMotion<'_, S>,
    observed: Observed,
) -> Samples<S> {
    let mut samples = Samples::new(motion, observed);
    for effect in ChainEffect::ALL {
        for (_, values) in steps.iter().filter(|(step, _)| step == effect) {
            effect.transform(values, motion, observed, &mut samples);
        }
    }
    samples
}

impl<S: Sampled> Samples<S> {
    /// Returns the samples of an ideal sensor with an ideal clock.
    pub(super) fn new(motion: &SampledMotion<'_, S>, observed: Observed) -> Self {
        Self {
            indices: (0..motion.times_s.len()).collect(),
            times_s: motion.times_s.to_vec(),
            values: motion.observed(observed).to_vec(),
            stamps_s: motion.times_s.iter().map(|&time| S::from(time)).collect(),
        }
    }

    /// Drops the samples that are not kept.
    pub(super) fn retain(&mut self, kept: &[bool]) {
        fn filter<T: Copy>(list: &mut Vec<T>, kept: &[bool]) {
            *list = list.iter().zip(kept).filter(|(_, keep)| **keep).map(|(item, _)| *item).collect();
        }
        filter(&mut self.indices, kept);
        filter(&mut self.times_s, kept);
        filter(&mut self.values, kept);
        filter(&mut self.stamps_s, kept);
    }
}

impl Extent {
    pub(super) fn of(
        motion: &SampledMotion<'_, f64>,
        observed: Observed,
        coordinate: Coordinate,
    ) -> Result<Self, DynamicsError> {
        let times = motion.times_s;
        for (what, list) in [
            ("position", motion.position),
            ("velocity", motion.velocity),
            ("acceleration", motion.acceleration),
        ] {
            if list.len() != times.len() || times.len() < 2 {
                return Err(DynamicsError::UnequalLengths { what, found: list.len(), times: times.len() });
            }
        }
        let pairs = times.iter().zip(times.iter().skip(1));
        if let Some((index, (_, &value))) = pairs.enumerate().find(|(_, (before, after))| before >= after) {
            return Err(DynamicsError::BadTimes { index: index + 1, value });
        }
        let duration_s = times[times.len() - 1] - times[0];
        let values = motion.observed(observed);
        Ok(Self {
            duration_s,
            sample_period_s: duration_s / (times.len() - 1) as f64,
            smallest: values.iter().copied().fold(f64::INFINITY, f64::min),
            largest: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            observed,
            coordinate,
        })
    }
}

impl TryFrom<Raw> for Chain {
    type Error = DynamicsError;

    fn try_from(raw: Raw) -> Result<Self, DynamicsError> {
        Self::new(raw.observed, raw.noise, raw.effects)
    }
}

impl From<Chain> for Raw {
    fn from(chain: Chain) -> Self {
        Self {
            observed: chain.observed,
            noise: chain.noise,
            effects: chain.steps.into_iter().map(|(_, active)| active).collect(),
        }
    }
}
