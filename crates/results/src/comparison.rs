//! A comparison of many methods on one envelope.

use super::estimation::{DataSummary, EnvelopeSummary, OracleSummary, PipelineRow, TruthComparison};
use super::failure::Failure;
use super::interval::null_is_not_a_number;
use super::method::{Ablation, Estimand, Family, Reached};
use serde::{Deserialize, Serialize};

/// Result of a comparison of methods: the content of `result.json` with `task = "compare"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparisonResult {
    /// Always [`super::RESULT_SCHEMA`].
    pub schema: String,
    /// Task that was asked for: `"compare"`.
    pub task: String,
    /// The first seed.
    pub seed: u64,
    /// Number of seeds that methods which draw random numbers were fitted with.
    pub seeds: u64,
    /// Where the record came from and what its file was found to be.
    pub data: DataSummary,
    /// The envelope that every method was given.
    pub envelope: EnvelopeSummary,
    /// Certified least squares on that envelope.
    pub oracle: OracleSummary,
    /// Physical quantities that follow from the reference's numbers.
    pub derived: Derived,
    /// One row for each method, in the paper's order.
    pub results: Vec<MethodRow>,
    /// The same line by libraries that are not of this project: a second opinion on the reference.
    #[serde(default)]
    pub libraries: Vec<MethodRow>,
    /// The largest error over methods and seeds, in percent.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub max_error_percent: f64,
    /// The largest error that passes, in percent.
    pub tolerance_percent: f64,
    /// True if every method gave an estimate within the tolerance.
    pub pass: bool,
    /// Wall time of all fits together, in seconds.
    pub seconds: f64,
    /// The same record through each pipeline and clock, by certified least squares.
    pub pipelines: Vec<PipelineRow>,
    /// Where those differ by more than their errors: which, by how much, and which to believe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disagreement: Option<String>,
    /// Least squares beside the truth, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthComparison>,
    /// Statements commonly read off such a table that do not follow from it.
    pub cautions: Vec<Caution>,
}

impl ComparisonResult {
    /// The methods whose value is held against least squares.
    pub fn held_to_least_squares(&self) -> impl Iterator<Item = &MethodRow> {
        self.results.iter().filter(|row| row.is_held_to_least_squares())
    }

    /// The methods that estimate something else, for which a distance from least squares is no error.
    pub fn of_their_own(&self) -> impl Iterator<Item = &MethodRow> {
        self.results.iter().filter(|row| !row.is_held_to_least_squares())
    }
}

/// Physical quantities that follow from frequency, decay rate and the rig's moment of inertia.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Derived {
    /// Period, in seconds.
    pub period_s: f64,
    /// Frequency, in hertz.
    pub frequency_hz: f64,
    /// Moment of inertia I as configured, in kg·m²; 1 where none is.
    pub inertia_kg_m2: f64,
    /// True if no inertia is configured: stiffness and damping are then per unit of inertia, in 1/s² and 1/s.
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
    /// Cycles in which the amplitude falls to 1/e: ω/(2π·λ) = Q/π.
    pub cycles_to_one_over_e: f64,
    /// Half-life of the amplitude, ln 2/λ, in seconds.
    pub half_life_s: f64,
    /// Time constant of the amplitude, 1/λ, in seconds.
    pub time_constant_s: f64,
}

/// One method's row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodRow {
    /// Number in the paper's tables.
    pub number: Option<u8>,
    /// Identifier.
    pub id: String,
    /// Name in words.
    pub title: String,
    /// Where it comes from.
    pub family: Family,
    /// Relation of its converged value to least squares.
    #[serde(default)]
    pub estimand: Estimand,
    /// Estimate, or the reason why there is none.
    pub outcome: MethodOutcome,
}

impl MethodRow {
    /// Whether its value is held against least squares; where it estimates something else, a distance from it is no error.
    #[must_use]
    pub fn is_held_to_least_squares(&self) -> bool {
        self.estimand != Estimand::Own
    }
}

/// A method's first seed fitted without a part of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AblationRow {
    /// The part that was taken away.
    pub ablation: Ablation,
    /// |ζ − ζ_oracle| / ζ_oracle · 100 of that fit; `None` where it gave no estimate.
    pub error_percent: Option<f64>,
    /// Why it gave none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
}

/// Outcome of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MethodOutcome {
    /// Estimates, the first seed's where there are several.
    Estimate(MethodEstimate),
    /// No estimate.
    Failed {
        /// Why.
        reason: Failure,
    },
}

impl MethodOutcome {
    /// Whether its turn had not come when the run was interrupted.
    #[must_use]
    pub fn is_not_begun(&self) -> bool {
        matches!(self, Self::Failed { reason: Failure::NotBegun })
    }

    /// Whether the run was interrupted before this method had finished.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.is_not_begun() || self.estimate().is_some_and(|own| own.reached == Reached::Interrupted)
    }

    /// The estimate, where there is one.
    #[must_use]
    pub fn estimate(&self) -> Option<&MethodEstimate> {
        match self {
            Self::Estimate(estimate) => Some(estimate),
            Self::Failed { .. } => None,
        }
    }

    /// Whether there is an estimate that passes.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.estimate().is_some_and(|estimate| estimate.pass)
    }
}

/// A method's estimate over its seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodEstimate {
    /// λ, in 1/s.
    pub decay_rate: f64,
    /// λ/ω.
    pub zeta: f64,
    /// Standard error of ζ, where the method states one.
    pub zeta_std_error: Option<f64>,
    /// |ζ − ζ_oracle| / ζ_oracle · 100 of the first seed.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_percent: f64,
    /// Its median over the seeds.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub median_error_percent: f64,
    /// Its largest over the seeds.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst_error_percent: f64,
    /// Significant digits in which the worst seed agrees with the oracle; 15.7 at most.
    pub digits_of_agreement: f64,
    /// Number of seeds fitted: 1 for a method that draws nothing.
    pub seeds: u64,
    /// Steps of the first seed.
    pub steps: u64,
    /// Number of trained parameters.
    pub parameters: usize,
    /// Median wall time of a fit, in seconds.
    pub seconds: f64,
    /// State in which the first seed's fit ended.
    pub reached: Reached,
    /// Reason, in a sentence, why the first seed's fit stopped.
    pub stopped_because: String,
    /// True if every seed is within the tolerance; one that estimates something else than least squares passes
    /// where it gives a finite value.
    pub pass: bool,
    /// The same fit with the learned part at zero, and with noise for its input; empty for a method without a
    /// learned part.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ablations: Vec<AblationRow>,
}

/// A statement that the numbers do not bear out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Caution {
    /// The statement, as it is commonly made.
    pub statement: String,
    /// Finding that the numbers support: a sentence.
    pub finding: String,
}
