//! Learning-rate schedule.

use serde::{Deserialize, Serialize};

/// Learning rate that rises linearly over the first steps and falls along a half cosine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Schedule {
    /// Largest learning rate.
    pub peak: f64,
    /// Share of the steps over which the rate rises from zero.
    pub warm_up: f64,
    /// Final learning rate, as a share of the largest.
    pub last: f64,
}

impl Schedule {
    /// Returns the rate of a step, counted from 0, out of `planned` steps.
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
