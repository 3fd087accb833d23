//! Results of a diagnosis: the content of `diagnosis.json`.
//!
//! A number that is not finite is written as `null` and read back as NaN.

use super::actuator::ActuatorRow;
use super::calibration::Calibration;
use super::interval::{WithInterval, null_is_not_a_number, nulls_are_not_numbers};
use super::modes::ModeRow;
use record::Origin;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The `schema` field of a diagnosis.
pub const DIAGNOSIS_SCHEMA: &str = "ringdown.diagnosis/1";

/// Distance of two best fits, in noise units, from which on two explanations are distinguishable. Copy of the
/// `diagnosis` crate's constant, because this crate cannot depend on it.
pub const DISTINCT_DISTANCE: f64 = 3.29;

/// A diagnosis of the gap between a nominal simulator and records of one system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DiagnosisResult {
    /// Always [`DIAGNOSIS_SCHEMA`].
    pub schema: String,
    /// Verdict of the diagnosis.
    pub verdict: DiagnosisVerdict,
    /// Every effect id with a probability above 0.01, and `none`, `calibration` and `unknown`; most probable
    /// first.
    pub effects: Vec<EffectRow>,
    /// Classes of effects that act alike, the most probable first. Empty in files of older versions.
    #[serde(default)]
    pub classes: Vec<ClassRow>,
    /// Left-over of the gap beside the named effects. Absent from files of older versions.
    #[serde(default)]
    pub left_over: Option<LeftOverRow>,
    /// Size of the gap before and after recalibration and repair.
    pub gap: GapSummary,
    /// Maps of the gap over time, amplitude, phase plane and frequency.
    #[serde(rename = "where")]
    pub place: GapMaps,
    /// Properties of the measurement chain that stamps and values show without a fit.
    pub measuring_chain: ChainSummary,
    /// The nominal coefficients before and after recalibration and repair.
    pub calibration: Calibration,
    /// Experiment to record next.
    pub next_experiment: NextExperiment,
    /// Wall time of the diagnosis, in seconds.
    pub seconds: f64,
    /// Wall time by stage.
    pub stages: Vec<StageRow>,
    /// Modes of the first record that shows several, the most powerful first; empty if none does.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<ModeRow>,
    /// Inner loop of a joint; absent unless the nominal simulator states one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actuator: Option<ActuatorRow>,
    /// Diagnosed records, in the order given.
    pub records: Vec<RecordRow>,
    /// Path of the nominal simulator's file.
    pub nominal: String,
    /// Digest of the values in that file; comments do not change it. Empty in files of older versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub nominal_digest: String,
    /// Root seed of the random draws.
    pub seed: u64,
    /// Observed quantity: `position`, `velocity` or `acceleration`.
    pub quantity: String,
    /// Share of the samples that were used; below 1 for very long records.
    pub samples_used: f64,
    /// Effects that could replace a named effect, closest first.
    pub rivals: Vec<RivalRow>,
    /// Cost of leaving out each named effect.
    pub detectability: Vec<DetectabilityRow>,
    /// Fitted sets of effects, best first.
    pub sets: Vec<SetRow>,
    /// Sets rejected because the fitted strength of an effect was zero.
    pub rejected: Vec<Vec<String>>,
    /// Equation of the repaired simulator.
    pub equation: Equation,
    /// Units of position, velocity and torque, in this order.
    pub units: [String; 3],
    /// Frequency and decay rate against amplitude.
    pub backbone: Backbone,
    /// Restoring-force surface: acceleration over position and velocity.
    pub surface: Vec<SurfaceCell>,
}

impl DiagnosisResult {
    /// Returns the row of [`Self::effects`] for a status, if there is one.
    #[must_use]
    pub fn row(&self, status: VerdictStatus) -> Option<&EffectRow> {
        self.effects.iter().find(|row| row.id == status.name())
    }

