//! A batch of diagnoses.

use serde::{Deserialize, Serialize};

/// What a batch came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BatchResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// What was asked for: `"diagnose-batch"`.
    pub task: String,
    /// Cases found.
    pub cases: usize,
    /// Cases diagnosed now.
    pub diagnosed: usize,
    /// Cases whose answer was there already and was left alone.
    pub skipped: usize,
    /// Cases that gave no answer.
    pub failed: Vec<FailedCase>,
    /// Whether every case was looked at: an interrupted batch leaves some.
    pub complete: bool,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// A case that gave no answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailedCase {
    /// Name of its folder.
    pub id: String,
    /// Why: the message of its own diagnosis.
    pub message: String,
}
