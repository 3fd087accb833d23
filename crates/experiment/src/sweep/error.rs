//! Errors in a sweep that are found before its first run.

use super::MOST_RUNS;
use settings::SettingsError;
use thiserror::Error;

/// Reason why a sweep cannot be planned.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SweepError {
    /// An argument without a key or without a `=`.
    #[error("command line: `{argument}` is no axis; write KEY=V1,V2 or KEY=A..B, for example seed=0..9")]
    NoAxis {
        /// The argument as given.
        argument: String,
    },
    /// Nothing between two commas.
    #[error("command line: `{argument}`: a value is empty; write KEY=V1,V2 without a comma at either end")]
    EmptyValue {
        /// The argument as given.
        argument: String,
    },
    /// A bracket, brace or quote that is not closed.
    #[error(
        "command line: `{argument}`: a bracket or quote is not closed; values with commas need both, as [32,32]"
    )]
    Unclosed {
        /// The argument as given.
        argument: String,
    },
    /// A range that is empty or whose endpoints are not whole numbers.
    #[error("command line: `{argument}`: `{range}`: {problem}")]
    BadRange {
        /// The argument as given.
        argument: String,
        /// The range within the argument.
        range: String,
        /// Fault of the range and its remedy.
        problem: &'static str,
    },
    /// Two axes with the same key.
    #[error("command line: `{key}` is given twice; give all its values at once, as {key}=V1,V2")]
    RepeatedKey {
        /// The key.
        key: String,
    },
    /// More combinations than a sweep may have.
    #[error("the axes make {runs} runs, and a sweep has {MOST_RUNS} at most; split it into several sweeps")]
    TooManyRuns {
        /// Number of runs that the axes would make.
        runs: u128,
    },
    /// A search that asks for more points than its space has.
    #[error(
        "what is searched has only about {points} different points; ask for fewer with --trials, or widen a range"
    )]
    UsedUp {
        /// Number of points found.
        points: usize,
    },
    /// A combination that does not resolve to a valid configuration.
    #[error("combination {number} ({overrides}): {source}")]
    BadCombination {
        /// Number of the combination, from 1.
        number: usize,
        /// Overrides of the combination.
        overrides: String,
        /// Error of the configuration.
        source: SettingsError,
    },
    /// A combination whose task does not give a single table row.
    #[error(
        "combination {number} ({overrides}): task = \"{task}\" cannot be swept; a sweep is over \"estimate\", \"compare\" or \"learn\""
    )]
    Task {
        /// Number of the combination, from 1.
        number: usize,
        /// Overrides of the combination.
        overrides: String,
        /// The task.
        task: String,
    },
    /// Two combinations with equal values in force.
    #[error(
        "combinations {first} ({overrides}) and {second} are the same experiment, every value equal; write each value once"
    )]
    Repeated {
        /// Number of the first combination, from 1.
        first: usize,
        /// Overrides of the first combination.
        overrides: String,
        /// Number of the second combination, from 1.
        second: usize,
    },
    /// A share that is not of the form `I/N`.
    #[error("--shard {found}: expected I/N with I from 1 to N, N up to 10000, for example 2/8")]
    BadShard {
        /// The text as given.
        found: String,
    },
}
