//! Results of an estimation, and the parts that several results share.

use super::method::Reached;
use super::modes::{ModeRow, Resonance};
use crate::interval::null_is_not_a_number;
use record::{Clock, Origin, Record, Source, Statements};
use serde::{Deserialize, Serialize};

/// The `schema` field of an estimation's `result.json`.
pub const RESULT_SCHEMA: &str = "ringdown.result/1";

/// Result of one estimation: the content of `result.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimationResult {
    /// Always [`RESULT_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"estimate"`.
    pub task: String,
    /// Identifier of the estimator, such as `"pinn"`.
    pub estimator: String,
    /// Name of the estimator in words.
    pub estimator_title: String,
    /// Seed of the fit in `estimate`.
    pub seed: u64,
    /// Source of the record and findings from reading its file.
    pub data: DataSummary,
    /// Envelope that every method was fitted to.
    pub envelope: EnvelopeSummary,
    /// Closed-form least squares on that envelope.
    pub oracle: OracleSummary,
    /// Estimate of the method on that envelope.
    pub estimate: EstimateSummary,
    /// |ζ − ζ_oracle| / |ζ_oracle| · 100; not finite, in JSON `null`, if the oracle's ζ is zero.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_percent: f64,
    /// Largest `error_percent` that passes.
    pub tolerance_percent: f64,
    /// `true` if every seed's error is within the tolerance.
    pub pass: bool,
    /// Wall time of the fit, in seconds.
    pub seconds: f64,
    /// Number of training steps taken.
    pub steps: u64,
    /// Number of trained parameters.
    pub parameters: usize,
    /// One row for each fitted seed; the row of `seed` comes first.
    pub seeds: Vec<SeedRow>,
    /// Largest `error_percent` over `seeds`.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst_error_percent: f64,
    /// Modes of the record, the most powerful first; empty if it shows only one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<ModeRow>,
    /// Closed-form least-squares results on the same record for each pipeline and clock.
    pub pipelines: Vec<PipelineRow>,
    /// Disagreement beyond the standard errors between these results: its size and the result to trust;
    /// absent if they agree.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disagreement: Option<String>,
    /// Estimate beside the truth, if the truth is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthComparison>,
}

/// An estimate beside the truth of a simulated record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthComparison {
    /// Path of the file that states the truth.
    pub file: String,
    /// Meaning of the true numbers, in a sentence.
    pub meaning: String,
    /// True undamped angular frequency, in rad/s.
    pub omega_rad_s: Option<f64>,
    /// Difference of the envelope's frequency from the true one, in percent, signed.
    pub omega_off_percent: Option<f64>,
    /// True damping ratio.
    pub zeta: Option<f64>,
    /// Difference of the estimated damping ratio from the true one, in percent, signed.
    pub zeta_off_percent: Option<f64>,
    /// That difference in standard errors of the estimate.
    pub zeta_off_std_errors: Option<f64>,
}

/// Source of a record and findings from reading its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DataSummary {
    /// Path as configured.
    pub path: String,
    /// SHA-256 of the file's bytes, hexadecimal, prefixed `sha256:`.
    pub digest: String,
    /// Origin of the record's numbers.
    pub origin: Origin,
    /// Number of samples in the file.
    pub samples: usize,
    /// Clock in force: `"host"`, `"uniform-index"` or `"index-with-gaps"`.
    pub clock: String,
    /// Reason for the clock in force, as a sentence.
    pub clock_reason: String,
    /// Believed clock: the one that stamps and values support, whether or not it is in force.
    pub believed_clock: String,
    /// Reason for the choice of that clock, as a sentence.
    pub believed_clock_reason: String,
    /// Sample period from a regression of time on the sample index, in seconds.
    pub sample_period_s: f64,
    /// Sampling rate of the sensor from a regression of time on the sample index, in hertz.
    pub sample_rate_hz: f64,
    /// Standard error of the sampling rate, in hertz.
    pub sample_rate_std_error_hz: f64,
    /// Step of the sensor's lattice in SI units; `None` if no lattice was found.
    pub resolution: Option<f64>,
    /// Unit of the observed quantity: `"rad"`, `"m"`, `"rad/s"`, …
    pub unit: String,
    /// Remarks about the file, as sentences for the reader.
    pub findings: Vec<String>,
    /// Decisions made when the file was read; empty in results of older versions.
    #[serde(default)]
    pub reading: record::Reading,
}