    /// Returns the probability in that row, or 0 if there is no such row.
    #[must_use]
    pub fn probability(&self, status: VerdictStatus) -> f64 {
        self.row(status).map_or(0.0, |row| row.probability)
    }
}

/// Status of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VerdictStatus {
    /// Nothing is missing beyond the noise.
    None,
    /// Only coefficients were off; no effect is missing.
    Calibration,
    /// One or more effects of the vocabulary are missing.
    Effect,
    /// There is a gap that no effect of the vocabulary explains.
    Unknown,
}

impl VerdictStatus {
    /// Returns the name that files use; except for [`Self::Effect`], it is also an id in
    /// [`DiagnosisResult::effects`].
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Calibration => "calibration",
            Self::Effect => "effect",
            Self::Unknown => "unknown",
        }
    }

    /// Returns the status whose row in [`DiagnosisResult::effects`] has this id, or `None` for the id of an
    /// effect.
    #[must_use]
    pub fn of_row(id: &str) -> Option<Self> {
        [Self::None, Self::Calibration, Self::Unknown].into_iter().find(|status| status.name() == id)
    }
}

/// The verdict of a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DiagnosisVerdict {
    /// Status of the diagnosis.
    pub status: VerdictStatus,
    /// Ids of the named effects, best first.
    pub effects: Vec<String>,
    /// Joint probability of this status and these effects.
    pub confidence: f64,
    /// Probability that anything beyond noise is left beside these effects, however small its share of the
    /// gap; absent from files of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_over: Option<f64>,
    /// Classes of effects that these data cannot tell apart.
    pub equivalent: Vec<Vec<String>>,
    /// Verdict as one plain sentence.
    pub summary: String,
}

/// An effect, or `none`, `calibration` or `unknown`, with its probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectRow {
    /// Id of the effect or status.
    pub id: String,
    /// Name in words.
    pub title: String,
    /// Probability. Those of several effects need not add up to 1, because several can act at once.
    pub probability: f64,
    /// Parameters by name.
    pub parameters: BTreeMap<String, ParameterRow>,
    /// Shapley share of the gap that the repaired simulator closes; `None` for effects outside the verdict.
    pub gap_share: Option<WithInterval>,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterRow {
    /// The estimate.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub value: f64,
    /// Symbol of the parameter's unit.
    pub unit: String,
    /// 95 % interval, widened for the residual's autocorrelation; an end that is not finite is `null`.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
    /// `true` if these data determine the parameter; written only if `false`.
    #[serde(default = "yes", skip_serializing_if = "bool::clone")]
    pub determined: bool,
}

fn yes() -> bool {
    true
}

/// Size of the gap before and after recalibration and repair: root mean squares of held-out residuals, in
/// `unit`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GapSummary {
    /// Unit of the root mean squares.
    pub unit: String,
    /// Held-out error of the nominal simulator; only initial states are fitted.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub nominal: f64,
    /// Held-out error of the recalibrated simulator.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub recalibrated: f64,
    /// Held-out error of the repaired simulator, with the named effects.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub repaired: f64,
    /// Held-out error of the repaired simulator with a free latent torque added.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub ceiling: f64,
    /// Noise floor, measured from the residual.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub noise_floor: f64,
    /// 95 % interval of the noise floor.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub noise_floor_interval_95: [f64; 2],
    /// 1 − (R² − s₀²)/(R₀² − s₀²), with R of the repaired and R₀ of the nominal simulator and the noise floor
    /// s₀. A value below −1, where the repair more than doubles the squared gap, is written as −1.
    pub closure: WithInterval,
    /// Closure with the recalibrated simulator's error as R₀.
    pub closure_of_recalibrated: WithInterval,
    /// `repaired` over `noise_floor`; not finite, in JSON `null`, if the noise floor is zero.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub ratio_to_floor: f64,
    /// 95 % interval of that ratio.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub ratio_to_floor_interval_95: [f64; 2],
    /// Errors of the recalibrated and the repaired simulator on the last third, fitted to the first two
    /// thirds.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub last_third: [f64; 2],
    /// Choice of the held-out parts, in words.
    pub held_out: String,
}

