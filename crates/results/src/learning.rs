//! Results of `task = "learn"`: learners and baselines on records they never saw.

use crate::method::Reached;
use record::Origin;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The content of a learning study's `result.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnResult {
    /// Always [`crate::RESULT_SCHEMA`].
    pub schema: String,
    /// Task of the run: `"learn"`.
    pub task: String,
    /// Root seed of all random draws.
    pub seed: u64,
    /// Number of records in all problems together, and number of stretches in each part.
    pub data: LearnData,
    /// Problems, in the order of the configuration.
    pub problems: Vec<LearnProblem>,
    /// One row for each problem and method: problems in their order, within a problem the smallest error
    /// first and ablations of learners last.
    pub results: Vec<LearnRow>,
    /// Wall time of all fits, in seconds.
    pub seconds: f64,
}

/// Sizes of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LearnData {
    /// Number of records.
    pub records: usize,
    /// Number of stretches used for training.
    pub train: usize,
    /// Number of stretches used to choose among models.
    pub validation: usize,
    /// Number of stretches used to score models.
    pub test: usize,
}

/// A data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnProblem {
    /// Name in the configuration.
    pub id: String,
    /// Title in words.
    pub title: String,
    /// Origin of the data set's numbers.
    pub origin: Origin,
    /// Reason why the data set is missing and the remaining fields are empty; `None` if it is available.
    pub absent: Option<String>,
    /// Unit of the positions.
    pub unit: String,
    /// Sizes of the data set.
    pub data: LearnData,
    /// Number of samples used for training.
    pub training_samples: usize,
    /// Samples per second.
    pub rate_hz: f64,
    /// Typical period, in seconds.
    pub period_s: f64,
    /// Length of the past that a prediction starts from, in seconds.
    pub warm_up_s: f64,
    /// Standard deviation of the sensor noise.
    pub noise: f64,
    /// Mean length of a test stretch after its warm-up, in seconds.
    pub test_s: f64,
    /// Stated test parts, with what others published for them; empty for records that are split.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<LearnPart>,
    /// Course of the input between its samples: `"zero"` (held constant), `"linear"` or `"band-limited"`; `None`
    /// without an input.
    #[serde(default)]
    pub input_hold: Option<String>,
    /// Records with missing cells and the treatment of these cells, as sentences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
}

impl LearnProblem {
    /// Returns the course of the input between its samples in words, or `None` without an input.
    #[must_use]
    pub fn input_between_samples(&self) -> Option<&'static str> {
        let hold = self.input_hold.as_deref()?;
        Some(match hold {
            "linear" => "straight to the next",
            "band-limited" => "a smooth curve",
            _ => "kept",
        })
    }
}

/// Stated test part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnPart {
    /// Name in the configuration.
    pub id: String,
    /// Number of samples, those of the warm-up included.
    pub samples: usize,
    /// Errors that others published, as the configuration states them.
    pub published: Vec<LearnPublished>,
}

/// Error of a method that others published.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnPublished {
    /// Name of the method.
    pub name: String,
    /// Root mean square error of the free run, in the unit of the position.
    pub free_run_rmse: f64,
}

/// Error on one stated test part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnPartError {
    /// Name of the part.
    pub part: String,
    /// Root mean square error of the free run, in the unit of the position; `None` if it failed.
    pub free_run_rmse: Option<f64>,
}

/// Result of one method on one data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnRow {
    /// Name of the problem.
    pub problem: String,
    /// Identifier of the learner or baseline.
    pub id: String,
    /// Name in words.
    pub title: String,
    /// Role of the method in the table.
    pub kind: LearnKind,
    /// Scores on the test part; `None` if nothing was learned.
    pub test: Option<LearnTest>,
    /// Error on the validation part, by which settings may be chosen; for a training that was stopped, the
    /// smallest so far.
    #[serde(default)]
    pub validation: Option<LearnValidation>,
    /// Errors with each of several seeds, this row's own first; empty if the method was trained with one seed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub draws: Vec<LearnDraw>,
    /// Coefficients of the learned law by name; `None` if the model is not a law.
    pub coefficients: Option<BTreeMap<String, LearnCoefficient>>,
    /// Learned law as text.
    pub equation: Option<String>,
    /// Root mean square error of the learned torque, relative to the torque that the nominal simulator lacks;
    /// `None` if the truth is not known or the model has no torque.
    pub torque_error: Option<f64>,
    /// Number of trained parameters.
    pub parameters: usize,
    /// Wall time of the training, in seconds.
    pub seconds: f64,
    /// State in which the training ended.
    pub reached: LearnEnd,
    /// Reason why nothing was learned.
    pub failure: Option<String>,
    /// Name of the model's file in the run's folder.
    pub model: Option<String>,
}

/// Errors of a method trained with one of several seeds. Errors that are not finite are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnDraw {
    /// The seed.
    pub seed: u64,
    /// Root mean square error of the free run over all test parts.
    pub free_run_rmse: Option<f64>,
    /// Root mean square error of free runs over the validation part.
    pub validation_rmse: Option<f64>,
    /// Errors on the stated test parts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<LearnPartError>,
}

