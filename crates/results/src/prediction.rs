//! Results of a study of held-out prediction: many methods scored on held-out peaks of several problems.

use super::estimation::DataSummary;
use super::failure::Failure;
use super::interval::null_is_not_a_number;
use super::method::Family;
use record::Origin;
use serde::{Deserialize, Serialize};

/// Result of a study of held-out prediction: the content of `result.json` with `task = "predict"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"predict"`.
    pub task: String,
    /// Seed of the first draw and of its fits.
    pub seed: u64,
    /// Definition of the held-out splits.
    pub splits: SplitSummary,
    /// One entry for each problem, in the order configured.
    pub problems: Vec<ProblemRow>,
    /// Wall time of all fits together, in seconds.
    pub seconds: f64,
}

/// Definition of the held-out splits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SplitSummary {
    /// Interpolation: number of successive peaks in a block.
    pub block_peaks: usize,
    /// Interpolation: number of successive blocks of which one is held out.
    pub every: usize,
    /// Extrapolation: share of the peaks held out at the end.
    pub last_share: f64,
    /// Significance level for the adjusted p-values.
    pub significance: f64,
}

/// Result on one problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProblemRow {
    /// Name in the configuration.
    pub id: String,
    /// Title in words.
    pub title: String,
    /// Origin of the problem's numbers.
    pub origin: Origin,
    /// Outcome, or the reason for a missing one.
    pub outcome: ProblemOutcome,
}

/// Outcome of one problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProblemOutcome {
    /// The problem was studied with every method.
    Studied(Box<ProblemStudy>),
    /// The record is missing.
    Absent {
        /// Name of the missing record and instructions to get it.
        reason: String,
    },
}

/// Results on one problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProblemStudy {
    /// Unit of the amplitude.
    pub unit: String,
    /// Number of peaks of the envelope.
    pub peaks: usize,
    /// Time from the first peak to the last, in seconds.
    pub duration_s: f64,
    /// Summary of the record; `None` if there is no record.
    pub data: Option<DataSummary>,
    /// Law of the problem, if it is simulated.
    pub law: Option<LawSummary>,
    /// Scores of the best exponential: closed-form least squares on the peaks that were not held out.
    pub exponential: ExponentialScores,
    /// One row for each method, by increasing extrapolation error; methods without that error come last.
    pub methods: Vec<PredictionRow>,
    /// Number of comparisons that the adjusted p-values of this problem account for.
    pub comparisons: usize,
    /// Conclusions, as sentences.
    pub verdict: Vec<String>,
}

/// The law of a simulated problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawSummary {
    /// Equation of the law in symbols.
    pub equation: String,
    /// Parameters of the law with units, in words.
    pub parameters: String,
    /// Accuracy of the closed form, in words.
    pub exactness: String,
    /// Decay rate λ of the viscous part, in 1/s.
    pub viscous_rate: f64,
    /// Negative least-squares slope of the noise-free ln A over all peaks, in 1/s.
    pub projected_slope: f64,
    /// Scatter of the peaks, in words.
    pub scatter: String,
    /// Number of draws for methods that draw no random numbers, and for methods that do. The second set of
    /// draws is the start of the first; errors and densities use only this common set.
    pub draws: [usize; 2],
}

/// Scores of the best exponential.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExponentialScores {
    /// Scores on peaks held out between others.
    pub interpolation: HeldOutScore,
    /// Scores on peaks held out at the end.
    pub extrapolation: HeldOutScore,
}

/// Result of one method on one problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionRow {
    /// Number of the method in the paper's tables; `None` if the paper does not have it.
    pub number: Option<u8>,
    /// Identifier, such as `"qr"` or `"pinn"`.
    pub id: String,
    /// Name in words.
    pub title: String,
    /// Origin of the method.
    pub family: Family,
    /// Outcome, or the reason for a missing one.
    pub outcome: PredictionOutcome,
}

/// Outcome of a method on a problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PredictionOutcome {
    /// The method was fitted and scored.
    Scored(Box<MethodScores>),
    /// No fit succeeded.
    Failed {
        /// Reason why the first fit failed.
        reason: Failure,
    },
}

impl PredictionOutcome {
    /// Returns `true` if the run was interrupted before this method began.
    #[must_use]
    pub fn is_not_begun(&self) -> bool {
        matches!(self, Self::Failed { reason: Failure::NotBegun })
    }
}

