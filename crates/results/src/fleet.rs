//! A fleet: the answers of a batch side by side, the content of `fleet.json`.

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
    /// Task that was asked for: `"fleet"`.
    pub task: String,
    /// Names of the labels that some case has: `robot`, `joint` and `date` first.
    pub labels: Vec<String>,
    /// Classes of effects, those that most cases have first.
    pub classes: Vec<FleetClass>,
    /// The cases by each value of each label.
    pub groups: Vec<FleetGroup>,
    /// Numbers that lie far from those of the other cases, the farthest first.
    pub outliers: Vec<FleetOutlier>,
    /// Every case with an answer, by name.
    pub cases: Vec<FleetCase>,
    /// Cases without one, by name.
    pub failed: Vec<FailedCase>,
}

/// A class of effects over all cases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetClass {
    /// Its id.
    pub id: String,
    /// Cases in which it is likelier there than not.
    pub likely: usize,
    /// Of these, cases with a probability of 0.9 or more.
    pub certain: usize,
    /// Median share of the gap over the cases in which it is likely; `null` where none states one.
    pub gap_share: Option<f64>,
}

/// The cases that share a label.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FleetGroup {
    /// Name of the label.
    pub label: String,
    /// Its value.
    pub value: String,
    /// Cases with it.
    pub cases: usize,
    /// Of these, cases in which a class is likely, by class.
    pub likely: BTreeMap<String, usize>,
}

/// A number that lies far from those of the other cases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetOutlier {
    /// The case.
    pub case: String,
    /// Name of the number, such as `coulomb_friction.torque`.
    pub name: String,
    /// Its unit; empty for a ratio.
    pub unit: String,
    /// The number.
    pub value: f64,
    /// Median of the cases it is compared with: those of the same joint, where cases are labeled by joint.
    pub median: f64,
    /// Number of these cases.
    pub of: usize,
    /// 0.6745 times the distance from the median over the median absolute deviation (Iglewicz and Hoaglin 1993).
    pub score: f64,
}

/// A case with an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetCase {
    /// Name of its folder.
    pub id: String,
    /// Labels that it gives itself.
    pub labels: BTreeMap<String, String>,
    /// Where its numbers came from; unstated too where its records differ.
    pub origin: Origin,
    /// Status of its verdict.
    pub status: VerdictStatus,
    /// Probabilities of classes by id.
    pub classes: BTreeMap<String, f64>,
    /// Its verdict in one sentence.
    pub summary: String,
    /// Its numbers by name.
    pub numbers: BTreeMap<String, FleetNumber>,
}

/// A number of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetNumber {
    /// The value, finite.
    pub value: f64,
    /// Its unit; empty for a ratio.
    pub unit: String,
}

impl FleetNumber {
    /// Name of the held-out error after the repair over the noise.
    pub const OVER_NOISE: &str = "error over noise";
    /// Name of the share of the gap that the named effects close.
    pub const CLOSURE: &str = "closure";
    /// Name of the share of the gap without a name.
    pub const NAMELESS: &str = "share without a name";
}