impl DataSummary {
    /// Creates the summary of a record file under the clock in force (`clock`) and the believed clock
    /// (`believed`). The file's own statements fill in what `stated` leaves open.
    #[must_use]
    pub fn new(
        record: &Record,
        source: &Source,
        clock: &Clock,
        believed: &Clock,
        stated: Statements,
    ) -> Self {
        let statements = stated.or(&source.statements);
        let mut findings = source.findings.clone();
        findings.extend(statements.contradictions(record.len(), clock));
        Self {
            path: source.path.clone(),
            digest: source.digest.clone(),
            origin: statements.origin.unwrap_or_default(),
            samples: record.len(),
            clock: clock.kind.name().to_owned(),
            clock_reason: clock.reason.clone(),
            believed_clock: believed.kind.name().to_owned(),
            believed_clock_reason: believed.reason.clone(),
            sample_period_s: 1.0 / clock.sample_rate_hz,
            sample_rate_hz: clock.sample_rate_hz,
            sample_rate_std_error_hz: clock.sample_rate_std_error_hz,
            resolution: record.lattice().map(|lattice| lattice.step),
            unit: record.unit().to_owned(),
            findings,
            reading: source.reading.clone(),
        }
    }
}

/// Envelope that every method was fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EnvelopeSummary {
    /// `"paper"`, `"recommended"` or `"samples"`.
    pub pipeline: String,
    /// Reason for the pipeline if the record decided it, as a clause.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pipeline_because: Option<String>,
    /// Number of peaks; of windows for `"samples"`.
    pub peaks: usize,
    /// Number of samples after interpolation; equal to `data.samples` if nothing is interpolated.
    pub samples: usize,
    /// Median period, in seconds.
    pub period_s: f64,
    /// 2π / `period_s`, in rad/s.
    pub omega_rad_s: f64,
    /// Rest position that was subtracted, in the record's unit.
    pub offset: f64,
    /// Time from the first sample to the first peak, in seconds; the envelope's time starts at the first
    /// peak.
    pub first_peak_s: f64,
}

impl EnvelopeSummary {
    /// Returns the name of what [`Self::peaks`] counts.
    #[must_use]
    pub fn counted(&self) -> &'static str {
        if self.pipeline == "samples" { "windows" } else { "peaks" }
    }

    /// Returns the name of the pipeline, with the reason if the record decided it.
    #[must_use]
    pub fn pipeline_in_words(&self) -> String {
        match &self.pipeline_because {
            Some(because) => format!("{}, since {because}", self.pipeline),
            None => self.pipeline.clone(),
        }
    }
}

/// Closed-form least squares of ln A on t.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OracleSummary {
    /// Decay rate λ, in 1/s.
    pub decay_rate: f64,
    /// ln A at the first peak.
    pub log_amplitude: f64,
    /// Coefficient of determination.
    pub r_squared: f64,
    /// Damping ratio ζ by the pipeline's definition: λ/ω (`"paper"`) or λ/√(λ² + ω²) (the others).
    pub zeta: f64,
    /// Standard error of λ under independent residuals, in 1/s. It includes the sensor noise, which weighs
    /// more as the amplitude falls, if the pipeline knows it.
    pub std_error: f64,
    /// Ratio of `std_error` to the standard error under residuals of equal variance.
    #[serde(default = "one")]
    pub scatter_factor: f64,
    /// 95 % interval of λ under independent residuals, in 1/s.
    pub interval_95: [f64; 2],
    /// Standard error of ζ with the frequency taken as known.
    pub zeta_std_error: f64,
    /// 95 % interval of ζ with the frequency taken as known.
    pub zeta_interval_95: [f64; 2],
    /// Two-norm condition number of the column-scaled design matrix.
    pub condition: f64,
    /// Number of significant decimal digits that the arithmetic guarantees.
    pub promised_digits: f64,
    /// Lag-one autocorrelation of the residuals. If it is far from zero, the standard errors are too small.
    pub residual_autocorrelation: f64,
}

