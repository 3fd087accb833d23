//! Results of a simulation beside its records.

use serde::{Deserialize, Serialize};

/// The `schema` field of a manifest.
pub const RECORDS_SCHEMA: &str = "ringdown.records/1";

/// The content of a simulation's `result.json`. It does not reveal what a single record was generated from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulationResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"simulate"`.
    pub task: String,
    /// The configuration's name.
    pub name: String,
    /// Root seed of all random draws.
    pub seed: u64,
    /// Number of systems requested.
    pub systems: u64,
    /// Number of records written.
    pub records: u64,
    /// `true` if all requested records were written; an interrupted simulation has fewer.
    pub complete: bool,
    /// Number of samples in all records together.
    pub samples: u64,
    /// Number of systems with each effect of the configuration.
    pub effects: Vec<EffectCount>,
    /// Folder of the records, relative to the run's folder.
    pub records_folder: String,
    /// Folder of the sealed truths, relative to the run's folder.
    pub truth_folder: String,
    /// SHA-256 over the digests of records and truths in order; equal results have equal digests.
    pub digest: String,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// Number of systems with one effect.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EffectCount {
    /// Id of the effect.
    pub id: String,
    /// Number of systems that have the effect.
    pub systems: u64,
}

/// The content of `manifest.json`: the truth of each record, identified by digests that can be published
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
    /// The record's file, relative to the manifest's folder.
    pub record: String,
    /// SHA-256 of that file.
    pub record_digest: String,
    /// The truth's file, relative to the manifest's folder.
    pub truth: String,
    /// SHA-256 of that file: the truth's seal.
    pub truth_digest: String,
}
