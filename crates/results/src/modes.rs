//! Modes of a record that swings at several frequencies.

use super::interval::WithInterval;
use serde::{Deserialize, Serialize};

/// A mode of a free decay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ModeRow {
    /// Undamped natural frequency, in Hz.
    pub frequency_hz: WithInterval,
    /// Damping ratio.
    pub damping_ratio: WithInterval,
    /// Share of the modes' power over the record, between 0 and 1.
    pub share: f64,
}
