//! What a diagnosis found: the content of `diagnosis.json`.
//!
//! A number that is not finite is `null` there and reads as no number.

use super::calibration::Calibration;
use super::interval::{WithInterval, null_is_not_a_number, nulls_are_not_numbers};
use record::Origin;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The `schema` field of a diagnosis.
pub const DIAGNOSIS_SCHEMA: &str = "ringdown.diagnosis/1";

/// Distance of two best fits in noise units from which on two explanations are told apart; below it they are
/// one class. The diagnosis's own, which this layer does not reach.
pub const DISTINCT_DISTANCE: f64 = 3.29;

/// A diagnosis of the gap between a nominal simulator and records of one system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DiagnosisResult {
    /// Always [`DIAGNOSIS_SCHEMA`].
    pub schema: String,
    /// What it comes to.
    pub verdict: DiagnosisVerdict,
    /// Every id with a probability above 0.01, and `none`, `calibration` and `unknown`; best first.
    pub effects: Vec<EffectRow>,
    /// Classes of effects that explain alike, the most probable first. Empty in files of older versions.
    #[serde(default)]
    pub classes: Vec<ClassRow>,
    /// Remainder that the named effects leave. Absent from files of older versions.
    #[serde(default)]
    pub left_over: Option<LeftOverRow>,
    /// Size of the gap before and after recalibration and repair.
    pub gap: GapSummary,
    /// Where it lies.
    #[serde(rename = "where")]
    pub place: GapMaps,
    /// Properties of stamps and values that show without a fit.
    pub measuring_chain: ChainSummary,
    /// The nominal coefficients before and after.
    pub calibration: Calibration,
    /// Experiment to record next.
    pub next_experiment: NextExperiment,
    /// Wall time of the diagnosis, in seconds.
    pub seconds: f64,
    /// Wall time by stage.
    pub stages: Vec<StageRow>,
    /// The records, in the order given.
    pub records: Vec<RecordRow>,
    /// The file of the nominal simulator.
    pub nominal: String,
    /// Digest of what that file states: its values, not its comments. Empty in files of older versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub nominal_digest: String,
    /// Root of the random draws.
    pub seed: u64,
    /// Observed quantity: `position`, `velocity` or `acceleration`.
    pub quantity: String,
    /// Share of the samples that was used; below 1 for very long records.
    pub samples_used: f64,
    /// Effects that could stand in the place of a named one, closest first.
    pub rivals: Vec<RivalRow>,
    /// Cost of leaving out each named effect.
    pub detectability: Vec<DetectabilityRow>,
    /// The sets of effects that were fitted, best first.
    pub sets: Vec<SetRow>,
    /// Sets rejected because a strength ended at zero.
    pub rejected: Vec<Vec<String>>,
    /// The repaired simulator's equation.
    pub equation: Equation,
    /// Units of position, velocity and torque, in this order.
    pub units: [String; 3],
    /// Frequency and decay rate against amplitude.
    pub backbone: Backbone,
    /// Acceleration over position and velocity.
    pub surface: Vec<SurfaceCell>,
}

impl DiagnosisResult {
    /// The row of [`Self::effects`] that a status has, where there is one.
    #[must_use]
    pub fn row(&self, status: VerdictStatus) -> Option<&EffectRow> {
        self.effects.iter().find(|row| row.id == status.name())
    }

    /// The probability of that row, 0 where there is none.
    #[must_use]
    pub fn probability(&self, status: VerdictStatus) -> f64 {
        self.row(status).map_or(0.0, |row| row.probability)
    }
}

/// Status of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VerdictStatus {
    /// Nothing beyond the noise.
    None,
    /// Coefficients were off; no effect is missing.
    Calibration,
    /// One or more effects of the vocabulary.
    Effect,
    /// A gap that no member of the vocabulary explains.
    Unknown,
}

impl VerdictStatus {
    /// The name as files write it; of all but [`Self::Effect`] also the id of a row of [`DiagnosisResult::effects`].
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Calibration => "calibration",
            Self::Effect => "effect",
            Self::Unknown => "unknown",
        }
    }

    /// The status whose row of [`DiagnosisResult::effects`] has this id; `None` for the id of an effect.
    #[must_use]
    pub fn of_row(id: &str) -> Option<Self> {
        [Self::None, Self::Calibration, Self::Unknown].into_iter().find(|status| status.name() == id)
    }
}

/// The verdict of a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DiagnosisVerdict {
    /// What it comes to.
    pub status: VerdictStatus,
    /// Ids of the effects, best first.
    pub effects: Vec<String>,
    /// Probability of this status and of these effects together.
    pub confidence: f64,
    /// Probability that anything beyond noise is left beside these effects, however little of the gap it is;
    /// absent from answers before it was written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_over: Option<f64>,
    /// Classes of effects that these data cannot tell apart.
    pub equivalent: Vec<Vec<String>>,
    /// One plain sentence.
    pub summary: String,
}

