//! The answer of a diagnosis, as plain data.

use crate::noise::floor::NoiseFloor;
use dynamics::{Active, Hold, Nominal};
pub use results::VerdictStatus as Status;
use serde::Serialize;

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower and upper end of the 95 % interval.
    pub interval_95: [f64; 2],
}

/// The verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// What it comes to.
    pub status: Status,
    /// Ids of the effects, by their share of the gap; effects that show in stamps or in the noise come last.
    pub effects: Vec<&'static str>,
    /// Probability of this status and of these effects together.
    pub confidence: f64,
    /// Probability that anything beyond noise is left beside them, however little of the gap it is.
    pub left_over: f64,
    /// Classes of effects that these data cannot tell apart.
    pub equivalent: Vec<Vec<&'static str>>,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Its name in the registry.
    pub name: &'static str,
    /// Unit symbol.
    pub unit: String,
    /// Value and interval; the interval is widened for the residual's autocorrelation.
    #[serde(flatten)]
    pub estimate: Interval,
    /// Whether the interval says anything.
    pub determined: bool,
}

/// A member of the list of probabilities.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectProbability {
    /// An id of the vocabulary, or `none`, `calibration`, `unknown`.
    pub id: &'static str,
    /// Its probability, as often as such effects were there in withheld-effect trials. Several can act at
    /// once: they need not add up to 1.
    pub probability: f64,
    /// Parameters in the best set that has it; empty for what has none. Those of `unknown` are of a torque along the position,
    /// where one acts.
    pub parameters: Vec<ParameterEstimate>,
    /// Its Shapley share of the gap that the repaired simulator closes, for effects of the verdict. A torque without a name
    /// comes after them: its share is what it adds.
    pub gap_share: Option<Interval>,
}

/// An effect within a class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Kind {
    /// Its id.
    pub id: &'static str,
    /// Probability that it is this one, given that the class is there; all of a class add up to 1.
    pub share: f64,
}

/// What speaks for a class of effects, as natural logarithms of ratios.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct ClassEvidence {
    /// Log evidence of the best set of effects with the class over the best one without it, by what they predict of parts
    /// that they were not fitted to.
    pub replacement: f64,
    /// The same from the amplitudes, durations and centers of half swings; `None` where these do not show the class.
    pub half_swings: Option<f64>,
}

/// Effects that explain alike, and whether a system with these records has any of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectClass {
    /// Its id.
    pub id: &'static str,
    /// Probability that the system has it.
    pub probability: f64,
    /// Where another class would take its place nearly as well, and less well than it takes the other's: the probability that
    /// one of the two acts.
    pub either: Option<f64>,
    /// Shapley share of the gap that the repaired simulator closes, for classes of the verdict.
    pub gap_share: Option<Interval>,
    /// Its members that were fitted, the most probable first.
    pub kinds: Vec<Kind>,
    /// Whether these data tell which of them it is.
    pub kind_is_told: bool,
    /// Error on held-out parts of the best set without the class, and with it, in the observed quantity's unit.
    pub error_without: f64,
    /// See `error_without`.
    pub error_with: f64,
    /// Part of the draws of segments, with replacement, in which the class is better supported than what takes its place.
    pub stability: f64,
    /// What the probability follows from.
    pub evidence: ClassEvidence,
}

/// What the named effects leave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeftOver {
    /// Share of the gap, beyond the noise, that has no name: 1 less the closure.
    pub share_of_gap: f64,
    /// Held-out error over the noise.
    pub over_noise: f64,
}

/// How far the gap shrinks. Root mean squares on parts not fitted, in the observed quantity's unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gap {
    /// Unit of all of it.
    pub unit: &'static str,
    /// The given simulator; only start states fitted.
    pub nominal: f64,
    /// Recalibrated.
    pub recalibrated: f64,
    /// With the named effects, and with the torque along the position that acts beside them without a name.
    pub repaired: f64,
    /// With a free latent torque on top, where that predicts better than none.
    pub ceiling: f64,
    /// The noise floor.
    pub noise_floor: NoiseFloor,
    /// 1 − (R² − s₀²)/(R₀² − s₀²) with the repaired R and the given simulator's R₀; what is below −1, worse by the gap itself, is
    /// stated as −1.
    pub closure: Interval,
    /// The same with the recalibrated simulator in R₀'s place: what the effects did.
    pub closure_of_recalibrated: Interval,
    /// Repaired over floor.
    pub ratio_to_floor: Interval,
    /// Recalibrated and repaired on the last third of the segments, fitted to the first two thirds.
    pub last_third: [f64; 2],
    /// How the parts not fitted were chosen.
    pub held_out: String,
}

