//! What is exported.

use dynamics::chain::Observed;
use dynamics::{Active, Quantity, Start, System, Units};

/// A nominal simulator with the effects it lacked, and what observes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The oscillator with the effects in the system.
    pub system: System,
    /// Units of its numbers: those of the simulator as it was given.
    pub units: Units,
    /// The effects in the measuring chain.
    pub chain: Vec<Active>,
    /// What cannot be part of it, each in a sentence.
    pub left_out: Vec<String>,
    /// Whether an input drives it.
    pub driven: bool,
    /// Where the motion of the first record starts.
    pub start: Start,
    /// What the sensor observes.
    pub observed: Observed,
    /// Standard deviation of the sensor's noise.
    pub noise: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Length of the first record in seconds.
    pub seconds: f64,
}

impl Repaired {
    /// The unit of a quantity; of what the sensor observes, by what that is.
    #[must_use]
    pub fn unit(&self, quantity: Quantity) -> &'static str {
        quantity.unit_seen(self.units, self.observed)
    }
}