/// A method's scores on a problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodScores {
    /// Number of draws of a simulated problem; 1 for a record.
    pub draws: usize,
    /// Number of failed fits; each counts as an infinite error.
    pub failed_fits: usize,
    /// Reason why the first of them failed.
    pub first_failure: Option<Failure>,
    /// Number of fits.
    pub fits: usize,
    /// Number of fits that converged: that met the method's own condition.
    pub converged: usize,
    /// Scores on peaks held out between others; `None` if the method makes no prediction.
    pub interpolation: Option<HeldOutScore>,
    /// Scores on peaks held out at the end; `None` if the method makes no prediction.
    pub extrapolation: Option<HeldOutScore>,
    /// Share of draws in which the stated 95 % interval of λ contains the projected slope: the negative
    /// least-squares slope of the noise-free ln A over the peaks of the interpolation fit.
    pub covers_projected_slope: Option<Coverage>,
    /// Share of draws in which that interval contains λ of the law's viscous part.
    pub covers_viscous_rate: Option<Coverage>,
    /// Law discovered by the first interpolation fit; `None` if the method does not discover laws.
    pub equation: Option<String>,
    /// Most common form of the discovered laws, with every number written as `c`, and the number of
    /// interpolation fits that discovered it.
    pub commonest_form: Option<(String, usize)>,
    /// Median wall time of a fit, in seconds.
    pub seconds: f64,
}

/// Scores on held-out peaks. Errors and densities use the draws that every method was fitted on, so that rows
/// can be compared. Coverage and the sign test use all draws that the method was fitted on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldOutScore {
    /// Number of held-out peaks over all draws.
    pub peaks: usize,
    /// Number of predictions that are not finite, or missing because a fit failed.
    pub not_finite: usize,
    /// Root mean square error of ln A: for a record over its held-out peaks, for a simulation the median over
    /// its draws. Not finite, in JSON `null`, if a prediction is not.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub rms_log_error: f64,
    /// Largest `rms_log_error` over the draws.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst_rms_log_error: f64,
    /// Root mean square of Â/A − 1, in percent, aggregated as `rms_log_error`; a prediction of zero amplitude
    /// has an error of 100 %.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub amplitude_error_percent: f64,
    /// Root mean square error against the noise-free ln A, as the median over the draws; `None` if the truth
    /// is not known.
    pub truth_rms_log_error: Option<f64>,
    /// Mean natural logarithm of the stated predictive density of ln A; `None` unless a density is stated for
    /// every peak; not finite if a stated deviation is 0.
    pub mean_log_density: Option<f64>,
    /// Share of held-out peaks inside the stated 95 % predictive intervals.
    pub coverage: Option<Coverage>,
    /// Comparison with the best exponential on the same peaks; `None` for the extrapolation of a record.
    pub against_exponential: Option<PairedComparison>,
}

/// Share of intervals that contain the number they are stated for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Number of intervals that contain it.
    pub held: usize,
    /// Number of all intervals.
    pub of: usize,
    /// 95 % interval of the share: by Clopper and Pearson for independent draws, by Korn and Graubard for
    /// peaks in blocks or draws; `None` for fewer than five draws or blocks.
    pub interval_95: Option<[f64; 2]>,
}

/// A sign test of squared errors, paired by draw (simulations) or by block of peaks (records).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairedComparison {
    /// Number of pairs in which the method's mean square error is smaller.
    pub better: usize,
    /// Number of pairs in which the best exponential's mean square error is smaller.
    pub worse: usize,
    /// Number of pairs that agree to six digits; the test leaves them out.
    pub equal: usize,
    /// Two-sided p-value of the sign test.
    pub p_value: f64,
    /// That p-value, adjusted by Holm's method for all comparisons of the problem.
    pub adjusted_p_value: f64,
}

/// Kind of held-out split.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SplitKind {
    /// Blocks between other peaks are held out.
    Interpolation,
    /// The last peaks are held out.
    Extrapolation,
}

/// One row of `predictions.csv`: a peak and a method's prediction of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionCsvRow {
    /// Name of the problem.
    pub problem: String,
    /// Origin of the problem's numbers.
    pub origin: Origin,
    /// Kind of held-out split.
    pub split: SplitKind,
    /// Identifier of the method, or `best-exponential`.
    pub method: String,
    /// Time after the first peak, in seconds.
    pub time_s: f64,
    /// ln A of the peak; for a simulated problem, of the first draw.
    pub log_amplitude: f64,
    /// Noise-free ln A, if it is known.
    pub truth: Option<f64>,
    /// `true` if the peak was held out of the fit.
    pub held_out: bool,
    /// Predicted ln A; `inf`, `-inf` or `NaN` if it is not finite.
    pub predicted: f64,
    /// Stated standard deviation of a measured ln A around the prediction.
    pub std_error: Option<f64>,
}