/// Shares of the gap beyond recalibration by class; they add up to 1, or are all 0 where there is no such gap.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Budget {
    /// Takes energy out.
    pub dissipative: f64,
    /// Depends on position.
    pub conservative: f64,
    /// Depends on time.
    pub time_dependent: f64,
    /// Distorts the values.
    pub sensor: f64,
    /// Distorts the times.
    pub clock: f64,
}

/// A cell of a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Lower and upper bound along each axis of the map.
    pub bounds: Vec<[f64; 2]>,
    /// Root mean square of the recalibrated simulator's held-out residual in the cell.
    pub value: f64,
    /// The same with the named effects.
    pub repaired: f64,
    /// What noise alone exceeds with 5 % probability in any cell of the map at all.
    pub band: f64,
    /// Whether the value lies above the band.
    pub significant: bool,
    /// Samples in the cell.
    pub samples: usize,
}

/// Where the gap lies.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Where {
    /// By class of cause.
    pub budget: Budget,
    /// Over time in seconds; one axis.
    pub time: Vec<Cell>,
    /// Over the amplitude of the swing in rad or m; one axis.
    pub amplitude: Vec<Cell>,
    /// Over position and velocity; two axes.
    pub phase: Vec<Cell>,
    /// Over angular frequency in rad/s; one axis. Values are root mean squares within the band of frequencies.
    pub frequency: Vec<Cell>,
}

/// Something that stamps or values show directly.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Id of the vocabulary it stands for, where there is one.
    pub effect: Option<&'static str>,
    /// A sentence with numbers.
    pub text: String,
}

/// The measuring chain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuringChain {
    /// The clock believed: `host`, `uniform-index` or `index-with-gaps`.
    pub clock: &'static str,
    /// Sampling rate in hertz.
    pub sample_rate_hz: f64,
    /// The sensor's step, where the values lie on a lattice.
    pub resolution: Option<f64>,
    /// Standard deviation of the noise.
    pub noise: f64,
    /// What was found.
    pub findings: Vec<Finding>,
}

/// A nominal coefficient before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibrated {
    /// Its name.
    pub name: &'static str,
    /// As the nominal simulator has it.
    pub nominal: f64,
    /// Recalibrated without effects; `None` where these data cannot tell it.
    pub recalibrated: Option<Interval>,
    /// With the named effects.
    pub repaired: Option<Interval>,
    /// Whether the interval with the named effects says anything; `None` where it was held.
    pub determined: Option<bool>,
}

/// An effect that the nominal simulator has, before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownRow {
    /// Its id.
    pub id: &'static str,
    /// Whether recalibration may move its parameters.
    pub recalibrate: bool,
    /// As the nominal simulator has it.
    pub nominal: Option<Active>,
    /// Recalibrated without further effects; empty where it is held.
    pub recalibrated: Vec<ParameterEstimate>,
    /// With the named effects; empty where it is held.
    pub repaired: Vec<ParameterEstimate>,
}

/// A number that the data do not determine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Undetermined {
    /// Its name, as `rest_angle` or `gravity.angle`.
    pub name: String,
    /// Whether the nominal simulator's number stands in its place; otherwise it is as it was fitted.
    pub is_nominal: bool,
}

/// The repaired simulator: the recalibrated nominal one with the effects that it lacked.
///
/// A number that the data do not determine is the nominal one, the others fitted beside it. Every fitted number is
/// written to the digits that matter: rounding moves it by less than a hundredth of its standard error with all others
/// given.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepairedSimulator {
    /// The oscillator.
    pub nominal: Nominal,
    /// The effects that the nominal simulator has, then those that it lacked.
    pub effects: Vec<Active>,
    /// Numbers that the data do not determine.
    pub undetermined: Vec<Undetermined>,
    /// What a measured input does between its samples, where there is one: the belief with which it was fitted.
    pub input_hold: Option<Hold>,
    /// Effects that cannot be part of it, each with the reason.
    pub left_out: Vec<(&'static str, String)>,
}

