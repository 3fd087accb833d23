//! Answer of a diagnosis, as plain data.

use dynamics::{Active, Hold, Nominal};
pub use results::VerdictStatus as Status;
use results::{
    ClassEvidenceRow, DetectabilityRow, GapMaps, GapSummary, LeftOverRow, SetRow, StageRow, WithInterval,
};
use serde::Serialize;

/// Verdict of a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Status of the diagnosis.
    pub status: Status,
    /// Ids of the named effects, by their share of the gap; effects that show in time stamps or values
    /// directly come last.
    pub effects: Vec<&'static str>,
    /// Probability that the status and exactly these effects are right.
    pub confidence: f64,
    /// Probability that anything beyond noise is left beside these effects, however small its share of the
    /// gap.
    pub left_over: f64,
    /// Groups of ids that these data cannot distinguish, each led by an effect of the verdict.
    pub equivalent: Vec<Vec<&'static str>>,
}

/// Estimate of a parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Name in the registry.
    pub name: &'static str,
    /// Unit symbol.
    pub unit: String,
    /// Value and interval; the interval is widened for the residual's autocorrelation.
    #[serde(flatten)]
    pub estimate: WithInterval,
    /// `true` if the data determine the parameter.
    pub determined: bool,
}

/// Probability of one effect or status.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectProbability {
    /// Id of the vocabulary, or `none`, `calibration`, `unknown`.
    pub id: &'static str,
    /// Probability, calibrated against how often such effects were there in withheld-effect trials. Several
    /// effects can act at once: the probabilities need not add up to 1.
    pub probability: f64,
    /// Parameters in the best set that has the effect; empty if there are none. Those of `unknown` are of a
    /// torque along the position, if one acts.
    pub parameters: Vec<ParameterEstimate>,
    /// Shapley share of the gap that the repaired simulator closes, for effects of the verdict. A torque
    /// without a name comes after them: its share is what it adds.
    pub gap_share: Option<WithInterval>,
}

/// Effect within a class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Kind {
    /// Id of the effect.
    pub id: &'static str,
    /// Probability of this kind, given that the class is there; those of all kinds of a class add up to 1.
    pub share: f64,
}

/// Class of effects that explain alike, with the probability that the system has any of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectClass {
    /// Id of the class.
    pub id: &'static str,
    /// Probability that the system has the class.
    pub probability: f64,
    /// Probability that at least one of this class and a less probable one acts, if the two can replace each
    /// other; `None` if there is no such class.
    pub either: Option<f64>,
    /// Shapley share of the gap that the repaired simulator closes, for classes of the verdict.
    pub gap_share: Option<WithInterval>,
    /// Fitted kinds of the class, the most probable first.
    pub kinds: Vec<Kind>,
    /// `true` if these data identify the kind.
    pub kind_is_told: bool,
    /// Held-out error of the best set without the class, in the observed quantity's unit; NaN for a class
    /// that only time stamps, values or the rest angle show.
    pub error_without: f64,
    /// Held-out error of the best set with the class; see `error_without`.
    pub error_with: f64,
    /// Share of the draws of segments, with replacement, in which the best set has the class.
    pub stability: f64,
    /// Evidence that the probability follows from.
    pub evidence: ClassEvidenceRow,
}

/// Finding that time stamps or values show directly.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Id of the effect in the vocabulary, if there is one.
    pub effect: Option<&'static str>,
    /// Text of the finding: a sentence with numbers.
    pub text: String,
}

/// Measurement chain of the records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuringChain {
    /// Clock that is believed: `host`, `uniform-index` or `index-with-gaps`.
    pub clock: &'static str,
    /// Sampling rate in hertz.
    pub sample_rate_hz: f64,
    /// Step of the sensor in the observed quantity's unit, if the values lie on a lattice.
    pub resolution: Option<f64>,
    /// Standard deviation of the noise, in the observed quantity's unit.
    pub noise: f64,
    /// Findings on the measurement chain.
    pub findings: Vec<Finding>,
}

/// Nominal coefficient before and after the fits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibrated {
    /// Name of the coefficient.
    pub name: &'static str,
    /// Value in the nominal simulator.
    pub nominal: f64,
    /// Value recalibrated without effects; `None` if these data cannot determine it, so that it is held.
    pub recalibrated: Option<WithInterval>,
    /// Value fitted with the named effects; `None` if it is held.
    pub repaired: Option<WithInterval>,
    /// `true` if the data determine the value with the named effects; `None` if it is held.
    pub determined: Option<bool>,
}

/// Effect that the nominal simulator has, before and after the fits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownRow {
    /// Id of the effect.
    pub id: &'static str,
    /// `true` if recalibration may move its parameters.
    pub recalibrate: bool,
    /// Effect as the nominal simulator has it.
    pub nominal: Option<Active>,
    /// Parameters recalibrated without further effects; empty if they are held.
    pub recalibrated: Vec<ParameterEstimate>,
    /// Parameters fitted with the named effects; empty if they are held.
    pub repaired: Vec<ParameterEstimate>,
}

