//! Results of a robot's diagnosis: the content of `joints.json`.

use super::batch::FailedCase;
use super::diagnosis::DiagnosisResult;
use super::interval::WithInterval;
use serde::{Deserialize, Serialize};

/// The `schema` field of a robot's diagnosis.
pub const JOINTS_SCHEMA: &str = "ringdown.joints/1";

/// Diagnosis of a robot, joint by joint, with a check of the whole model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointsResult {
    /// Always [`JOINTS_SCHEMA`].
    pub schema: String,
    /// Path of the model.
    pub model: String,
    /// Diagnosed joints, in the model's order.
    pub joints: Vec<JointRow>,
    /// Joints without a diagnosis, each with the reason.
    pub failed: Vec<FailedCase>,
    /// Whole model against recordings; absent if it could not be run, with the reason in [`Self::notes`].
    pub closed_loop: Option<ClosedLoopRow>,
    /// Quantities that these recordings do not tell, and what would.
    pub identifiable: Vec<IdentifiableRow>,
    /// Recordings, in the order given.
    pub recordings: Vec<RecordingRow>,
    /// Remarks, as sentences.
    pub notes: Vec<String>,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// A diagnosed joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointRow {
    /// Name of the joint.
    pub name: String,
    /// Diagnosis of the joint alone, along the measured motion.
    pub diagnosis: DiagnosisResult,
    /// Spring and damper that held the joint's simulator to the measured motion.
    pub tracking: TrackingRow,
    /// Coefficients that the repair adds to the joint beside the named effects.
    pub repair: JointRepairRow,
    /// Whole model against recordings, at this joint; absent if it could not be run.
    pub closed_loop: Option<JointErrorRow>,
}

/// Spring and damper that hold a joint's simulator to the measured motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrackingRow {
    /// Mean inertia of the joint along the motion, in kg m² or kg.
    pub inertia: f64,
    /// Stiffness of the spring, in N m/rad or N/m.
    pub stiffness: f64,
    /// Damping of the damper, in N m s/rad or N s/m.
    pub damping: f64,
    /// Natural frequency in hertz.
    pub frequency_hz: f64,
}

/// Coefficients of a joint beside those of the effects that are named; `null` if these data do not determine one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointRepairRow {
    /// Inertia beyond that of the model, such as that of a rotor, in kg m² or kg.
    pub armature: Option<WithInterval>,
    /// Viscous damping, in N m s/rad or N s/m.
    pub damping: Option<WithInterval>,
    /// Stiffness of a spring beside the joint, in N m/rad or N/m.
    pub stiffness: Option<WithInterval>,
    /// Constant torque, such as the offset of the torque sensor, in N m or N.
    pub torque_offset: Option<WithInterval>,
    /// Gain of the torque sensor: the torque is so many times what it reads; `null` where the recordings do not tell it
    /// from 1.
    pub torque_gain: Option<WithInterval>,
}

/// Error of the whole model at one joint: root mean squares of the differences of positions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointErrorRow {
    /// Unit of the errors.
    pub unit: String,
    /// Model as given; `null` if its motion left every bound.
    pub nominal: Option<f64>,
    /// Model with fitted coefficients and without further effects.
    pub recalibrated: Option<f64>,
    /// Model with the named effects.
    pub repaired: Option<f64>,
    /// Noise of the sensor.
    pub noise_floor: f64,
}

/// Whole model against recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedLoopRow {
    /// Recordings that were run, with the errors of every joint.
    pub recordings: Vec<ClosedLoopRecording>,
    /// Length of each run in seconds; every run starts from the measured state.
    pub span_s: f64,
    /// `true` if the coefficients were fitted without these recordings.
    pub is_held_out: bool,
    /// Choice of the recordings and of the coefficients, as a sentence.
    pub held_out: String,
}

/// Start of a run of the whole model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunStartRow {
    /// Time in the recording, in seconds.
    pub time_s: f64,
    /// Measured and smoothed positions of all joints, in rad or m.
    pub position: Vec<f64>,
    /// Speeds of all joints, per second.
    pub velocity: Vec<f64>,
}

/// Errors of the whole model on one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedLoopRecording {
    /// Path of the recording.
    pub path: String,
    /// Number of runs.
    pub runs: usize,
    /// Start of each run.
    pub starts: Vec<RunStartRow>,
    /// Errors of each joint, in the model's order.
    pub joints: Vec<JointErrorRow>,
}

/// A quantity that recordings may tell or not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IdentifiableRow {
    /// Name of the quantity, such as `armature`.
    pub quantity: String,
    /// Name of the joint.
    pub joint: String,
    /// `true` if these recordings tell it.
    pub told: bool,
    /// Recording that would tell it; empty if it is told.
    pub record: String,
}

/// A recording of all joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordingRow {
    /// Path of the file.
    pub path: String,
    /// Digest of the file.
    pub digest: String,
    /// Length in seconds.
    pub duration_s: f64,
    /// Number of samples of the first joint.
    pub samples: usize,
    /// `true` if it was fitted; otherwise the whole model was checked with it.
    pub fitted: bool,
    /// `true` if no quantity of a joint differs from that of the other recordings by more than chance.
    pub agrees: bool,
    /// Quantities that differ, such as `elbow: damping`.
    pub differs_in: Vec<String>,
}