impl GapSummary {
    /// Returns `true` if the gap is large enough beside the noise for its closure to be stated: the 95 % interval is
    /// narrower than the whole range.
    #[must_use]
    pub fn is_closure_told(&self) -> bool {
        let [low, high] = self.closure.interval_95;
        high - low < 1.0
    }
}

/// Maps of the gap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GapMaps {
    /// Shares by class of cause. They add up to 1, or are all 0 if recalibration leaves no gap.
    pub budget: BudgetShares,
    /// Map over time, in seconds.
    pub time: Vec<MapCell>,
    /// Map over the amplitude of the swing.
    pub amplitude: Vec<MapCell>,
    /// Map over position and velocity.
    pub phase: Vec<MapCell>,
    /// Map over angular frequency, in rad/s.
    pub frequency: Vec<MapCell>,
}

/// Shares of the gap that remains after recalibration, by class of cause.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BudgetShares {
    /// Causes that take energy out.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub dissipative: f64,
    /// Causes that depend on the position.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub conservative: f64,
    /// Causes that depend on the time.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub time_dependent: f64,
    /// Causes that distort the measured values.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub sensor: f64,
    /// Causes that distort the time stamps.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub clock: f64,
}

/// A cell of a map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapCell {
    /// Lower and upper bound along each axis of the map.
    pub bounds: Vec<[f64; 2]>,
    /// Root mean square of the recalibrated simulator's held-out residual in the cell.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub value: f64,
    /// Root mean square of the repaired simulator's held-out residual in the cell.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub repaired: f64,
    /// Value that noise alone exceeds in any cell of the map with a probability of 5 %.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub band: f64,
    /// `true` if `value` lies above `band`.
    pub significant: bool,
    /// Number of samples in the cell.
    pub samples: usize,
}

/// Properties of the measurement chain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChainSummary {
    /// Believed clock: `host`, `uniform-index` or `index-with-gaps`.
    pub clock: String,
    /// Reason for the choice of that clock, as a sentence.
    pub clock_reason: String,
    /// Sampling rate in hertz.
    pub sample_rate_hz: f64,
    /// Sensor step, if the values lie on a lattice.
    pub resolution: Option<f64>,
    /// Standard deviation of the noise.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub noise: f64,
    /// Findings, one sentence each.
    pub findings: Vec<ChainFinding>,
}

/// A finding that stamps or values show directly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChainFinding {
    /// Id of the effect that the finding shows, if there is one.
    pub effect: Option<String>,
    /// The finding as a sentence with numbers.
    pub text: String,
}

/// Experiment to record next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NextExperiment {
    /// Instruction, or the statement that no explanations are left to be distinguished.
    pub text: String,
    /// Explanations that the experiment would distinguish; empty if there are none.
    pub separates: Vec<String>,
    /// Predicted distance of the two explanations in noise units, given this experiment and the present data.
    pub distance: Option<f64>,
    /// Every experiment considered, with its predicted distance.
    pub considered: Vec<(String, Option<f64>)>,
}

/// Wall time of one stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageRow {
    /// Name of the stage.
    pub name: String,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// A record that was diagnosed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordRow {
    /// Path as given by the user.
    pub path: String,
    /// SHA-256 of the file's bytes, hexadecimal, prefixed `sha256:`.
    pub digest: String,
    /// Origin of the record's numbers.
    pub origin: Origin,
    /// Number of samples in the file.
    pub samples: usize,
    /// Time from the first sample to the last, in seconds.
    pub duration_s: f64,
    /// Believed clock: `host`, `uniform-index` or `index-with-gaps`.
    pub clock: String,
    /// Reason for the choice of that clock, as a sentence.
    pub clock_reason: String,
    /// Remarks from reading the file, as sentences.
    pub findings: Vec<String>,
    /// Decisions made when the file was read; empty in files of older versions.
    #[serde(default)]
    pub reading: record::Reading,
}

