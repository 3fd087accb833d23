//! Results of a comparison of many methods on one envelope.

use super::estimation::{DataSummary, EnvelopeSummary, OracleSummary, PipelineRow, TruthComparison};
use super::failure::Failure;
use super::interval::null_is_not_a_number;
use super::method::{Ablation, Estimand, Family, Reached};
use super::modes::ModeRow;
use serde::{Deserialize, Serialize};

/// Result of a comparison of methods: the content of `result.json` with `task = "compare"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparisonResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"compare"`.
    pub task: String,
    /// The first seed.
    pub seed: u64,
    /// Number of seeds that were used to fit each method that draws random numbers.
    pub seeds: u64,
    /// Source of the record and findings from reading its file.
    pub data: DataSummary,
    /// Envelope that every method was fitted to.
    pub envelope: EnvelopeSummary,
    /// Certified least squares on that envelope.
    pub oracle: OracleSummary,
    /// Physical quantities derived from the reference's estimates.
    pub derived: Derived,
    /// One row for each method, in the paper's order.
    pub results: Vec<MethodRow>,
    /// Fits of the same line by third-party libraries: a second opinion on the reference.
    #[serde(default)]
    pub libraries: Vec<MethodRow>,
    /// Largest error over methods and seeds whose error counts, in percent.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub max_error_percent: f64,
    /// Largest error that passes, in percent.
    pub tolerance_percent: f64,
    /// `true` if every method whose error counts gave an estimate within the tolerance.
    pub pass: bool,
    /// Wall time of all fits together, in seconds.
    pub seconds: f64,
    /// Modes of the record, the most powerful first; empty if it shows only one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<ModeRow>,
    /// Certified least-squares results on the same record for each pipeline and clock.
    pub pipelines: Vec<PipelineRow>,
    /// Disagreement beyond the standard errors between these results: its size and the result to trust;
    /// absent if they agree.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disagreement: Option<String>,
    /// Least-squares result beside the truth, if the truth is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthComparison>,
    /// Statements often drawn from such a table that do not follow from it.
    pub cautions: Vec<Caution>,
}

impl ComparisonResult {
    /// Returns the methods whose distance from least squares counts.
    pub fn held_to_least_squares(&self) -> impl Iterator<Item = &MethodRow> {
        self.results.iter().filter(|row| row.is_held_to_least_squares())
    }

    /// Returns the methods that estimate another quantity, so that a distance from least squares is no error.
    pub fn of_their_own(&self) -> impl Iterator<Item = &MethodRow> {
        self.results.iter().filter(|row| row.estimand == Estimand::Own)
    }

    /// Returns the weak baselines whose distance from least squares does not count.
    pub fn excused(&self) -> impl Iterator<Item = &MethodRow> {
        self.results.iter().filter(|row| row.excused)
    }
}

/// Physical quantities that follow from frequency, decay rate and the rig's moment of inertia.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Derived {
    /// Period, in seconds.
    pub period_s: f64,
    /// Frequency, in hertz.
    pub frequency_hz: f64,
    /// Moment of inertia I as configured, in kg·m²; 1 if none is configured.
    pub inertia_kg_m2: f64,
    /// `true` if no inertia is configured; stiffness and damping are then per unit of inertia, in 1/s² and
    /// 1/s.
    #[serde(default)]
    pub per_unit_of_inertia: bool,
    /// Stiffness k = I·ω², in N·m/rad.
    pub stiffness_n_m_per_rad: f64,
    /// Damping coefficient c = 2·I·λ, in N·m·s/rad.
    pub damping_n_m_s_per_rad: f64,
    /// Critical damping 2·√(k·I), in N·m·s/rad.
    pub critical_damping_n_m_s_per_rad: f64,
    /// Quality factor Q = 1/(2ζ).
    pub quality_factor: f64,
    /// Number of cycles in which the amplitude falls to 1/e: ω/(2π·λ) = Q/π.
    pub cycles_to_one_over_e: f64,
    /// Half-life of the amplitude, ln 2/λ, in seconds.
    pub half_life_s: f64,
    /// Time constant of the amplitude, 1/λ, in seconds.
    pub time_constant_s: f64,
}