/// A pair of explanations on these data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rivalry {
    /// An effect of the verdict.
    pub effect: &'static str,
    /// What could stand in its place.
    pub rival: &'static str,
    /// Distance of the two best fits in noise units; below 3.29 they are one class.
    pub distance: f64,
}

/// How detectable an effect of the verdict is on these data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detectability {
    /// The effect.
    pub effect: &'static str,
    /// What leaving it out costs, in noise units.
    pub d: f64,
}

/// The experiment that would tell the closest rivals apart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Experiment {
    /// What to do.
    pub text: String,
    /// The two explanations.
    pub separates: Vec<&'static str>,
    /// Predicted distance in noise units with this experiment beside the present data.
    pub distance: f64,
    /// Every experiment considered, with its predicted distance.
    pub considered: Vec<(String, f64)>,
}

/// A set of effects that was fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetScore {
    /// Its effects.
    pub effects: Vec<&'static str>,
    /// Its probability among the sets.
    pub probability: f64,
    /// Root mean square residual, in sample.
    pub rms: f64,
    /// Tempered log evidence relative to the calibrated simulator.
    pub evidence: f64,
}

/// Series for plots, on the samples used.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Series {
    /// Time in seconds.
    pub time_s: Vec<f64>,
    /// What was observed.
    pub observed: Vec<f64>,
    /// Residuals (observed minus predicted) of the given simulator; only start states were fitted.
    pub nominal_residual: Vec<f64>,
    /// Held-out residuals of the recalibrated simulator.
    pub recalibrated_residual: Vec<f64>,
    /// Held-out residuals with the named effects.
    pub repaired_residual: Vec<f64>,
    /// Position and velocity of the repaired simulator, fitted to all segments.
    pub position: Vec<f64>,
    /// See `position`.
    pub velocity: Vec<f64>,
    /// Torque of the input; 0 without one.
    pub input_torque: Vec<f64>,
    /// First sample of each segment.
    pub segment_starts: Vec<usize>,
    /// The record, from 0, that each segment is of.
    pub segment_records: Vec<usize>,
}

/// Time spent in a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stage {
    /// Its name.
    pub name: &'static str,
    /// Seconds by the stopwatch that was passed in.
    pub seconds: f64,
}

/// The answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// What it comes to.
    pub verdict: Verdict,
    /// `none`, `calibration`, `unknown`, every effect that is named, and every other whose sets have a
    /// probability above 0.01 together; best first.
    pub effects: Vec<EffectProbability>,
    /// Classes of effects, the most probable first.
    pub classes: Vec<EffectClass>,
    /// What the named effects leave.
    pub left_over: LeftOver,
    /// How far the gap shrinks.
    pub gap: Gap,
    /// Where it lies.
    #[serde(rename = "where")]
    pub place: Where,
    /// The measuring chain.
    pub measuring_chain: MeasuringChain,
    /// Nominal coefficients.
    pub calibration: Vec<Calibrated>,
    /// The effects that the nominal simulator has.
    pub known: Vec<KnownRow>,
    /// The repaired simulator.
    pub repaired: RepairedSimulator,
    /// Rivals on these data, closest first.
    pub rivals: Vec<Rivalry>,
    /// Detectability of the verdict's effects.
    pub detectability: Vec<Detectability>,
    /// What would tell the closest rivals apart, where there are any.
    pub next_experiment: Option<Experiment>,
    /// The sets fitted, best first.
    pub sets: Vec<SetScore>,
    /// Sets rejected because a strength ended at zero: with the right sign the data have no use for it.
    pub rejected: Vec<Vec<&'static str>>,
    /// Series for plots.
    pub series: Series,
    /// Share of the samples that was used; below 1 for very long records.
    pub samples_used: f64,
    /// Time by stage.
    pub stages: Vec<Stage>,
}
