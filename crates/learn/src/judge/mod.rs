//! Scores of models on unseen records.

mod score;
mod truth;

pub use score::{Run, Score, run_error, runs, runs_on_noise, score, score_of_runs, validation_error};
pub(crate) use score::{root_mean, validation_squares};
pub use truth::{CoefficientError, Truth};
