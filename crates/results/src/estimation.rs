//! What an estimation found, and the parts that several answers share.

use super::method::Reached;
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
    /// Task that was asked for: `"estimate"`.
    pub task: String,
    /// Identifier of the estimator, such as `"pinn"`.
    pub estimator: String,
    /// Its name in words.
    pub estimator_title: String,
    /// The seed of the fit that `estimate` holds.
    pub seed: u64,
    /// Where the record came from and what its file was found to be.
    pub data: DataSummary,
    /// The envelope that every method was given.
    pub envelope: EnvelopeSummary,
    /// Closed-form least squares on that envelope.
    pub oracle: OracleSummary,
    /// Estimate of the method on that envelope.
    pub estimate: EstimateSummary,
    /// |ζ − ζ_oracle| / ζ_oracle · 100; not finite, in JSON `null`, where the oracle's ζ is zero.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_percent: f64,
    /// The largest `error_percent` that passes.
    pub tolerance_percent: f64,
    /// True if every seed's error is within the tolerance.
    pub pass: bool,
    /// Wall time of the fit, in seconds.
    pub seconds: f64,
    /// Training steps taken.
    pub steps: u64,
    /// Number of trained parameters.
    pub parameters: usize,
    /// One row for each seed that was fitted, `seed` first.
    pub seeds: Vec<SeedRow>,
    /// The largest `error_percent` over `seeds`.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub worst_error_percent: f64,
    /// The same record through each pipeline and clock, by closed-form least squares.
    pub pipelines: Vec<PipelineRow>,
    /// Where those differ by more than their errors: which, by how much, and which to believe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disagreement: Option<String>,
    /// The answer beside the truth, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthComparison>,
}

/// An answer beside the truth of a simulated record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthComparison {
    /// The file that states the truth.
    pub file: String,
    /// Meaning of the true numbers, in a sentence.
    pub meaning: String,
    /// True undamped angular frequency, in rad/s.
    pub omega_rad_s: Option<f64>,
    /// Distance of the envelope's frequency from it, in percent, with its sign.
    pub omega_off_percent: Option<f64>,
    /// True damping ratio.
    pub zeta: Option<f64>,
    /// Distance of the estimate from it, in percent, with its sign.
    pub zeta_off_percent: Option<f64>,
    /// The same in standard errors of the estimate.
    pub zeta_off_std_errors: Option<f64>,
}

/// Where the record came from and what its file was found to be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DataSummary {
    /// The path as configured.
    pub path: String,
    /// SHA-256 of the file's bytes, hexadecimal, prefixed `sha256:`.
    pub digest: String,
    /// Where its numbers came from.
    pub origin: Origin,
    /// Samples in the file.
    pub samples: usize,
    /// The clock in force: `"host"`, `"uniform-index"` or `"index-with-gaps"`.
    pub clock: String,
    /// Why that clock is in force, in a sentence.
    pub clock_reason: String,
    /// The clock that the stamps and the values speak for, whatever is in force.
    pub believed_clock: String,
    /// Why that one is believed, in a sentence.
    pub believed_clock_reason: String,
    /// The sample period by a regression of time on the sample index, in seconds.
    pub sample_period_s: f64,
    /// The rate of the sensor by a regression of time on the sample index, in hertz.
    pub sample_rate_hz: f64,
    /// Its standard error, in hertz.
    pub sample_rate_std_error_hz: f64,
    /// The step of the sensor's lattice in SI units, where one was found.
    pub resolution: Option<f64>,
    /// Unit of the observed quantity: `"rad"`, `"m"`, `"rad/s"`, …
    pub unit: String,
    /// Remarks about the file: sentences for the reader.
    pub findings: Vec<String>,
    /// Decisions made in reading the file; empty in results of earlier versions.
    #[serde(default)]
    pub reading: record::Reading,
}

impl DataSummary {
    /// The summary of a record file under the clock in force and the one that is believed. What `stated` leaves open, the
    /// file answers.
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

/// The envelope that every method was given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EnvelopeSummary {
    /// `"paper"` or `"recommended"`.
    pub pipeline: String,
    /// Number of peaks.
    pub peaks: usize,
    /// Samples after interpolation (equal to `data.samples` where nothing is interpolated).
    pub samples: usize,
    /// Median period, in seconds.
    pub period_s: f64,
    /// 2π / `period_s`, in rad/s.
    pub omega_rad_s: f64,
    /// The rest position that was removed, in the record's unit.
    pub offset: f64,
    /// Time of the first peak after the first sample, in seconds; the envelope's time starts there.
    pub first_peak_s: f64,
}

