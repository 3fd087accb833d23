//! Prior of a number that is drawn.

use dynamics::Range;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

/// Distribution that a number of a simulated system is drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Prior {
    /// Always the same value.
    Fixed(f64),
    /// Uniform between two ends.
    Uniform {
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
    /// Uniform in the logarithm, between two ends above 0.
    LogUniform {
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
    /// Normal, truncated to the number's range.
    Normal {
        /// Mean before the truncation.
        mean: f64,
        /// Standard deviation before the truncation.
        deviation: f64,
    },
}

/// Maximum number of draws of a normal prior until one falls into the range. A configuration must have a mean
/// inside the range and a deviation up to its width. So at worst 0.34 of the draws fall into it, and all of
/// them fail once in 10¹⁸ times.
const MOST_DRAWS: usize = 100;

impl Prior {
    /// Draws a value; it lies in the range if the prior's ends, or its mean, do.
    pub fn draw<R: Rng + ?Sized>(&self, range: &Range, generator: &mut R) -> f64 {
        match *self {
            Self::Fixed(value) => value,
            Self::Uniform { from, to } => from + generator.random::<f64>() * (to - from),
            Self::LogUniform { from, to } => {
                libm::exp(libm::log(from) + generator.random::<f64>() * libm::log(to / from)).clamp(from, to)
            }
            Self::Normal { mean, deviation } => (0..MOST_DRAWS)
                .map(|_| mean + deviation * generator.sample::<f64, _>(StandardNormal))
                .find(|value| range.contains(*value))
                .unwrap_or(mean),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Prior;
    use dynamics::Range;
    use seed::Seed;

    fn draws(prior: Prior, range: &Range) -> Vec<f64> {
        let mut generator = Seed::new(4).generator();
        (0..40_000).map(|_| prior.draw(range, &mut generator)).collect()
    }

    /// Mean and variance against the distribution's own, within four standard errors.
    fn check(found: &[f64], mean: f64, variance: f64) {
        let count = found.len() as f64;
        let average = found.iter().sum::<f64>() / count;
        let spread = found.iter().map(|x| (x - average).powi(2)).sum::<f64>() / count;
        assert!((average - mean).abs() < 4.0 * (variance / count).sqrt(), "{average}, not {mean}");
        // A variance of n draws has a relative standard error of √(2/n) or less for these shapes.
        assert!((spread / variance - 1.0).abs() < 4.0 * (2.0 / count).sqrt(), "{spread}, not {variance}");
    }

    #[test]
    fn draws_follow_their_distribution() {
        check(&draws(Prior::Uniform { from: -1.0, to: 3.0 }, &Range::ANY), 1.0, 16.0 / 12.0);
        let logarithms: Vec<f64> = draws(Prior::LogUniform { from: 1e-5, to: 1e-1 }, &Range::POSITIVE)
            .iter()
            .map(|x| x.ln())
            .collect();
        check(&logarithms, 1e-3_f64.ln(), 1e4_f64.ln().powi(2) / 12.0);
        check(&draws(Prior::Normal { mean: 2.0, deviation: 0.5 }, &Range::ANY), 2.0, 0.25);
        assert!(draws(Prior::Fixed(0.3), &Range::ANY).iter().all(|x| *x == 0.3));
    }

    #[test]
    fn a_normal_is_cut_off_at_the_range() {
        let found = draws(Prior::Normal { mean: 0.0, deviation: 1.0 }, &Range::NON_NEGATIVE);
        assert!(found.iter().all(|x| *x >= 0.0));
        // The half-normal distribution.
        let mean = (2.0 / std::f64::consts::PI).sqrt();
        check(&found, mean, 1.0 - mean * mean);
    }
}
