//! The simulator to be exported.

use dynamics::chain::Observed;
use dynamics::{Active, Hold, Quantity, Start, System, Units};

/// A nominal simulator with the effects that it lacked, and the sensor and sampling of the first record.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// Oscillator with the effects in the system.
    pub system: System,
    /// Units of the numbers: those of the nominal simulator as it was given.
    pub units: Units,
    /// Effects in the measurement chain.
    pub chain: Vec<Active>,
    /// Parts of the diagnosis that cannot be part of the simulator, one sentence each.
    pub left_out: Vec<String>,
    /// Course of the input between its samples; `None` without an input.
    pub input: Option<Hold>,
    /// Initial state of the first record.
    pub start: Start,
    /// Hidden states at that start, in the order of the effect's hidden states, by the effect's id. Effects that
    /// are not listed start relaxed and move along.
    pub hidden_starts: Vec<(&'static str, Vec<f64>)>,
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
    /// Returns `true` if an input drives the system.
    #[must_use]
    pub fn driven(&self) -> bool {
        self.input.is_some()
    }

    /// Returns the hidden states of an effect at the start, if they are known.
    pub(crate) fn hidden_start(&self, id: &str) -> Option<&[f64]> {
        self.hidden_starts.iter().find(|(own, _)| *own == id).map(|(_, states)| states.as_slice())
    }

    /// Returns the symbol of a quantity's unit; for the observed quantity it follows from
    /// [`observed`](Self::observed).
    #[must_use]
    pub fn unit(&self, quantity: Quantity) -> &'static str {
        quantity.unit_seen(self.units, self.observed)
    }
}
