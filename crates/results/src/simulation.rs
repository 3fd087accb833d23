//! What a simulation leaves beside its records.

use serde::{Deserialize, Serialize};

/// The `schema` field of a manifest.
pub const RECORDS_SCHEMA: &str = "ringdown.records/1";

/// The content of a simulation's `result.json`. It says nothing of what a single record was generated from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulationResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task that was asked for: `"simulate"`.
    pub task: String,
    /// The configuration's name.
    pub name: String,
    /// Root of every random draw.
    pub seed: u64,
    /// Systems asked for.
    pub systems: u64,
    /// Records written.
    pub records: u64,
    /// True if all that were asked for are there: an interrupted simulation has fewer.
    pub complete: bool,
    /// Samples in all records together.
    pub samples: u64,
    /// Number of systems that have each effect of the configuration.
    pub effects: Vec<EffectCount>,
    /// Folder of the records, from the run's folder.
    pub records_folder: String,
    /// Folder of the sealed truths, from the run's folder.
    pub truth_folder: String,
    /// SHA-256 over the digests of records and truths in order: equal for equal results.
    pub digest: String,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// Number of systems that have an effect.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EffectCount {
    /// The effect's id.
    pub id: String,
    /// Systems that have it.
    pub systems: u64,
}

/// The content of `manifest.json`: which truth belongs to which record, by digests that can be published
/// before the truths.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Always [`RECORDS_SCHEMA`].
    pub schema: String,
    /// One line for each record.
    pub records: Vec<ManifestLine>,
}

/// A record and its truth.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ManifestLine {
    /// The record's file, from the manifest's folder.
    pub record: String,
    /// SHA-256 of that file.
    pub record_digest: String,
    /// The truth's file, from the manifest's folder.
    pub truth: String,
    /// SHA-256 of that file: the truth's seal.
    pub truth_digest: String,
}
