//! Several rigs of one build: the content of `rigs.json`.

use super::batch::FailedCase;
use super::diagnosis::VerdictStatus;
use super::interval::{WithInterval, null_is_not_a_number, nulls_are_not_numbers};
use record::Origin;
use serde::{Deserialize, Serialize};

/// The `schema` field of a diagnosis of several rigs.
pub const RIGS_SCHEMA: &str = "ringdown.rigs/1";

/// Classes of effects that several rigs of one build share, with coefficients of their own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigsResult {
    /// Always [`RIGS_SCHEMA`].
    pub schema: String,
    /// The rigs that were diagnosed, in the order given.
    pub rigs: Vec<RigRow>,
    /// Classes of effects by their probability over all rigs, the most probable first.
    pub classes: Vec<SharedClassRow>,
    /// Conclusions from the table, in sentences.
    pub sentences: Vec<String>,
    /// Rigs that gave no answer.
    pub failed: Vec<FailedCase>,
    /// True if every rig was looked at: an interrupted run leaves some.
    pub complete: bool,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// A rig that was diagnosed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigRow {
    /// Its name: that of its folder.
    pub name: String,
    /// Its folder, as it was named.
    pub folder: String,
    /// Where its numbers came from; unstated too where its records differ.
    pub origin: Origin,
    /// Status of its own verdict.
    pub status: VerdictStatus,
    /// Its own verdict in words.
    pub summary: String,
    /// Share of its gap without a name; `None` where there is no gap to be divided.
    pub nameless_share: Option<f64>,
    /// Its own classes, the most probable first.
    pub classes: Vec<RigClassRow>,
}

/// A class of effects on one rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigClassRow {
    /// The id.
    pub id: String,
    /// Its probability by the records of this rig alone.
    pub probability: f64,
}

/// A class of effects on all rigs together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SharedClassRow {
    /// The id.
    pub id: String,
    /// Probability that rigs of this build have it.
    pub probability: f64,
    /// Names of the rigs on which it is likely by their own records.
    pub present_in: Vec<String>,
    /// Coefficients of its effects, rig by rig.
    pub coefficients: Vec<SharedCoefficientRow>,
}

/// A coefficient on every rig that determines it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SharedCoefficientRow {
    /// Id of the effect.
    pub effect: String,
    /// Name of the effect in words.
    pub title: String,
    /// The parameter.
    pub parameter: String,
    /// Symbol of its unit; empty where the rigs' units differ.
    pub unit: String,
    /// Its values.
    pub values: Vec<RigValueRow>,
    /// True if the values agree within their errors; `None` where fewer than two can be compared.
    pub agree: Option<bool>,
    /// Cochran's Q: squared distances from the weighted mean over squared standard errors, summed.
    pub chi_squared: Option<f64>,
    /// Its degrees of freedom: one less than the values that were compared.
    pub degrees: usize,
    /// Weighted mean of the values, where they agree.
    pub mean: Option<WithInterval>,
    /// The two rigs that are farthest apart, and by how many standard errors of the difference.
    pub farthest: Option<FarthestPair>,
}

/// Value of a coefficient on one rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigValueRow {
    /// Name of the rig.
    pub rig: String,
    /// The estimate.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub value: f64,
    /// Its 95 % interval.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
    /// Symbol of its unit.
    pub unit: String,
}

/// Two rigs and the distance of their values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FarthestPair {
    /// Their names.
    pub rigs: [String; 2],
    /// Distance in standard errors of the difference.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub standard_errors: f64,
}
