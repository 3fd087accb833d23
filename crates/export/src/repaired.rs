//! What is exported.

use dynamics::chain::Observed;
use dynamics::{Active, Hold, Quantity, Start, System, Units};

/// A nominal simulator with the effects that it lacked, and the sensor and sampling of the first record.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The oscillator with the effects in the system.
    pub system: System,
    /// Units of its numbers: those of the simulator as it was given.
    pub units: Units,
    /// The effects in the measuring chain.
    pub chain: Vec<Active>,
    /// Parts of the diagnosis that cannot be part of the simulator, each in a sentence.
    pub left_out: Vec<String>,
    /// What the input that drives it does between its samples; `None` where nothing drives it.
    pub input: Option<Hold>,
    /// Where the motion of the first record starts.
    pub start: Start,
    /// Quantity that the sensor observes.
    pub observed: Observed,
    /// Standard deviation of the sensor's white noise, in the unit of [`observed`](Self::observed).
    pub noise: f64,
    /// Sampling rate in hertz.
    pub rate_hz: f64,
    /// Length of the first record in seconds.
    pub seconds: f64,
}

impl Repaired {
    /// Whether an input drives it.
    #[must_use]
    pub fn driven(&self) -> bool {
        self.input.is_some()
    }

    /// Returns the unit's symbol of a quantity; that of the observed one follows from [`observed`](Self::observed).
    #[must_use]
    pub fn unit(&self, quantity: Quantity) -> &'static str {
        quantity.unit_seen(self.units, self.observed)
    }
}
