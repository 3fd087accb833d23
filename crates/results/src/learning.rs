//! What `task = "learn"` leaves: learners and baselines on records they never saw.

use crate::method::Reached;
use record::Origin;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The content of a learning study's `result.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnResult {
    /// Always [`crate::RESULT_SCHEMA`].
    pub schema: String,
    /// Task that was asked for: `"learn"`.
    pub task: String,
    /// Root of every random draw.
    pub seed: u64,
    /// Records of all problems together, and how many of their stretches each part has.
    pub data: LearnData,
    /// The problems, in the order of the configuration.
    pub problems: Vec<LearnProblem>,
    /// A row for each problem and method: problems in their order, within each the least error first, and ablations of
    /// learners last.
    pub results: Vec<LearnRow>,
    /// Wall time of all fits, in seconds.
    pub seconds: f64,
}

/// Sizes of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LearnData {
    /// Records.
    pub records: usize,
    /// Stretches that are learned from.
    pub train: usize,
    /// Stretches that choose among models.
    pub validation: usize,
    /// Stretches that models are judged on.
    pub test: usize,
}

/// A data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnProblem {
    /// Name in the configuration.
    pub id: String,
    /// Title in words.
    pub title: String,
    /// Where its numbers came from.
    pub origin: Origin,
    /// Why there is nothing else; `None` where there is.
    pub absent: Option<String>,
    /// Unit of the positions.
    pub unit: String,
    /// Sizes.
    pub data: LearnData,
    /// Samples that are learned from.
    pub training_samples: usize,
    /// Samples per second.
    pub rate_hz: f64,
    /// Typical period, in seconds.
    pub period_s: f64,
    /// Past that a prediction starts from, in seconds.
    pub warm_up_s: f64,
    /// Standard deviation of the sensor's noise.
    pub noise: f64,
    /// Mean length of a test stretch after its warm-up, in seconds.
    pub test_s: f64,
    /// What the input does between its samples, `"zero"` (kept) or `"linear"`; `None` without an input.
    #[serde(default)]
    pub input_hold: Option<String>,
    /// Records with missing cells, and what was done about these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
}

impl LearnProblem {
    /// What the input does between its samples, in words; `None` without an input.
    #[must_use]
    pub fn input_between_samples(&self) -> Option<&'static str> {
        let hold = self.input_hold.as_deref()?;
        Some(if hold == "linear" { "straight to the next" } else { "kept" })
    }
}

/// A method on a data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnRow {
    /// Name of the problem.
    pub problem: String,
    /// Identifier of the learner or baseline.
    pub id: String,
    /// Name in words.
    pub title: String,
    /// Part that it plays in the table.
    pub kind: LearnKind,
    /// Scores on the test part; `None` where nothing was learned.
    pub test: Option<LearnTest>,
    /// Error on the validation part, by which settings may be chosen; of a training that was stopped, the least so far.
    #[serde(default)]
    pub validation: Option<LearnValidation>,
    /// Coefficients of the law by name, where the model is one.
    pub coefficients: Option<BTreeMap<String, LearnCoefficient>>,
    /// The law as text.
    pub equation: Option<String>,
    /// Root mean square error of the learned torque over what the nominal simulator lacks, where the truth is known.
    pub torque_error: Option<f64>,
    /// Trained numbers.
    pub parameters: usize,
    /// Wall time of the training, in seconds.
    pub seconds: f64,
    /// End of its training.
    pub reached: LearnEnd,
    /// Why nothing was learned.
    pub failure: Option<String>,
    /// The model's file in the run's folder.
    pub model: Option<String>,
}

/// Error of free runs over the validation part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LearnValidation {
    /// Root mean square error, in the position's unit.
    pub free_run_rmse: f64,
    /// The same over the sensor's noise.
    pub over_noise: f64,
}

/// Part that a method plays in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LearnKind {
    /// Learns from the records.
    Learner,
    /// Knows nothing, or what a simulator knows.
    Baseline,
    /// A learner's model without what it learned, or given noise: identifiers end in `:at-zero` and `:on-noise`.
    Ablation,
    /// The true law, fitted: what nobody can do better.
    Reference,
}

impl LearnKind {
    /// The name as files and tables write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Learner => "learner",
            Self::Baseline => "baseline",
            Self::Ablation => "ablation",
            Self::Reference => "reference",
        }
    }
}

/// End of a training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LearnEnd {
    /// Nothing was learned.
    Failed,
    /// The state that the training reached.
    #[serde(untagged)]
    Trained(Reached),
}

impl LearnEnd {
    /// The name as files and tables write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Trained(reached) => reached.name(),
        }
    }
}

/// Scores on records never seen. Errors that are not finite are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnTest {
    /// Root mean square error of the free run.
    pub free_run_rmse: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// The same over the sensor's noise.
    pub over_noise: Option<f64>,
    /// Median time until the error passes three times the noise, in seconds.
    pub horizon_s: f64,
    /// Root mean square error one sample ahead.
    pub one_step_rmse: Option<f64>,
    /// Share of observations within the stated 95 % band.
    pub coverage_95: Option<f64>,
}

/// A coefficient of a learned law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnCoefficient {
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// 95 % interval, where one is stated.
    pub interval_95: Option<[f64; 2]>,
    /// Share of an ensemble that has the term.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inclusion: Option<f64>,
    /// True value, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<f64>,
}

/// One row of `predictions.csv` of a learning study: a sample of the first test stretch of a problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnSeriesRow {
    /// Name of the problem.
    pub problem: String,
    /// Identifier of the method.
    pub method: String,
    /// Name of the test stretch.
    pub record: String,
    /// Time, in seconds.
    pub time_s: f64,
    /// Observed position.
    pub observed: f64,
    /// Predicted position.
    pub predicted: f64,
    /// Stated standard deviation of the observation about it.
    pub std: Option<f64>,
}

/// One row of `series.csv` of a learning study: a learned torque beside the true one at a visited state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnTorqueRow {
    /// Name of the problem.
    pub problem: String,
    /// Identifier of the method.
    pub method: String,
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Input.
    pub input: f64,
    /// True acceleration.
    pub truth: f64,
    /// Learned acceleration.
    pub learned: f64,
    /// Its stated standard deviation.
    pub std: Option<f64>,
}

/// One row of `trace.csv` of a learning study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnTraceRow {
    /// Name of the problem.
    pub problem: String,
    /// Identifier of the method.
    pub method: String,
    /// Steps so far.
    pub step: u64,
    /// Part of the training.
    pub phase: String,
    /// Root mean square residual of the training part.
    pub train: f64,
    /// Free-run error on the validation part.
    pub validation: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::{LearnEnd, Reached};

    #[test]
    fn the_end_of_a_training_is_one_word() {
        for end in Reached::ALL.map(LearnEnd::Trained).into_iter().chain([LearnEnd::Failed]) {
            let written = serde_json::to_string(&end).unwrap();
            assert_eq!(written, format!("\"{}\"", end.name()));
            assert_eq!(serde_json::from_str::<LearnEnd>(&written).unwrap(), end);
        }
        assert!(serde_json::from_str::<LearnEnd>("\"lost\"").is_err());
    }
}
