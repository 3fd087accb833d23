//! Accuracy of the reference integration.

use serde::{Deserialize, Serialize};

/// Tolerance of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// Error of a step relative to the largest position, velocity and hidden state so far; 1e-14 to 1e-2.
    pub relative: f64,
    /// Maximum number of steps before [`DynamicsError::TooManySteps`](crate::DynamicsError::TooManySteps).
    pub most_steps: usize,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { relative: 1e-12, most_steps: 1_000_000 }
    }
}