/// An effect, or `none`, `calibration`, `unknown`, with its probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectRow {
    /// The id.
    pub id: String,
    /// The name in words.
    pub title: String,
    /// Its probability; those of effects need not add up to 1, several can act at once.
    pub probability: f64,
    /// Its parameters by name.
    pub parameters: BTreeMap<String, ParameterRow>,
    /// Its share of the gap that the named effects close; of effects of the verdict.
    pub gap_share: Option<WithInterval>,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterRow {
    /// The estimate.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub value: f64,
    /// Symbol of its unit.
    pub unit: String,
    /// 95 % interval, widened for the residual's autocorrelation; an end that is not finite is `null`.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
    /// True if these data determine it: `false`, or absent.
    #[serde(default = "yes", skip_serializing_if = "bool::clone")]
    pub determined: bool,
}

fn yes() -> bool {
    true
}

/// Size of the gap before and after recalibration and repair: root mean squares on parts not fitted, in `unit`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GapSummary {
    /// Unit of the root mean squares.
    pub unit: String,
    /// The given simulator; only start states fitted.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub nominal: f64,
    /// Recalibrated.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub recalibrated: f64,
    /// With the named effects.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub repaired: f64,
    /// With a free latent torque on top.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub ceiling: f64,
    /// The noise floor, measured from the residual.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub noise_floor: f64,
    /// 95 % interval of the noise floor.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub noise_floor_interval_95: [f64; 2],
    /// 1 − (R² − s₀²)/(R₀² − s₀²) with the repaired R and the given simulator's R₀; what is below −1, worse by the gap itself, is
    /// stated as −1.
    pub closure: WithInterval,
    /// The same with the recalibrated simulator in the given one's place.
    pub closure_of_recalibrated: WithInterval,
    /// Repaired over floor; not finite, in JSON `null`, where the floor is zero.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub ratio_to_floor: f64,
    /// 95 % interval of that ratio.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub ratio_to_floor_interval_95: [f64; 2],
    /// Recalibrated and repaired on the last third, fitted to the first two thirds.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub last_third: [f64; 2],
    /// Choice of the parts that were not fitted, in words.
    pub held_out: String,
}

/// Where the gap lies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GapMaps {
    /// By class of cause; adds up to 1, or is 0 throughout where recalibration leaves no gap.
    pub budget: BudgetShares,
    /// Over time in seconds.
    pub time: Vec<MapCell>,
    /// Over the amplitude of the swing.
    pub amplitude: Vec<MapCell>,
    /// Over position and velocity.
    pub phase: Vec<MapCell>,
    /// Over angular frequency in rad/s.
    pub frequency: Vec<MapCell>,
}

/// Shares of the gap beyond recalibration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BudgetShares {
    /// Takes energy out.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub dissipative: f64,
    /// Depends on position.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub conservative: f64,
    /// Depends on time.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub time_dependent: f64,
    /// Distorts the values.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub sensor: f64,
    /// Distorts the times.
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
    /// The same with the named effects.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub repaired: f64,
    /// Value that noise alone exceeds with 5 % probability in any cell of the map at all.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub band: f64,
    /// True if the value lies above the band.
    pub significant: bool,
    /// Samples in the cell.
    pub samples: usize,
}

/// The measuring chain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChainSummary {
    /// The clock believed: `host`, `uniform-index` or `index-with-gaps`.
    pub clock: String,
    /// Why, in a sentence.
    pub clock_reason: String,
    /// Sampling rate in hertz.
    pub sample_rate_hz: f64,
    /// The sensor's step, where the values lie on a lattice.
    pub resolution: Option<f64>,
    /// Standard deviation of the noise.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub noise: f64,
    /// Findings, one sentence each.
    pub findings: Vec<ChainFinding>,
}

/// Something that stamps or values show directly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChainFinding {
    /// Id of the effect it stands for, where there is one.
    pub effect: Option<String>,
    /// A sentence with numbers.
    pub text: String,
}

/// Experiment to record next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NextExperiment {
    /// Instruction, or the statement that nothing is left to be told apart.
    pub text: String,
    /// The explanations it separates; empty where there are none.
    pub separates: Vec<String>,
    /// Predicted distance of the two in noise units, with this experiment beside the present data.
    pub distance: Option<f64>,
    /// Every experiment considered, with its predicted distance.
    pub considered: Vec<(String, Option<f64>)>,
}

