//! Configuration of an experiment: schema, overrides, checks, sweeps.
//!
//! The crate is pure: it turns text into checked settings. The keys that an estimator's section may hold come
//! from the registry entries that the caller passes; this crate knows no estimator.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod actuator;
mod experiment;
mod json_schema;
#[cfg(not(target_arch = "wasm32"))]
mod learning;
mod nominal;
#[cfg(not(target_arch = "wasm32"))]
mod parts;
mod pipelines;
mod prediction;
mod schema;
#[cfg(not(target_arch = "wasm32"))]
pub mod sweep;

#[cfg(test)]
mod tests;

pub use actuator::{ACTUATOR, ACTUATOR_STATED};
pub use experiment::{
    CheckpointSettings, Claims, Comparison, DataSettings, Experiment, FitSettings, Single, Task, resolve,
};
pub use json_schema::{compare_schema, estimate_schema, predict_schema};
#[cfg(not(target_arch = "wasm32"))]
pub use learning::{
    LearnSettings, LearnSource, LearnStudy, LearningProblem, is_learning, learn_schema, resolve_learning,
};
pub use nominal::{
    KNOWN_EFFECT, NOMINAL, NOMINAL_DECAYS, NOMINAL_SWINGS, Servo, StatedNominal, resolve_nominal,
};
#[cfg(not(target_arch = "wasm32"))]
pub use parts::{PartUse, Published, StatedPart};
pub use pipelines::{EnvelopeSettings, Pipeline};
pub use prediction::{
    Law, PredictionSettings, PredictionStudy, Problem, ProblemSource, ScatterKind, SimulatedProblem,
    is_prediction, resolve_prediction,
};
pub use schema::{COMPARE, SECTIONS, estimator_name_field};
