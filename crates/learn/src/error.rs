//! Errors of learning.

use crate::data::counted;
use dynamics::DynamicsError;
use thiserror::Error;

/// Reason why a data set is refused, or why a learner or model gave no answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LearnError {
    /// No stretch is stated for a use.
    #[error(
        "there is no {part} part; state one with use = \"{part}\" in a section problem.NAME.part.PART, or split \
         records without such sections"
    )]
    NoPart {
        /// `"training"`, `"validation"` or `"test"`.
        part: &'static str,
    },
    /// There is no record.
    #[error("there is no record to learn from; name at least two, or one that is split by time")]
    NoRecords,
    /// A single record cannot be split by record.
    #[error(
        "{record} is the only record, so that none is left to test on; give more records, or split it by time with \
         split = \"time\""
    )]
    OneRecord {
        /// Name of the record.
        record: String,
    },
    /// There are too few records for three parts.
    #[error(
        "{records} records and test_records = {test}, validation_records = {validation} leave none to train on; lower \
         them, or give more records"
    )]
    NoTraining {
        /// Total number of records.
        records: usize,
        /// Number of test records.
        test: usize,
        /// Number of validation records.
        validation: usize,
    },
    /// There is no test part.
    #[error("no record is left to test on: what was learned cannot be judged; set test_records to 1 or more")]
    NoTest,
    /// Some records have an input and others do not.
    #[error(
        "{without} has no input column, {with} has one; name the column with `input`, or leave out the records of the \
         other kind"
    )]
    MissingInput {
        /// A record without an input.
        without: String,
        /// A record with an input.
        with: String,
    },
    /// A number is not finite.
    #[error(
        "{record}: {column} is {value} at sample {sample}; mend the file, or drop the row with missing = \"drop\""
    )]
    NotFinite {
        /// Name of the record.
        record: String,
        /// Name of the column.
        column: &'static str,
        /// The number.
        value: f64,
        /// Sample, counted from 1.
        sample: usize,
    },
    /// A time does not come after the previous one.
    #[error(
        "{record}: time {time} s at sample {sample} does not come after {before} s; choose another clock"
    )]
    TimeStands {
        /// Name of the record.
        record: String,
        /// The time, in seconds.
        time: f64,
        /// The previous time, in seconds.
        before: f64,
        /// Sample, counted from 1.
        sample: usize,
    },
    /// Columns have different lengths.
    #[error("{record}: {times} times, but {found} of {column}; every time needs one")]
    UnequalColumns {
        /// Name of the record.
        record: String,
        /// Name of the column.
        column: &'static str,
        /// Length of the column.
        found: usize,
        /// Number of times.
        times: usize,
    },
    /// Records are sampled at different rates.
    #[error(
        "{slow} is sampled at {slow_hz:.4} Hz, {fast} at {fast_hz:.4} Hz; a set needs one rate, within 5 %: give each \
         rate a [problem.NAME] of its own"
    )]
    MixedRates {
        /// Slowest record.
        slow: String,
        /// Sample rate of the slowest record.
        slow_hz: f64,
        /// Fastest record.
        fast: String,
        /// Sample rate of the fastest record.
        fast_hz: f64,
    },
    /// Records are in different units.
    #[error(
        "{first} is in {first_unit}, {other} in {other_unit}; a set needs one unit: state it with `unit`"
    )]
    MixedUnits {
        /// Name of one record.
        first: String,
        /// Unit of that record.
        first_unit: String,
        /// Name of another record.
        other: String,
        /// Unit of the other record.
        other_unit: String,
    },
    /// A part has too few samples to learn from or to be scored on.
    #[error(
        "{record}: {} are too few for a part of its own; {needed} are needed (three warm-ups of {warm_up_s:.3} s); lower \
         warm_up_s, or take a longer part", counted(*samples, "sample")
    )]
    TooShort {
        /// Name of the record.
        record: String,
        /// Number of samples of the part.
        samples: usize,
        /// Number of samples needed.
        needed: usize,
        /// Length of the warm-up, in seconds.
        warm_up_s: f64,
    },
    /// The past is too short for the model.
    #[error(
        "the past is too short: {samples} of the {needed} samples that the model starts from ({needed_s:.3} s); give it \
         more of the record, in `trainer predict` with --past"
    )]
    ShortPast {
        /// Number of samples of the past, at the model's own interval.
        samples: usize,
        /// Number of samples needed.
        needed: usize,
        /// Duration of the needed samples, in seconds.
        needed_s: f64,
    },
    /// A record does not observe a position.
    #[error("{record} observes a {quantity}; models are learned from positions")]
    NoPosition {
        /// Name of the record.
        record: String,
        /// Observed quantity.
        quantity: &'static str,
    },
    /// The motion never crosses its mean.
    #[error(
        "no period can be read from the training records: fewer than three crossings of the mean; set period_s"
    )]
    NoPeriod,
    /// A baseline or learner needs a nominal simulator, and there is none.
    #[error("{what} needs a nominal simulator; name one with nominal = \"nominal.toml\"")]
    NoNominal {
        /// Name of the baseline or learner.
        what: &'static str,
    },
    /// A prediction diverged.
    #[error("the prediction runs away: |position| passes {bound:.3e} after {time_s:.3} s")]
    Diverged {
        /// Time since the start of the run, in seconds.
        time_s: f64,
        /// Bound that the position exceeded.
        bound: f64,
    },
    /// A fit has no solution.
    #[error("{what}: {problem}")]
    Unsolvable {
        /// Name of the learner or step.
        what: &'static str,
        /// Fault and remedy.
        problem: String,
    },
    /// A simulator could not run.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// The tensor library failed.
    #[error(transparent)]
    Backend(#[from] estimator::FitError),
    /// The diagnosis refused the records.
    #[error("diagnosis: {0}")]
    Diagnosis(String),
    /// A file holds no model of this program.
    #[error("{problem}; expected a model that `task = \"learn\"` wrote below model/")]
    Stored {
        /// Fault of the file.
        problem: String,
    },
    /// The fit was interrupted by request.
    #[error("interrupted before it was done")]
    Interrupted,
}