/// Result of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodRow {
    /// Number of the method in the paper's tables; `None` if the paper does not have it.
    pub number: Option<u8>,
    /// Identifier of the method.
    pub id: String,
    /// Name of the method in words.
    pub title: String,
    /// Origin of the method.
    pub family: Family,
    /// Relation of the method's converged value to least squares.
    #[serde(default)]
    pub estimand: Estimand,
    /// `true` if the distance from least squares does not count: a deliberately weak baseline has used up a
    /// number of steps that is fixed whatever the record.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub excused: bool,
    /// Estimate, or the reason for a missing one.
    pub outcome: MethodOutcome,
}

impl MethodRow {
    /// Returns `true` if the method's distance from least squares counts. If the method estimates another
    /// quantity, the distance is no error; if it is an excused baseline, the error tells nothing new.
    #[must_use]
    pub fn is_held_to_least_squares(&self) -> bool {
        self.estimand != Estimand::Own && !self.excused
    }
}

/// Fit of a method's first seed with a part of the method removed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AblationRow {
    /// The removed part.
    pub ablation: Ablation,
    /// |ζ − ζ_oracle| / |ζ_oracle| · 100 of that fit; `None` if it gave no estimate.
    pub error_percent: Option<f64>,
    /// Reason for a missing estimate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
}

/// Outcome of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MethodOutcome {
    /// Estimate of the method; with several seeds, that of the first.
    Estimate(MethodEstimate),
    /// No estimate.
    Failed {
        /// Reason for the failure.
        reason: Failure,
    },
}

impl MethodOutcome {
    /// Returns `true` if the run was interrupted before this method began.
    #[must_use]
    pub fn is_not_begun(&self) -> bool {
        matches!(self, Self::Failed { reason: Failure::NotBegun })
    }

    /// Returns `true` if the run was interrupted before this method finished.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.is_not_begun() || self.estimate().is_some_and(|own| own.reached == Reached::Interrupted)
    }

    /// Returns the estimate, if there is one.
    #[must_use]
    pub fn estimate(&self) -> Option<&MethodEstimate> {
        match self {
            Self::Estimate(estimate) => Some(estimate),
            Self::Failed { .. } => None,
        }
    }

    /// Returns `true` if there is an estimate and it passes.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.estimate().is_some_and(|estimate| estimate.pass)
    }
}

/// A method's estimate over its seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodEstimate {
    /// Decay rate λ, in 1/s.
    pub decay_rate: f64,
    /// Damping ratio ζ, defined as in [`OracleSummary::zeta`].
    pub zeta: f64,
    /// Standard error of ζ, if the method states one.
    pub zeta_std_error: Option<f64>,
    /// |ζ − ζ_oracle| / |ζ_oracle| · 100 of the first seed.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_percent: f64,
    /// Median of that error over the seeds.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub median_error_percent: f64,
    /// Largest of that error over the seeds.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst_error_percent: f64,
    /// Significant digits in which the worst seed agrees with the oracle; at most 15.7.
    pub digits_of_agreement: f64,
    /// Number of seeds fitted; 1 for a method that draws no random numbers.
    pub seeds: u64,
    /// Number of training steps of the first seed's fit.
    pub steps: u64,
    /// Number of trained parameters.
    pub parameters: usize,
    /// Median wall time of a fit, in seconds.
    pub seconds: f64,
    /// State in which the first seed's fit ended.
    pub reached: Reached,
    /// Reason why the first seed's fit stopped, as a sentence.
    pub stopped_because: String,
    /// `true` if every seed is within the tolerance; a method that estimates another quantity than least
    /// squares passes if its value is finite.
    pub pass: bool,
    /// The first seed's fit with the learned part held at zero, and with noise as the input; empty for a
    /// method without a learned part.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ablations: Vec<AblationRow>,
}

/// A common statement that the numbers do not support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Caution {
    /// The statement, as it is commonly made.
    pub statement: String,
    /// Conclusion that the numbers support, as a sentence.
    pub finding: String,
}
