//! Random numbers of a case, from its own branch of the seed tree.

use rand::RngExt;
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;

/// Random generator with the few distributions that cases need.
pub(crate) struct Draws(ChaCha12Rng);

impl Draws {
    /// Creates the generator of a node of the seed tree.
    pub(crate) fn new(seed: &Seed) -> Self {
        Self(seed.generator())
    }

    /// Draws uniformly between two numbers.
    pub(crate) fn uniform(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.random::<f64>()
    }

    /// Draws log-uniformly between two positive numbers.
    pub(crate) fn log_uniform(&mut self, from: f64, to: f64) -> f64 {
        self.uniform(from.ln(), to.ln()).exp()
    }

    /// Draws 1 or −1 with equal probability.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// Returns `true` with a probability.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// Draws a whole number from 0 to below `bound`.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        self.0.random_range(0..bound.max(1))
    }

    /// Draws from the standard normal distribution.
    pub(crate) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}
