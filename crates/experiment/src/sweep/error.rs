//! What can be wrong with a sweep before its first run.

use super::MOST_RUNS;
use settings::SettingsError;
use thiserror::Error;

/// Why a sweep cannot be planned.
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
    /// A bracket, brace or quote without its other half.
    #[error(
        "command line: `{argument}`: a bracket or quote is not closed; values with commas need both, as [32,32]"
    )]
    Unclosed {
        /// The argument as given.
        argument: String,
    },
    /// A range of something else than whole numbers, or an empty one.
    #[error("command line: `{argument}`: `{range}`: {problem}")]
    BadRange {
        /// The argument as given.
        argument: String,
        /// The range in it.
        range: String,
        /// What is wrong with it, and what to do.
        problem: &'static str,
    },
    /// Two axes with one key.
    #[error("command line: `{key}` is given twice; give all its values at once, as {key}=V1,V2")]
    RepeatedKey {
        /// The key.
        key: String,
    },
    /// More combinations than a sweep may have.
    #[error("the axes make {runs} runs, and a sweep has {MOST_RUNS} at most; split it into several sweeps")]
    TooManyRuns {
        /// How many there would be.
        runs: u128,
    },
    /// A search that asks for more points than there are.
    #[error(
        "what is searched has only about {points} different points; ask for fewer with --trials, or widen a range"
    )]
    UsedUp {
        /// Points that were found.
        points: usize,
    },
    /// A combination that no run can be made of.
    #[error("combination {number} ({overrides}): {source}")]
    BadCombination {
        /// Its number, from 1.
        number: usize,
        /// Its overrides.
        overrides: String,
        /// What is wrong.
        source: SettingsError,
    },
    /// A combination whose task makes no single table row.
    #[error(
        "combination {number} ({overrides}): task = \"{task}\" cannot be swept; a sweep is over \"estimate\", \"compare\" or \"learn\""
    )]
    Task {
        /// Its number, from 1.
        number: usize,
        /// Its overrides.
        overrides: String,
        /// The task.
        task: String,
    },
    /// Two combinations with the same values in force.
    #[error(
        "combinations {first} ({overrides}) and {second} are the same experiment, every value equal; write each value once"
    )]
    Repeated {
        /// Number of the first, from 1.
        first: usize,
        /// Its overrides.
        overrides: String,
        /// Number of the second.
        second: usize,
    },
    /// A share that is none.
    #[error("--shard {found}: expected I/N with I from 1 to N, N up to 10000, for example 2/8")]
    BadShard {
        /// As given.
        found: String,
    },
}
