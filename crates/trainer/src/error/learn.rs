//! Errors of learning studies and learned models.

use ::learn::LearnError;
use thiserror::Error;

/// Fault in a learning study or a learned model, with its place.
#[derive(Debug, Error)]
pub(crate) enum LearnCommandError {
    #[error("problem.{problem}: {source}")]
    Data { problem: String, source: LearnError },
    #[error("problem.{problem}: the name `{pattern}` in records is not a pattern: {reason}")]
    Pattern { problem: String, pattern: String, reason: String },
    #[error(
        "problem.{problem}: no file in {folder} is called {pattern}; check records, or leave the problem out"
    )]
    NoFile { problem: String, folder: String, pattern: String },
    #[error(
        "problem.{problem}.part.{part}: rows {from} to {to} are not all in {file}, which has {samples}; correct from_row \
         and to_row, which count from 0"
    )]
    Rows { problem: String, part: String, file: String, samples: usize, from: usize, to: usize },
    #[error(
        "problem.{problem}: {file}: {reason}; name the configuration of a simulation, as configs/simulate.toml is"
    )]
    Simulation { problem: String, file: String, reason: String },
    #[error("{file}: {source}")]
    Model { file: String, source: LearnError },
    #[error("{file}: cannot be read: {reason}; expected a model that `task = \"learn\"` wrote below model/")]
    ModelFile { file: String, reason: String },
    #[error("{file}: the learner `{learner}` is not known here; known are {known}")]
    UnknownLearner { file: String, learner: String, known: String },
    #[error("{record}: {source}")]
    Record { record: String, source: LearnError },
    #[error(
        "{record}: {samples} samples after a past of {past_s:.3} s leave nothing to predict; give a longer record, or a \
         shorter --past"
    )]
    NothingAhead { record: String, samples: usize, past_s: f64 },
    #[error(
        "{record}: the model was learned {with} an input, and the record is {without} one; name its column with --input"
    )]
    Input { record: String, with: &'static str, without: &'static str },
}