/// Estimate of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimateSummary {
    /// Decay rate λ, in 1/s.
    pub decay_rate: f64,
    /// ln A at the first peak.
    pub log_amplitude: f64,
    /// Damping ratio ζ, defined as in [`OracleSummary::zeta`].
    pub zeta: f64,
    /// Standard error of λ, in 1/s, if the estimator states one: the standard error under residuals of equal
    /// variance times [`OracleSummary::scatter_factor`].
    pub std_error: Option<f64>,
    /// 95 % interval of λ, in 1/s, if the estimator states one.
    pub interval_95: Option<[f64; 2]>,
    /// Standard error of ζ, if the estimator states one.
    pub zeta_std_error: Option<f64>,
    /// 95 % interval of ζ, if the estimator states one.
    pub zeta_interval_95: Option<[f64; 2]>,
    /// Quality factor and half-power width by ζ and the frequency of the swing; the ends of their intervals are
    /// `null` if the estimator states none for ζ. `None` without a resonance.
    #[serde(flatten)]
    pub resonance: Option<Resonance>,
    /// State in which the training ended.
    pub reached: Reached,
    /// Reason why the training stopped, as a sentence.
    pub stopped_because: String,
}

/// Fit with one seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeedRow {
    /// The seed.
    pub seed: u64,
    /// Decay rate λ, in 1/s.
    pub decay_rate: f64,
    /// Damping ratio ζ, defined as in [`OracleSummary::zeta`].
    pub zeta: f64,
    /// |ζ − ζ_oracle| / |ζ_oracle| · 100; not finite, in JSON `null`, if the oracle's ζ is zero.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_percent: f64,
    /// State in which this seed's fit ended, as in [`EstimateSummary::reached`].
    pub reached: Reached,
    /// Number of training steps taken.
    pub steps: u64,
    /// Wall time, in seconds.
    pub seconds: f64,
}

/// Result on the same record for one pipeline and one clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PipelineRow {
    /// `"paper"` or `"recommended"`.
    pub pipeline: String,
    /// `"host"`, `"uniform-index"` or `"index-with-gaps"`.
    pub clock: String,
    /// `true` if the fits of this run used this row's envelope.
    pub in_force: bool,
    /// Outcome, or the reason for a missing one.
    pub outcome: PipelineOutcome,
}

/// Outcome of one pipeline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PipelineOutcome {
    /// Closed-form least squares on the envelope.
    Fit {
        /// Number of peaks.
        peaks: usize,
        /// 2π / median period, in rad/s.
        omega_rad_s: f64,
        /// Decay rate λ, in 1/s.
        decay_rate: f64,
        /// Damping ratio ζ, defined as in [`OracleSummary::zeta`].
        zeta: f64,
        /// Standard error of ζ under independent residuals.
        zeta_std_error: f64,
        /// Coefficient of determination.
        r_squared: f64,
    },
    /// The pipeline does not apply to this record.
    Failed {
        /// Reason for the failure.
        reason: String,
    },
}

/// One row of `trace.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TraceRow {
    /// Step, from 0 (untrained).
    pub step: u64,
    /// Phase of the training, such as `"physics weight 100"`.
    pub phase: String,
    /// Loss that the training minimizes, in the method's own scaled units.
    pub loss: f64,
    /// Decay rate λ at this step, in 1/s.
    pub decay_rate: f64,
}

/// One row of `envelope.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EnvelopeRow {
    /// Time after the first peak, in seconds.
    pub time_s: f64,
    /// Natural logarithm of the peak's amplitude.
    pub log_amplitude: f64,
    /// Value of the oracle's line at this time.
    pub oracle: f64,
    /// Value of the estimator's fitted function at this time.
    pub estimate: f64,
}

/// Default of [`OracleSummary::scatter_factor`] for results written before that field existed.
fn one() -> f64 {
    1.0
}
