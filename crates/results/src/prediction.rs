//! Many methods scored on peaks that were held out, over several problems.

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
    /// Task that was asked for: `"predict"`.
    pub task: String,
    /// The seed of the first draw and of its fits.
    pub seed: u64,
    /// Splits by which peaks were held out.
    pub splits: SplitSummary,
    /// One entry for each problem, in the order configured.
    pub problems: Vec<ProblemRow>,
    /// Wall time of all fits together, in seconds.
    pub seconds: f64,
}

/// Splits by which peaks were held out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SplitSummary {
    /// Interpolation: successive peaks in a block.
    pub block_peaks: usize,
    /// Interpolation: of so many successive blocks one is held out.
    pub every: usize,
    /// Extrapolation: the share of the peaks at the end that is held out.
    pub last_share: f64,
    /// Level that adjusted p-values are held to.
    pub significance: f64,
}

/// One problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProblemRow {
    /// Name in the configuration.
    pub id: String,
    /// Title in words.
    pub title: String,
    /// Where its numbers came from.
    pub origin: Origin,
    /// Outcome, or the reason why there is none.
    pub outcome: ProblemOutcome,
}

/// Outcome of one problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProblemOutcome {
    /// Every method was asked.
    Studied(Box<ProblemStudy>),
    /// The record is not there.
    Absent {
        /// Which, and what to do.
        reason: String,
    },
}

/// Results on one problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProblemStudy {
    /// Unit of the amplitude.
    pub unit: String,
    /// Peaks of the envelope.
    pub peaks: usize,
    /// Time from the first peak to the last, in seconds.
    pub duration_s: f64,
    /// The record, where there is one.
    pub data: Option<DataSummary>,
    /// The law, where the problem is simulated.
    pub law: Option<LawSummary>,
    /// The best exponential: closed-form least squares on the peaks that were not held out.
    pub exponential: ExponentialScores,
    /// One row for each method, by rising error of extrapolation, those without one last.
    pub methods: Vec<PredictionRow>,
    /// Comparisons that the adjusted p-values of this problem answer for.
    pub comparisons: usize,
    /// Conclusions, in sentences.
    pub verdict: Vec<String>,
}

/// The law of a simulated problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawSummary {
    /// The law in symbols.
    pub equation: String,
    /// Its parameters with units, in words.
    pub parameters: String,
    /// Exactness of the closed form, in words.
    pub exactness: String,
    /// λ of the viscous part, in 1/s.
    pub viscous_rate: f64,
    /// Minus the least-squares slope of the noise-free ln A over all peaks, in 1/s.
    pub projected_slope: f64,
    /// Scatter of the peaks, in words.
    pub scatter: String,
    /// Draws for methods without random numbers of their own, and for those with. The latter are the first
    /// of the former; errors and densities are of these alone.
    pub draws: [usize; 2],
}

/// Scores of the best exponential.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExponentialScores {
    /// Peaks held out between others.
    pub interpolation: HeldOutScore,
    /// Peaks held out at the end.
    pub extrapolation: HeldOutScore,
}

/// One method on one problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionRow {
    /// Number in the paper's tables, where it is one of the paper's.
    pub number: Option<u8>,
    /// Identifier, such as `"qr"` or `"pinn"`.
    pub id: String,
    /// Name in words.
    pub title: String,
    /// Where it comes from.
    pub family: Family,
    /// Outcome, or the reason why there is none.
    pub outcome: PredictionOutcome,
}

/// Outcome of a method on a problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PredictionOutcome {
    /// It was fitted.
    Scored(Box<MethodScores>),
    /// No fit came out.
    Failed {
        /// Why the first one did not.
        reason: Failure,
    },
}

impl PredictionOutcome {
    /// Whether its turn had not come when the run was interrupted.
    #[must_use]
    pub fn is_not_begun(&self) -> bool {
        matches!(self, Self::Failed { reason: Failure::NotBegun })
    }
}

