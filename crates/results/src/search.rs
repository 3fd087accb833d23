//! Search over settings: choice of its points, measure by which they are judged, and result.

use serde::{Deserialize, Serialize};

/// Method by which a sweep chooses its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SweepSampler {
    /// All combinations of the axes.
    Grid,
    /// Independent draws.
    Random,
    /// Draws near the best results so far, by tree-structured Parzen estimators.
    Tpe,
}

impl SweepSampler {
    /// Returns the name used in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Random => "random",
            Self::Tpe => "tpe",
        }
    }

    /// Returns `true` if the sampler proposes points from the results of earlier points.
    #[must_use]
    pub fn looks_at_results(self) -> bool {
        self == Self::Tpe
    }
}

/// Search settings of a sweep: a part of its manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepSearch {
    /// Sampler that chooses the points.
    pub sampler: SweepSampler,
    /// Total number of points.
    pub trials: usize,
    /// Number of points proposed at once. A sampler that uses results proposes all of them from the results
    /// of earlier batches.
    pub batch: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Dotted path of the measure: a number in the runs' `result.json`.
    pub measure: String,
    /// `true` if larger values of the measure are better.
    pub maximize: bool,
    /// Early stopping of the worse trials; `None` if it is off.
    pub halving: Option<SweepHalving>,
}

/// Successive halving: every trial trains for some steps, then only the best continue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepHalving {
    /// Number of trace steps after which the first rung stops.
    pub first_steps: u64,
    /// Reduction factor: one in this many trials continues to the next rung, which is this many times as
    /// long.
    pub keep_one_in: usize,
    /// Finished rungs, in order.
    pub rungs: Vec<SweepRung>,
}

/// A finished rung.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepRung {
    /// Number of trace steps after which the rung stopped; `None` if trials ran to their end.
    pub steps: Option<u64>,
    /// Measure of each trial on the rung.
    pub values: Vec<SweepRungValue>,
}

/// Value of the measure that a trial reached on a rung.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SweepRungValue {
    /// Number of the trial.
    pub number: usize,
    /// Value of the measure; `None` if the trial failed.
    pub value: Option<f64>,
}

/// Result of a search: a part of its table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchOutcome {
    /// Sampler that chose the points, as [`SweepSearch::sampler`].
    pub sampler: SweepSampler,
    /// Measure by which trials are judged, as [`SweepSearch::measure`].
    pub measure: String,
    /// Direction of the search, as [`SweepSearch::maximize`].
    pub maximize: bool,
    /// Number of points requested.
    pub trials: usize,
    /// Number of trials with a value of the measure at their end.
    pub measured: usize,
    /// Number of trials stopped early.
    pub stopped: usize,
    /// Number of failed trials, which count as the worst.
    pub failed: usize,
    /// Best of the measured trials; `None` if no trial was measured.
    pub best: Option<SearchBest>,
    /// Warning about the choice of the measure, for the reader.
    pub warning: Option<String>,
}

/// The best trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchBest {
    /// Number of the trial.
    pub number: usize,
    /// Folder of the trial's run, relative to the sweep's folder.
    pub run: String,
    /// Value of the measure.
    pub value: f64,
    /// Overrides of the configuration, as `key=value`.
    pub overrides: Vec<String>,
    /// Path of the trial's configuration, relative to the sweep's folder; it can be run as it is.
    pub config: String,
}

/// Formats a value with at most six significant digits, for a sentence; a small one with a power of ten.
fn rounded(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let is_small = rounded != 0.0 && rounded.abs() < 1e-4;
    if is_small { format!("{rounded:e}") } else { rounded.to_string() }
}

impl SearchOutcome {
    /// Returns the outcome in one or a few sentences.
    #[must_use]
    pub fn sentence(&self) -> String {
        let direction = if self.maximize { "largest" } else { "least" };
        let mut words = match &self.best {
            Some(best) => format!(
                "Best of {} finished trials, by the {direction} {}: trial {:04} with {} ({}); {} runs it again.",
                self.measured,
                self.measure,
                best.number,
                rounded(best.value),
                best.overrides.join(" "),
                best.config,
            ),
            None => format!("No trial has a value of {} yet.", self.measure),
        };
        if self.stopped > 0 {
            words.push_str(&format!(" {} trials were stopped early.", self.stopped));
        }
        if self.failed > 0 {
            words.push_str(&format!(" {} trials failed and count as the worst.", self.failed));
        }
        if let Some(warning) = &self.warning {
            words.push(' ');
            words.push_str(warning);
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn a_value_has_six_digits_and_no_row_of_zeros() {
        assert_eq!(
            [1.014_961_8, 0.0, 2.5, 3.927_593_2e-8].map(rounded),
            ["1.01496", "0", "2.5", "3.92759e-8"]
        );
    }
}