/// A named effect and an effect that could replace it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalRow {
    /// Id of the named effect.
    pub effect: String,
    /// Id of the effect that could replace it.
    pub rival: String,
    /// Distance of the two best fits in noise units; below [`DISTINCT_DISTANCE`] they form one class.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub distance: f64,
}

/// Detectability of a named effect on these data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DetectabilityRow {
    /// Id of the effect.
    pub effect: String,
    /// Cost of leaving the effect out, in noise units.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub d: f64,
}

/// Evidence for one class of effects that act alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassRow {
    /// Id of the class.
    pub id: String,
    /// Probability that a system with these records has an effect of the class.
    pub probability: f64,
    /// Shapley share of the gap that the repaired simulator closes; `None` for classes outside the verdict.
    pub gap_share: Option<WithInterval>,
    /// Kinds of effects in the class, the most probable first.
    pub kinds: Vec<KindRow>,
    /// `true` if these data distinguish the kind.
    pub kind_is_told: bool,
    /// Held-out error of the best set without the class, in the observed quantity's unit; NaN for a class
    /// that only stamps, values or the rest angle show.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_without: f64,
    /// Held-out error of the best set with the class; otherwise as `error_without`.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_with: f64,
    /// Share of bootstrap draws of the segments in which the best-supported set has the class.
    pub stability: f64,
    /// Log evidence from which the probability follows.
    pub evidence: ClassEvidenceRow,
}

/// A kind of effect within a class.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KindRow {
    /// Id of the effect.
    pub id: String,
    /// Probability of this kind, given that the class acts.
    pub share: f64,
}

/// Log evidence for a class, in nats.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ClassEvidenceRow {
    /// Log evidence of the best set with the class over the best set without it, from predictions of held-out
    /// parts.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub replacement: f64,
    /// Log evidence from the amplitudes, durations and centers of half swings; `None` if they do not show the
    /// class.
    pub half_swings: Option<f64>,
}

/// Left-over of the gap beside the named effects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LeftOverRow {
    /// Share of the gap, beyond the noise, that no named effect explains: 1 − closure.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub share_of_gap: f64,
    /// Held-out error over the noise floor.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub over_noise: f64,
}

/// A fitted set of effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SetRow {
    /// Ids of the effects; empty for the recalibrated simulator.
    pub effects: Vec<String>,
    /// Probability of the set among all fitted sets.
    pub probability: f64,
    /// Root mean square of the in-sample residual.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub rms: f64,
    /// Tempered log evidence relative to the recalibrated simulator.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub evidence: f64,
}

/// An equation of motion in two notations.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Equation {
    /// Equation as text, followed by a list of its numbers.
    pub text: String,
    /// Equation as LaTeX.
    pub latex: String,
}

/// Frequency and decay rate against amplitude, one point for each half swing.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Backbone {
    /// Points of the record.
    pub measured: Vec<BackbonePoint>,
    /// Points of the nominal simulator.
    pub nominal: Vec<BackbonePoint>,
    /// Points of the repaired simulator.
    pub repaired: Vec<BackbonePoint>,
}

/// One point of a backbone curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BackbonePoint {
    /// Half the distance between successive turning points, in the observed quantity's unit.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub amplitude: f64,
    /// Angular frequency in rad/s.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub frequency: f64,
    /// Rate at which the amplitude falls, in 1/s; `None` if not finite.
    pub decay_rate: Option<f64>,
}

/// A cell of the restoring-force surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SurfaceCell {
    /// Lower and upper bounds of position and velocity.
    pub bounds: [[f64; 2]; 2],
    /// Mean measured acceleration.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub measured: f64,
    /// Part of that acceleration that the recalibrated simulator lacks.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub missing: f64,
    /// Number of samples in the cell.
    pub samples: usize,
}