/// Time spent in a stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageRow {
    /// Its name.
    pub name: String,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// A record that was diagnosed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordRow {
    /// The path as it was named.
    pub path: String,
    /// SHA-256 of the file's bytes, hexadecimal, prefixed `sha256:`.
    pub digest: String,
    /// Where its numbers came from.
    pub origin: Origin,
    /// Samples in the file.
    pub samples: usize,
    /// From the first sample to the last, in seconds.
    pub duration_s: f64,
    /// The clock believed: `host`, `uniform-index` or `index-with-gaps`.
    pub clock: String,
    /// Why, in a sentence.
    pub clock_reason: String,
    /// Remarks from reading the file: sentences.
    pub findings: Vec<String>,
    /// Decisions made in reading the file; empty in answers of earlier versions.
    #[serde(default)]
    pub reading: record::Reading,
}

/// A pair of explanations on these data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalRow {
    /// An effect of the verdict.
    pub effect: String,
    /// Id of the effect that could stand in its place.
    pub rival: String,
    /// Distance of the two best fits in noise units; below [`DISTINCT_DISTANCE`] they are one class.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub distance: f64,
}

/// Detectability of an effect of the verdict on these data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DetectabilityRow {
    /// The effect.
    pub effect: String,
    /// Cost of leaving it out, in noise units.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub d: f64,
}

/// A class of effects that explain alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassRow {
    /// Its id.
    pub id: String,
    /// Probability that a system with these records has it.
    pub probability: f64,
    /// Share of the gap that the repaired simulator closes, for classes of the verdict.
    pub gap_share: Option<WithInterval>,
    /// Its members, the most probable first.
    pub kinds: Vec<KindRow>,
    /// True if these data tell which of them it is.
    pub kind_is_told: bool,
    /// Error on held-out parts of the best set without the class, and with it, in the observed quantity's unit.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_without: f64,
    /// See `error_without`.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_with: f64,
    /// Part of the draws of segments in which the class is better supported than what takes its place.
    pub stability: f64,
    /// Evidence that the probability follows from.
    pub evidence: ClassEvidenceRow,
}

/// A member of a class.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KindRow {
    /// Its id.
    pub id: String,
    /// Probability that it is this one, given the class.
    pub share: f64,
}

/// Natural logarithms of evidence for a class.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ClassEvidenceRow {
    /// Of the best set with the class over the best one without it, by what they predict of held-out parts.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub replacement: f64,
    /// Of the amplitudes, durations and centers of half swings.
    pub half_swings: Option<f64>,
}

/// Remainder that the named effects leave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LeftOverRow {
    /// Share of the gap, beyond the noise, that has no name.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub share_of_gap: f64,
    /// Held-out error over the noise.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub over_noise: f64,
}

/// A set of effects that was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SetRow {
    /// Its effects; none is the recalibrated simulator.
    pub effects: Vec<String>,
    /// Its probability among the sets.
    pub probability: f64,
    /// Root mean square residual, in sample.
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

/// Frequency and decay rate against amplitude, half-cycle by half-cycle.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Backbone {
    /// From the record.
    pub measured: Vec<BackbonePoint>,
    /// From the given simulator.
    pub nominal: Vec<BackbonePoint>,
    /// From the repaired simulator.
    pub repaired: Vec<BackbonePoint>,
}

/// One cycle of a swing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BackbonePoint {
    /// Half the distance between successive turning points, in the observed unit.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub amplitude: f64,
    /// Angular frequency in rad/s.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub frequency: f64,
    /// Rate at which the amplitude falls, in 1/s.
    pub decay_rate: Option<f64>,
}

/// A cell of the restoring-force surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SurfaceCell {
    /// Lower and upper bound of position and velocity.
    pub bounds: [[f64; 2]; 2],
    /// Mean measured acceleration.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub measured: f64,
    /// Part of it that the recalibrated simulator lacks.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub missing: f64,
    /// Samples in the cell.
    pub samples: usize,
}

/// One row of `series.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesRow {
    /// The record, from 1.
    pub record: usize,
    /// The segment, from 1; each has a start state of its own.
    pub segment: usize,
    /// Time after the record's first sample, in seconds.
    pub time_s: f64,
    /// Observed value.
    pub observed: f64,
    /// Prediction of the given simulator.
    pub nominal: f64,
    /// Prediction of the recalibrated simulator, fitted to other parts.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub recalibrated: f64,
    /// Prediction of the repaired simulator, fitted to other parts.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub repaired: f64,
    /// Torque (force) of the input, in the third of [`DiagnosisResult::units`]; `None` where the record has no input.
    #[serde(default)]
    pub input_torque: Option<f64>,
}