/// Closed-form least squares of ln A on t.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OracleSummary {
    /// λ, in 1/s.
    pub decay_rate: f64,
    /// ln A at the first peak.
    pub log_amplitude: f64,
    /// Coefficient of determination.
    pub r_squared: f64,
    /// λ / ω.
    pub zeta: f64,
    /// Standard error of λ under independent residuals, in 1/s; the sensor's noise, which weighs more as the amplitude falls,
    /// is allowed for where the pipeline knows it.
    pub std_error: f64,
    /// `std_error` over the standard error under residuals of one variance.
    #[serde(default = "one")]
    pub scatter_factor: f64,
    /// 95 % interval of λ under independent residuals, in 1/s.
    pub interval_95: [f64; 2],
    /// Standard error of ζ, the frequency taken as known.
    pub zeta_std_error: f64,
    /// 95 % interval of ζ, the frequency taken as known.
    pub zeta_interval_95: [f64; 2],
    /// Two-norm condition number of the column-scaled design matrix.
    pub condition: f64,
    /// Significant decimal digits that the arithmetic promises.
    pub promised_digits: f64,
    /// Lag-one autocorrelation of the residuals: far from zero, the standard errors are too small.
    pub residual_autocorrelation: f64,
}

/// Estimate of a method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimateSummary {
    /// λ, in 1/s.
    pub decay_rate: f64,
    /// ln A at the first peak.
    pub log_amplitude: f64,
    /// λ / ω.
    pub zeta: f64,
    /// Standard error of λ, in 1/s, where the estimator states one: that under residuals of one variance, times
    /// [`OracleSummary::scatter_factor`].
    pub std_error: Option<f64>,
    /// 95 % interval of λ, in 1/s, where the estimator states one.
    pub interval_95: Option<[f64; 2]>,
    /// Standard error of ζ, where the estimator states one.
    pub zeta_std_error: Option<f64>,
    /// 95 % interval of ζ, where the estimator states one.
    pub zeta_interval_95: Option<[f64; 2]>,
    /// State in which the training ended.
    pub reached: Reached,
    /// Reason, in a sentence, why the training stopped.
    pub stopped_because: String,
}

/// One seed's fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeedRow {
    /// The seed.
    pub seed: u64,
    /// λ, in 1/s.
    pub decay_rate: f64,
    /// λ / ω.
    pub zeta: f64,
    /// |ζ − ζ_oracle| / ζ_oracle · 100; not finite, in JSON `null`, where the oracle's ζ is zero.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub error_percent: f64,
    /// State in which this seed's fit ended, as in [`EstimateSummary::reached`].
    pub reached: Reached,
    /// Training steps taken.
    pub steps: u64,
    /// Wall time, in seconds.
    pub seconds: f64,
}

/// The same record through one pipeline and one clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PipelineRow {
    /// `"paper"` or `"recommended"`.
    pub pipeline: String,
    /// `"host"`, `"uniform-index"` or `"index-with-gaps"`.
    pub clock: String,
    /// True if the fits of this run used this row's envelope.
    pub in_force: bool,
    /// Outcome, or the reason why there is none.
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
        /// λ, in 1/s.
        decay_rate: f64,
        /// λ / ω.
        zeta: f64,
        /// Standard error of ζ under independent residuals.
        zeta_std_error: f64,
        /// Coefficient of determination.
        r_squared: f64,
    },
    /// The pipeline does not apply to this record.
    Failed {
        /// Why.
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
    /// The loss that the training minimizes, in the method's own scaled units.
    pub loss: f64,
    /// λ at this step, in 1/s.
    pub decay_rate: f64,
}

/// One row of `envelope.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EnvelopeRow {
    /// Time after the first peak, in seconds.
    pub time_s: f64,
    /// Natural logarithm of the peak's amplitude.
    pub log_amplitude: f64,
    /// The oracle's line at this time.
    pub oracle: f64,
    /// The estimator's fitted function at this time.
    pub estimate: f64,
}

/// The factor of a result that was written before there was one.
fn one() -> f64 {
    1.0
}