/// A method's scores on a problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodScores {
    /// Draws of a simulated problem; 1 for a record.
    pub draws: usize,
    /// Fits that failed; each counts as an infinite error.
    pub failed_fits: usize,
    /// Why the first of them failed.
    pub first_failure: Option<Failure>,
    /// Fits, and how many of them met the method's own condition.
    pub fits: usize,
    /// Fits that converged.
    pub converged: usize,
    /// Peaks held out between others; `None` where the method makes no prediction.
    pub interpolation: Option<HeldOutScore>,
    /// Peaks held out at the end; `None` where the method makes no prediction.
    pub extrapolation: Option<HeldOutScore>,
    /// Share of draws in which the stated 95 % interval of λ holds the projected slope: minus the least-squares slope of
    /// the noise-free ln A over the peaks of the interpolation fit.
    pub covers_projected_slope: Option<Coverage>,
    /// Share of draws in which it holds λ of the law's viscous part.
    pub covers_viscous_rate: Option<Coverage>,
    /// The law discovered by the first interpolation fit, where the method discovers laws.
    pub equation: Option<String>,
    /// Number of interpolation fits that discovered a law of the commonest form, and that form with every
    /// number written as `c`.
    pub commonest_form: Option<(String, usize)>,
    /// Median wall time of a fit, in seconds.
    pub seconds: f64,
}

/// Scores on held-out peaks. Errors and densities are of the draws that every method was fitted on, so that
/// rows can be compared; coverage and the sign test are of all draws that the method was fitted on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldOutScore {
    /// Held-out peaks, over all draws.
    pub peaks: usize,
    /// Predictions that are not finite.
    pub not_finite: usize,
    /// Root mean square error of ln A: of a record over its held-out peaks, of a simulation the median over
    /// its draws. Not finite, in JSON `null`, where a prediction is not.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub rms_log_error: f64,
    /// The largest over the draws.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst_rms_log_error: f64,
    /// The same of Â/A − 1, in percent; a prediction at rest misses by 100 %.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub amplitude_error_percent: f64,
    /// The root mean square error against the noise-free ln A, the median over the draws, where the truth is
    /// known.
    pub truth_rms_log_error: Option<f64>,
    /// Mean natural logarithm of the stated predictive density of ln A, where one is stated everywhere; not
    /// finite where a stated deviation is 0.
    pub mean_log_density: Option<f64>,
    /// Share of held-out peaks that the stated 95 % predictive intervals hold.
    pub coverage: Option<Coverage>,
    /// Against the best exponential on the same peaks.
    pub against_exponential: Option<PairedComparison>,
}

/// Share of intervals that hold the number they are stated for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Intervals that do.
    pub held: usize,
    /// All intervals.
    pub of: usize,
    /// 95 % interval of the share, of independent draws by Clopper and Pearson, of peaks in blocks or draws
    /// by Korn and Graubard; `None` for fewer than five draws or blocks.
    pub interval_95: Option<[f64; 2]>,
}

/// A sign test of squared errors, paired by draw (simulations) or by block of peaks (records).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairedComparison {
    /// Pairs in which the method's mean square error is the smaller.
    pub better: usize,
    /// Pairs in which the best exponential's is.
    pub worse: usize,
    /// Pairs in which they agree to six digits, left out of the test.
    pub equal: usize,
    /// Two-sided p-value of the sign test.
    pub p_value: f64,
    /// The same, adjusted by Holm's method for all comparisons of the problem.
    pub adjusted_p_value: f64,
}

/// Why peaks are held out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SplitKind {
    /// Blocks between others.
    Interpolation,
    /// The end.
    Extrapolation,
}

/// One row of `predictions.csv`: a peak, what a method says of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionCsvRow {
    /// Name of the problem.
    pub problem: String,
    /// Where its numbers came from.
    pub origin: Origin,
    /// Why peaks were held out.
    pub split: SplitKind,
    /// Identifier of the method, or `best-exponential`.
    pub method: String,
    /// Time after the first peak, in seconds.
    pub time_s: f64,
    /// ln A of the peak, of the first draw where it is simulated.
    pub log_amplitude: f64,
    /// The noise-free ln A, where it is known.
    pub truth: Option<f64>,
    /// True if the peak was kept from the fit.
    pub held_out: bool,
    /// ln A as predicted; `inf`, `-inf` or `NaN` where it is not finite.
    pub predicted: f64,
    /// Stated standard deviation of a measured ln A about it.
    pub std_error: Option<f64>,
}
