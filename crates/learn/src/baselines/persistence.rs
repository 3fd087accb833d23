//! Persistence: the last observed value held forever.

use crate::{Ahead, LearnError, Model, Past, Predicted};

/// Model that predicts the last observed position at all times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Persistence;

impl Model for Persistence {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        // A past has samples.
        let last = past.values.last().copied().unwrap_or_default();
        Ok(Predicted { values: vec![last; ahead.times_s.len()], std: None })
    }

    fn parameters(&self) -> usize {
        0
    }
}