/// Number that the data do not determine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Undetermined {
    /// Name, such as `rest_angle` or `gravity.angle`.
    pub name: String,
    /// `true` if the nominal simulator's number stands in its place; otherwise it is the fitted one.
    pub is_nominal: bool,
}

/// Repaired simulator: the recalibrated nominal one with the effects that it lacked.
///
/// A number that the data do not determine is the nominal one, and the others are fitted beside it. Every
/// fitted number is written to the digits that matter: rounding moves it by less than a hundredth of its
/// standard error given all others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepairedSimulator {
    /// Oscillator with the repaired coefficients.
    pub nominal: Nominal,
    /// Effects of the nominal simulator, then those that it lacked.
    pub effects: Vec<Active>,
    /// Fitted state at the first sample of the first record; `None` if the fit does not hold that sample.
    pub start: Option<StartState>,
    /// Numbers that the data do not determine.
    pub undetermined: Vec<Undetermined>,
    /// Behavior of a measured input between its samples, as believed in the fits; `None` without an input.
    pub input_hold: Option<Hold>,
    /// Effects that cannot be part of it, each with the reason.
    pub left_out: Vec<(&'static str, String)>,
}

/// State of a system, its hidden bodies included, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartState {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Fitted hidden states by the id of their effect, in its order; effects without an entry are relaxed.
    pub hidden: Vec<(&'static str, Vec<f64>)>,
}

/// Pair of explanations on these data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rivalry {
    /// Effect of the verdict.
    pub effect: &'static str,
    /// Effect that could take its place.
    pub rival: &'static str,
    /// Distance of the two best fits in units of the noise: the root of twice their log likelihood ratio.
    /// Below 3.29 the data cannot distinguish them.
    pub distance: f64,
}

/// Experiment that would distinguish the closest rivals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Experiment {
    /// Description of the experiment.
    pub text: String,
    /// Ids of the two explanations.
    pub separates: Vec<&'static str>,
    /// Predicted distance in units of the noise, with this experiment beside the present data.
    pub distance: f64,
    /// Every experiment considered, with its predicted distance.
    pub considered: Vec<(String, f64)>,
}

/// Series for plots, on the samples used.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Series {
    /// Time in seconds.
    pub time_s: Vec<f64>,
    /// Observed values.
    pub observed: Vec<f64>,
    /// Residuals (observed minus predicted) of the nominal simulator; only start states were fitted.
    pub nominal_residual: Vec<f64>,
    /// Held-out residuals of the recalibrated simulator.
    pub recalibrated_residual: Vec<f64>,
    /// Held-out residuals of the repaired simulator.
    pub repaired_residual: Vec<f64>,
    /// Position of the repaired simulator, fitted to all segments.
    pub position: Vec<f64>,
    /// Velocity of the repaired simulator; see `position`.
    pub velocity: Vec<f64>,
    /// Torque of the input; 0 without an input.
    pub input_torque: Vec<f64>,
    /// Index of the first sample of each segment.
    pub segment_starts: Vec<usize>,
    /// Index of the record of each segment, from 0.
    pub segment_records: Vec<usize>,
}

/// Diagnosis of the gap between a nominal simulator and records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Verdict: status, effects and confidence.
    pub verdict: Verdict,
    /// Probabilities of `none`, `calibration` and `unknown`, of every named effect, and of every other effect
    /// with a probability of at least 0.01; largest first.
    pub effects: Vec<EffectProbability>,
    /// Classes of effects, the most probable first.
    pub classes: Vec<EffectClass>,
    /// Left-over beside the named effects.
    pub left_over: LeftOverRow,
    /// Size of the gap before and after the repair.
    pub gap: GapSummary,
    /// Place of the gap.
    #[serde(rename = "where")]
    pub place: GapMaps,
    /// Measurement chain of the records.
    pub measuring_chain: MeasuringChain,
    /// Nominal coefficients before and after the fits.
    pub calibration: Vec<Calibrated>,
    /// Known effects: those of the nominal simulator.
    pub known: Vec<KnownRow>,
    /// Repaired simulator.
    pub repaired: RepairedSimulator,
    /// Rivals on these data, closest first.
    pub rivals: Vec<Rivalry>,
    /// Detectability of the verdict's effects.
    pub detectability: Vec<DetectabilityRow>,
    /// Experiment that would distinguish the closest rivals, if there are any.
    pub next_experiment: Option<Experiment>,
    /// Fitted sets, best first.
    pub sets: Vec<SetRow>,
    /// Sets rejected because a strength ended at zero, so that the data do not support it with the right
    /// sign, or because a shape reduced an effect to another one.
    pub rejected: Vec<Vec<&'static str>>,
    /// Series for plots.
    pub series: Series,
    /// Share of the samples that was used; below 1 for very long records.
    pub samples_used: f64,
    /// Time by stage.
    pub stages: Vec<StageRow>,
}
