//! Results of a batch of diagnoses.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The `schema` field of a case file.
pub const CASE_SCHEMA: &str = "ringdown.case/1";

/// The content of `case.json` beside a diagnosis of a batch: the inputs of the diagnosis and the labels of
/// the case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseFile {
    /// Always [`CASE_SCHEMA`].
    pub schema: String,
    /// Everything that the diagnosis depends on: digests of the records and the simulator, options, program
    /// version.
    pub asked: Value,
    /// Labels that the case file declares, such as `robot`, `joint` and `date`.
    pub labels: BTreeMap<String, String>,
}

/// Outcome of a batch of diagnoses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BatchResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"diagnose-batch"`.
    pub task: String,
    /// Number of cases found; in a run of one share, the cases of that share.
    pub cases: usize,
    /// Number of cases diagnosed by this run.
    pub diagnosed: usize,
    /// Number of cases skipped because a diagnosis was already there or another process wrote it meanwhile.
    pub skipped: usize,
    /// Cases without a diagnosis.
    pub failed: Vec<FailedCase>,
    /// `true` if every case was processed; an interrupted batch leaves some out.
    pub complete: bool,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// A case without a diagnosis.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailedCase {
    /// Name of the case's folder.
    pub id: String,
    /// Error message of the case's diagnosis.
    pub message: String,
}
