//! Learning rates over a training.

use serde::{Deserialize, Serialize};

/// A learning rate that rises over the first steps and falls along a half cosine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Schedule {
    /// Largest rate.
    pub peak: f64,
    /// Share of the steps over which it rises from zero.
    pub warm_up: f64,
    /// Rate at the end, as a share of the largest.
    pub last: f64,
}

impl Schedule {
    /// Rate of a step, counted from 0, of `planned` in all.
    #[must_use]
    pub fn rate(&self, step: u64, planned: u64) -> f64 {
        let at = (step as f64 + 1.0) / planned.max(1) as f64;
        if at < self.warm_up {
            return self.peak * at / self.warm_up;
        }
        let along = ((at - self.warm_up) / (1.0 - self.warm_up).max(f64::MIN_POSITIVE)).min(1.0);
        let cosine = 0.5 * (1.0 + (std::f64::consts::PI * along).cos());
        self.peak * (self.last + (1.0 - self.last) * cosine)
    }
}
