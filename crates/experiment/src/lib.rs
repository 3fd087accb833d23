//! The configuration of an experiment: schema, overrides, checks.
//!
//! Pure: text in, checked settings out. What an estimator's section may hold comes from the registry's
//! entry that is handed in; this crate knows no estimator.

mod experiment;
mod prediction;
mod schema;

pub use experiment::{
    CheckpointSettings, Comparison, DataSettings, EnvelopeSettings, Experiment, FitSettings, Pipeline,
    Single, Task, resolve,
};
pub use prediction::{
    Law, PredictionSettings, PredictionStudy, Problem, ProblemSource, ScatterKind, SimulatedProblem,
    is_prediction, resolve_prediction,
};
pub use schema::{COMPARE, SECTIONS, estimator_name_field};
