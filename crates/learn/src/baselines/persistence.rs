//! Persistence: the last observed value held forever.

use crate::{Ahead, LearnError, Model, Past, Predicted};

/// Model that predicts the last observed position at all times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Persistence;

impl Model for Persistence {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let Some(&last) = past.values.last() else {
            return Err(LearnError::ShortPast { samples: 0, needed: 1, needed_s: 0.0 });
        };
        Ok(Predicted { values: vec![last; ahead.times_s.len()], std: None })
    }

    fn parameters(&self) -> usize {
        0
    }
}