impl LearnRow {
    /// Returns the smallest error, the median and the largest one over the seeds; `None` for a single seed. An error
    /// that is not finite counts as the largest.
    #[must_use]
    pub fn range(&self, of: impl Fn(&LearnDraw) -> Option<f64>) -> Option<[f64; 3]> {
        let mut all: Vec<f64> = self.draws.iter().map(|draw| of(draw).unwrap_or(f64::INFINITY)).collect();
        all.sort_by(f64::total_cmp);
        let last = all.len().checked_sub(1)?;
        let median = 0.5 * (all.get(last / 2)? + all.get(all.len() / 2)?);
        Some([*all.first()?, median, *all.last()?])
    }

    /// Returns "median (smallest to largest)" of the errors over the seeds; `None` for a single seed.
    #[must_use]
    pub fn range_stated(
        &self,
        of: impl Fn(&LearnDraw) -> Option<f64>,
        stated: impl Fn(f64) -> String,
    ) -> Option<String> {
        let [least, median, most] = self.range(of)?.map(stated);
        Some(format!("{median} ({least} to {most})"))
    }
}

impl LearnDraw {
    /// Returns the error on a stated test part.
    #[must_use]
    pub fn on(&self, part: &str) -> Option<f64> {
        self.parts.iter().find(|own| own.part == part)?.free_run_rmse
    }
}

/// Error of free runs over the validation part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LearnValidation {
    /// Root mean square error, in the unit of the position.
    pub free_run_rmse: f64,
    /// That error over the sensor noise.
    pub over_noise: f64,
}

/// Role of a method in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LearnKind {
    /// Method that learns from the records.
    Learner,
    /// Method that knows nothing, or only what a simulator knows.
    Baseline,
    /// A learner's model with the learned part removed or fed with noise; its identifier ends in `:at-zero`
    /// or `:on-noise`.
    Ablation,
    /// The true law, fitted: no method can do better.
    Reference,
}

impl LearnKind {
    /// Returns the name used in files and tables.
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

/// State in which a training ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LearnEnd {
    /// Nothing was learned.
    Failed,
    /// State that the training reached.
    #[serde(untagged)]
    Trained(Reached),
}

impl LearnEnd {
    /// Returns the name used in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Trained(reached) => reached.name(),
        }
    }
}

/// Scores on records that were not used for training. Errors that are not finite are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnTest {
    /// Root mean square error of the free run.
    pub free_run_rmse: Option<f64>,
    /// Unit of the errors.
    pub unit: String,
    /// Free-run error over the sensor noise.
    pub over_noise: Option<f64>,
    /// Median time until the error exceeds three times the noise, in seconds.
    pub horizon_s: f64,
    /// Root mean square error of predictions one sample ahead.
    pub one_step_rmse: Option<f64>,
    /// Share of observations inside the stated 95 % band.
    pub coverage_95: Option<f64>,
    /// Errors on the stated test parts; empty for records that are split.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<LearnPartError>,
}

/// A coefficient of a learned law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnCoefficient {
    /// Value of the coefficient.
    pub value: f64,
    /// Unit of the coefficient.
    pub unit: String,
    /// 95 % interval, if one is stated.
    pub interval_95: Option<[f64; 2]>,
    /// Share of the ensemble's members that have the term, if there is an ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inclusion: Option<f64>,
    /// True value, if it is known.
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
    /// Stated standard deviation of the observation around the prediction.
    pub std: Option<f64>,
}

/// One row of `series.csv` of a learning study: the learned and the true torque at a visited state.
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
    /// Stated standard deviation of the learned acceleration.
    pub std: Option<f64>,
}

/// One row of `trace.csv` of a learning study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnTraceRow {
    /// Name of the problem.
    pub problem: String,
    /// Identifier of the method.
    pub method: String,
    /// Number of training steps so far.
    pub step: u64,
    /// Phase of the training.
    pub phase: String,
    /// Root mean square residual on the training part.
    pub train: f64,
    /// Free-run error on the validation part.
    pub validation: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::{LearnDraw, LearnEnd, LearnKind, LearnRow, Reached};

    #[test]
    fn a_range_over_seeds_counts_a_failure_as_the_largest_error() {
        let draw =
            |seed, free_run_rmse| LearnDraw { seed, free_run_rmse, validation_rmse: None, parts: Vec::new() };
        let mut row = LearnRow {
            problem: "swing".to_owned(),
            id: "lstm".to_owned(),
            title: "LSTM".to_owned(),
            kind: LearnKind::Learner,
            test: None,
            validation: None,
            draws: Vec::new(),
            coefficients: None,
            equation: None,
            torque_error: None,
            parameters: 0,
            seconds: 0.0,
            reached: LearnEnd::Failed,
            failure: None,
            model: None,
        };
        assert_eq!(row.range(|draw| draw.free_run_rmse), None);
        row.draws = vec![draw(0, Some(3.0)), draw(1, Some(1.0)), draw(2, None), draw(3, Some(2.0))];
        assert_eq!(row.range(|draw| draw.free_run_rmse), Some([1.0, 2.5, f64::INFINITY]));
    }

    #[test]
    fn the_end_of_a_training_is_one_word() {
        for end in Reached::ALL.map(LearnEnd::Trained).into_iter().chain([LearnEnd::Failed]) {
            let written = serde_json::to_string(&end).unwrap();
            assert_eq!(written, format!("\"{}\"", end.name()));
            assert_eq!(serde_json::from_str::<LearnEnd>(&written).unwrap(), end);
        }
        let refused = serde_json::from_str::<LearnEnd>("\"lost\"").unwrap_err().to_string();
        assert!(refused.contains("did not match any variant"), "{refused}");
    }
}
