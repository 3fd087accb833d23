//! Reasons why nothing can be learned.

use crate::data::counted;
use dynamics::DynamicsError;
use thiserror::Error;

/// Why a data set is refused, or why a learner or model gave no answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LearnError {
    /// No record at all.
    #[error("there is no record to learn from; name at least two, or one that is split by time")]
    NoRecords,
    /// A single record that would have to be split by record.
    #[error(
        "{record} is the only record, so that none is left to test on; give more records, or split it by time with \
         split = \"time\""
    )]
    OneRecord {
        /// Its name.
        record: String,
    },
    /// Too few records for three parts.
    #[error(
        "{records} records and test_records = {test}, validation_records = {validation} leave none to train on; lower \
         them, or give more records"
    )]
    NoTraining {
        /// Records in all.
        records: usize,
        /// Records to test on.
        test: usize,
        /// Records to validate on.
        validation: usize,
    },
    /// No test part.
    #[error("no record is left to test on: what was learned cannot be judged; set test_records to 1 or more")]
    NoTest,
    /// A column that some records have and others do not.
    #[error(
        "{without} has no input column, {with} has one; name the column with `input`, or leave out the records of the \
         other kind"
    )]
    MissingInput {
        /// A record without.
        without: String,
        /// A record with.
        with: String,
    },
    /// A number that is not finite.
    #[error(
        "{record}: {column} is {value} at sample {sample}; mend the file, or drop the row with missing = \"drop\""
    )]
    NotFinite {
        /// The record.
        record: String,
        /// What the number is.
        column: &'static str,
        /// Which it is.
        value: f64,
        /// Place, counted from 1.
        sample: usize,
    },
    /// A time that does not come after the one before.
    #[error(
        "{record}: time {time} s at sample {sample} does not come after {before} s; choose another clock"
    )]
    TimeStands {
        /// The record.
        record: String,
        /// The time.
        time: f64,
        /// Its predecessor.
        before: f64,
        /// Place, counted from 1.
        sample: usize,
    },
    /// Columns of different lengths.
    #[error("{record}: {times} times, but {found} of {column}; every time needs one")]
    UnequalColumns {
        /// The record.
        record: String,
        /// The column.
        column: &'static str,
        /// Its length.
        found: usize,
        /// Number of times.
        times: usize,
    },
    /// Records sampled at different rates.
    #[error(
        "{slow} is sampled at {slow_hz:.4} Hz, {fast} at {fast_hz:.4} Hz; a set needs one rate, within 5 %: give each \
         rate a [problem.NAME] of its own"
    )]
    MixedRates {
        /// Slowest record.
        slow: String,
        /// Its rate.
        slow_hz: f64,
        /// Fastest record.
        fast: String,
        /// Its rate.
        fast_hz: f64,
    },
    /// Records in different units.
    #[error(
        "{first} is in {first_unit}, {other} in {other_unit}; a set needs one unit: state it with `unit`"
    )]
    MixedUnits {
        /// A record.
        first: String,
        /// Its unit.
        first_unit: String,
        /// Another.
        other: String,
        /// Its unit.
        other_unit: String,
    },
    /// A part with too few samples to learn from or to test on.
    #[error(
        "{record}: {} are too few for a part of its own; {needed} are needed (three warm-ups of {warm_up_s:.3} s); lower \
         warm_up_s, or take a longer part", counted(*samples, "sample")
    )]
    TooShort {
        /// The record.
        record: String,
        /// Samples there are.
        samples: usize,
        /// Samples needed.
        needed: usize,
        /// Length of a warm-up.
        warm_up_s: f64,
    },
    /// A past that a model cannot start from.
    #[error(
        "the past is too short: {samples} of the {needed} samples that the model starts from ({needed_s:.3} s); give it \
         more of the record, in `trainer predict` with --past"
    )]
    ShortPast {
        /// Samples there are, at the model's own interval.
        samples: usize,
        /// Samples needed.
        needed: usize,
        /// Their length.
        needed_s: f64,
    },
    /// Records of something else than a position.
    #[error("{record} observes a {quantity}; models are learned from positions")]
    NoPosition {
        /// The record.
        record: String,
        /// What it observes.
        quantity: &'static str,
    },
    /// A motion that never crosses its mean.
    #[error(
        "no period can be read from the training records: fewer than three crossings of the mean; set period_s"
    )]
    NoPeriod,
    /// A baseline that needs a simulator.
    #[error("{what} needs a nominal simulator; name one with nominal = \"nominal.toml\"")]
    NoNominal {
        /// The baseline or learner.
        what: &'static str,
    },
    /// A prediction that ran away.
    #[error("the prediction runs away: |position| passes {bound:.3e} after {time_s:.3} s")]
    Diverged {
        /// Time since the window's start.
        time_s: f64,
        /// The bound.
        bound: f64,
    },
    /// A fit without a solution.
    #[error("{what}: {problem}")]
    Unsolvable {
        /// The learner or step.
        what: &'static str,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A simulator that could not run.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A tensor library that gave no answer.
    #[error(transparent)]
    Backend(#[from] estimator::FitError),
    /// A diagnosis that was refused.
    #[error("diagnosis: {0}")]
    Diagnosis(String),
    /// A file that holds no model of this program.
    #[error("{problem}; expected a model that `task = \"learn\"` wrote below model/")]
    Stored {
        /// What is wrong.
        problem: String,
    },
    /// A request to stop.
    #[error("interrupted before it was done")]
    Interrupted,
}
