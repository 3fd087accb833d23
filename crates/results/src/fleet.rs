//! Results of a fleet: the diagnoses of a batch side by side, the content of `fleet.json`.

use super::batch::FailedCase;
use super::diagnosis::VerdictStatus;
use record::Origin;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The `schema` field of a fleet.
pub const FLEET_SCHEMA: &str = "ringdown.fleet/1";

/// Summary of the diagnoses of many systems.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetResult {
    /// Always [`FLEET_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"fleet"`.
    pub task: String,
    /// Names of all labels used by any case; `robot`, `joint` and `date` come first.
    pub labels: Vec<String>,
    /// Classes of effects, most frequent first.
    pub classes: Vec<FleetClass>,
    /// Cases grouped by each value of each label.
    pub groups: Vec<FleetGroup>,
    /// Numbers far from those of the other cases, the farthest first.
    pub outliers: Vec<FleetOutlier>,
    /// Cases with a diagnosis, by name.
    pub cases: Vec<FleetCase>,
    /// Cases without a diagnosis, by name.
    pub failed: Vec<FailedCase>,
}

/// Counts of one class of effects over all cases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetClass {
    /// Id of the class.
    pub id: String,
    /// Number of cases in which the class has a probability of at least 0.5.
    pub likely: usize,
    /// Number of cases in which the class has a probability of at least 0.9.
    pub certain: usize,
    /// Median share of the gap over the cases in which the class is likely; `null` if none of them states a
    /// share.
    pub gap_share: Option<f64>,
}

/// Cases with the same value of a label.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FleetGroup {
    /// Name of the label.
    pub label: String,
    /// Value of the label.
    pub value: String,
    /// Number of cases with this value.
    pub cases: usize,
    /// Number of these cases in which a class is likely, by class.
    pub likely: BTreeMap<String, usize>,
}

/// A number far from those of the other cases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetOutlier {
    /// Name of the case.
    pub case: String,
    /// Name of the number, such as `coulomb_friction.torque`.
    pub name: String,
    /// Unit of the number; empty for a ratio.
    pub unit: String,
    /// The number.
    pub value: f64,
    /// Median of the reference cases: those of the same joint if cases are labeled by joint, else all.
    pub median: f64,
    /// Number of reference cases.
    pub of: usize,
    /// 0.6745 times the distance from the median over the median absolute deviation (Iglewicz and Hoaglin
    /// 1993).
    pub score: f64,
}

/// A case with a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetCase {
    /// Name of the case's folder.
    pub id: String,
    /// Labels that the case file declares.
    pub labels: BTreeMap<String, String>,
    /// Origin of the case's numbers; unstated if the origins of its records differ.
    pub origin: Origin,
    /// Status of the verdict.
    pub status: VerdictStatus,
    /// Probabilities of the classes by id.
    pub classes: BTreeMap<String, f64>,
    /// Verdict in one sentence.
    pub summary: String,
    /// Numbers of the case by name.
    pub numbers: BTreeMap<String, FleetNumber>,
}

/// A number of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetNumber {
    /// Finite value of the number.
    pub value: f64,
    /// Unit of the number; empty for a ratio.
    pub unit: String,
}

impl FleetNumber {
    /// Name of the ratio of the held-out error after the repair to the noise.
    pub const OVER_NOISE: &str = "error over noise";
    /// Name of the closure: the share of the gap that the named effects close.
    pub const CLOSURE: &str = "closure";
    /// Name of the share of the gap that no named effect explains.
    pub const NAMELESS: &str = "share without a name";
}
