//! Scores of models on records they never saw.

mod score;
mod truth;

pub use score::{Run, Score, runs, score, validation_error};
pub use truth::{CoefficientError, Truth};
