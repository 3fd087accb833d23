//! A batch of diagnoses.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The `schema` field of a case file.
pub const CASE_SCHEMA: &str = "ringdown.case/1";

/// The content of `case.json` beside an answer of a batch: what was asked, and what the case is called by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseFile {
    /// Always [`CASE_SCHEMA`].
    pub schema: String,
    /// All that the answer depends on: digests of records and simulator, options, version of the program.
    pub asked: Value,
    /// Labels that the case gives itself, such as `robot`, `joint` and `date`.
    pub labels: BTreeMap<String, String>,
}

/// Outcome of a batch of diagnoses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BatchResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task that was asked for: `"diagnose-batch"`.
    pub task: String,
    /// Cases found; of a share, those in it.
    pub cases: usize,
    /// Cases diagnosed now.
    pub diagnosed: usize,
    /// Cases whose answer was there already and was left alone, or was given by another process meanwhile.
    pub skipped: usize,
    /// Cases that gave no answer.
    pub failed: Vec<FailedCase>,
    /// True if every case was looked at: an interrupted batch leaves some.
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
