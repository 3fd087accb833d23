//! Results of a joint diagnosis of several rigs of one build: the content of `rigs.json`.

use super::batch::FailedCase;
use super::diagnosis::VerdictStatus;
use super::interval::{WithInterval, null_is_not_a_number, nulls_are_not_numbers};
use record::Origin;
use serde::{Deserialize, Serialize};

/// The `schema` field of a diagnosis of several rigs.
pub const RIGS_SCHEMA: &str = "ringdown.rigs/1";

/// Classes of effects that several rigs of one build share; each rig has its own coefficients.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigsResult {
    /// Always [`RIGS_SCHEMA`].
    pub schema: String,
    /// Diagnosed rigs, in the order given.
    pub rigs: Vec<RigRow>,
    /// Classes of effects with their probability over all rigs, the most probable first.
    pub classes: Vec<SharedClassRow>,
    /// Conclusions from the table, as sentences.
    pub sentences: Vec<String>,
    /// Rigs without a diagnosis.
    pub failed: Vec<FailedCase>,
    /// `true` if every rig was processed; an interrupted run leaves some out.
    pub complete: bool,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// A diagnosed rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigRow {
    /// Name of the rig: the name of its folder.
    pub name: String,
    /// Path of the rig's folder, as given by the user.
    pub folder: String,
    /// Origin of the rig's numbers; unstated if the origins of its records differ.
    pub origin: Origin,
    /// Status of the rig's own verdict.
    pub status: VerdictStatus,
    /// The rig's own verdict in words.
    pub summary: String,
    /// Share of the rig's gap that no named effect explains; `None` if there is no gap to be divided.
    pub nameless_share: Option<f64>,
    /// Classes by the rig's own records, the most probable first.
    pub classes: Vec<RigClassRow>,
}

/// A class of effects on one rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigClassRow {
    /// Id of the class.
    pub id: String,
    /// Probability of the class by the records of this rig alone.
    pub probability: f64,
}

/// A class of effects on all rigs together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SharedClassRow {
    /// Id of the class.
    pub id: String,
    /// Probability that rigs of this build have an effect of the class.
    pub probability: f64,
    /// Names of the rigs on which the class is likely by their own records.
    pub present_in: Vec<String>,
    /// Coefficients of the class's effects, rig by rig.
    pub coefficients: Vec<SharedCoefficientRow>,
}

/// One coefficient on every rig that determines it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SharedCoefficientRow {
    /// Id of the effect.
    pub effect: String,
    /// Name of the effect in words.
    pub title: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Symbol of the parameter's unit; empty if the rigs' units differ.
    pub unit: String,
    /// Values of the coefficient, one for each rig.
    pub values: Vec<RigValueRow>,
    /// `true` if the values agree within their errors; `None` if fewer than two can be compared.
    pub agree: Option<bool>,
    /// Cochran's Q: sum of the squared distances from the weighted mean, each over its squared standard
    /// error.
    pub chi_squared: Option<f64>,
    /// Degrees of freedom of `chi_squared`: one less than the number of compared values.
    pub degrees: usize,
    /// Weighted mean of the values; `None` if they do not agree.
    pub mean: Option<WithInterval>,
    /// The two rigs whose values are farthest apart, with their distance.
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
    /// 95 % interval of the estimate.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
    /// Symbol of its unit.
    pub unit: String,
}

/// Two rigs and the distance between their values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FarthestPair {
    /// Names of the two rigs.
    pub rigs: [String; 2],
    /// Distance in standard errors of the difference.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub standard_errors: f64,
}
