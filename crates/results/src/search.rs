//! A search over settings: how its points are chosen, what they are judged by, and what it found.

use serde::{Deserialize, Serialize};

/// How a sweep chooses its points.
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
    /// Its name, as in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Random => "random",
            Self::Tpe => "tpe",
        }
    }

    /// Whether it proposes points from the results of those before them.
    #[must_use]
    pub fn looks_at_results(self) -> bool {
        self == Self::Tpe
    }
}

/// Search of a sweep: a part of its manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepSearch {
    /// Choice of points.
    pub sampler: SweepSampler,
    /// Points in all.
    pub trials: usize,
    /// Points that are proposed at once, all from the results of those before them where the sampler looks at results.
    pub batch: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Dotted path of a number in the runs' `result.json`.
    pub measure: String,
    /// True if more is better.
    pub maximize: bool,
    /// Early stopping of the worse trials, where it was asked for.
    pub halving: Option<SweepHalving>,
}

/// Successive halving: every trial trains for a while, the best of them go on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepHalving {
    /// Steps of the trace after which the first rung stops.
    pub first_steps: u64,
    /// One trial of so many goes on to the next rung, which is so many times as long.
    pub keep_one_in: usize,
    /// The rungs that are done, in their order.
    pub rungs: Vec<SweepRung>,
}

/// A rung that is done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepRung {
    /// Steps of the trace after which it stopped; `None` where trials ran to their end.
    pub steps: Option<u64>,
    /// Measure of each trial on it.
    pub values: Vec<SweepRungValue>,
}

/// Value that a trial had reached on a rung.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SweepRungValue {
    /// Number of the trial.
    pub number: usize,
    /// Its measure; `None` where it failed.
    pub value: Option<f64>,
}

/// Result of a search: a part of its table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchOutcome {
    /// Choice of points, as [`SweepSearch::sampler`].
    pub sampler: SweepSampler,
    /// Measure that trials are judged by, as [`SweepSearch::measure`].
    pub measure: String,
    /// Direction of the search, as [`SweepSearch::maximize`].
    pub maximize: bool,
    /// Points that were asked for.
    pub trials: usize,
    /// Trials with a value of the measure at their end.
    pub measured: usize,
    /// Trials that were stopped early.
    pub stopped: usize,
    /// Trials that failed, which count as the worst.
    pub failed: usize,
    /// The best of the measured.
    pub best: Option<SearchBest>,
    /// Warning to the reader about the choice of measure.
    pub warning: Option<String>,
}

/// The best trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchBest {
    /// Its number.
    pub number: usize,
    /// Its folder, from the sweep's.
    pub run: String,
    /// Its measure.
    pub value: f64,
    /// Overrides of the configuration, as `key=value`.
    pub overrides: Vec<String>,
    /// Its configuration, from the sweep's folder, ready to be run.
    pub config: String,
}

/// Six digits, for a sentence.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

impl SearchOutcome {
    /// The outcome as a sentence or a few.
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
