//! Rows of `series.csv`.

use super::interval::null_is_not_a_number;
use serde::{Deserialize, Serialize};

/// One row of `series.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesRow {
    /// Number of the record, from 1.
    pub record: usize,
    /// Number of the segment, from 1; each segment has its own initial state.
    pub segment: usize,
    /// Time after the record's first sample, in seconds.
    pub time_s: f64,
    /// Observed value.
    pub observed: f64,
    /// Prediction of the nominal simulator.
    pub nominal: f64,
    /// Prediction of the recalibrated simulator when fitted to other parts.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub recalibrated: f64,
    /// Prediction of the repaired simulator when fitted to other parts.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub repaired: f64,
    /// Input torque (force), in the third unit of [`DiagnosisResult::units`](crate::DiagnosisResult::units); `None` if the record has no
    /// input.
    #[serde(default)]
    pub input_torque: Option<f64>,
}
