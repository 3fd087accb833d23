//! The last value held: what a model that has learned nothing says.

use crate::{Ahead, LearnError, Model, Past, Predicted};

/// The last observed position, for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Persistence;

impl Model for Persistence {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        // A past is at least eight samples.
        let last = past.values.last().copied().unwrap_or_default();
        Ok(Predicted { values: vec![last; ahead.times_s.len()], std: None })
    }

    fn parameters(&self) -> usize {
        0
    }
}
