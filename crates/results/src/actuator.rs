//! Inner loop of a joint in a diagnosis: its gain, and the ratios to it that the records tell.

use super::interval::WithInterval;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Inner loop of a diagnosed joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ActuatorRow {
    /// Commanded quantity: `position`, `velocity` or `torque`.
    pub kind: String,
    /// Gain of the command that every torque of the answer is relative to.
    pub gain: GainRow,
    /// Torques and coefficients over that gain, by name such as `coulomb_friction.torque` or `inertia`: what records
    /// without a measured torque tell, whatever the gain is.
    pub ratios: BTreeMap<String, RatioRow>,
}

/// Gain of a command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GainRow {
    /// Value that the answer assumes.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// `known`, `about` or `unknown`, as the nominal simulator states it.
    pub stated: String,
    /// Half the width of its 95 % interval; absent unless it is stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

/// Number over the gain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RatioRow {
    /// Value with its 95 % interval.
    #[serde(flatten)]
    pub estimate: WithInterval,
    /// Unit of the value.
    pub unit: String,
}
