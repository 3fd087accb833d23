//! Estimates how much an oscillator is damped, and diagnoses what a simulator of it lacks.
//!
//! # From a record to a damping ratio
//!
//! ```
//! use ringdown_lab::{EstimateOptions, Reading, Record, estimate};
//!
//! # let log = {
//! #     use ringdown_lab::{Nominal, Simulation};
//! #     Simulation::of(&Nominal::swinging(3.5, 0.009)?).noise(1e-4).run()?.to_csv(6)
//! # };
//! # let bytes = log.as_bytes();
//! let record = Record::parse("log.csv", bytes, &Reading::default())?; // or Record::read("log.csv", …)
//! let found = estimate(&record, "ols", &EstimateOptions::default())?;
//! println!("ζ = {:.5}, {} peaks", found.damping_ratio, found.peaks);
//! assert!((found.damping_ratio / 0.009 - 1.0).abs() < 0.01);
//! # Ok::<(), ringdown_lab::Error>(())
//! ```
//!
//! # From a record and a simulator to a diagnosis
//!
//! [`diagnose`] takes records of one system and a [`Nominal`] simulator, your own or a [`guess`](Nominal::guess), and says where
//! they part, which effects cause it, and how far the gap closes. The [`Diagnosis`] is the content of `diagnosis.json`, the
//! repaired simulator, and a report.
//!
//! # What is simulated
//!
//! [`Simulation`] makes records with any of the [`effects`] that the diagnosis knows, and with those of the measurement chain.
//! Such a record says that it is simulated wherever it is shown.
//!
//! # Estimators of one's own
//!
//! [`contract`] is what an estimator implements; [`estimate_with`] runs one on a record. Every other estimator of the workspace is
//! built on the same contract.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod diagnose;
mod error;
mod estimate;
mod learn;
mod nominal;
mod record;
mod simulate;

pub use crate::learn::{LearnOptions, OwnLearner, learn};
pub use crate::record::{Arrays, Record};
pub use diagnose::{Diagnosis, DiagnosisOptions, diagnose, diagnose_watched};
pub use error::Error;
pub use estimate::{
    Estimate, EstimateOptions, Method, estimate, estimate_until, estimate_with, methods, peaks,
};
pub use nominal::Nominal;
pub use simulate::{Excitation, Simulation, Waveform, simulate};

pub use ::record::{
    ClockChoice, CsvColumns, Filter, Format, Missing, Origin, Quantity, ReadOptions, TimeUnit, Unit,
};
pub use dynamics::{Coefficients, Description};
pub use estimator::Reached;
pub use experiment::Pipeline;
pub use export::Repaired;
pub use results as result;
pub use workflow::Reading;

/// The contract that every estimator of the workspace fulfills: the peaks and the context that it is given, the estimate that it
/// gives.
pub mod contract {
    pub use envelope::{Envelope, Extraction};
    pub use estimator::{
        Cancel, Entry, Estimate, Estimator, FitContext, FitError, Observer, Prediction, Reached, Silent,
        Step, Stop, Tag, Uncertainty,
    };
    pub use seed::Seed;
}

/// Contract of a learner: data sets, models and scores.
pub mod learning {
    pub use estimator::Reached;
    pub use learn::data::{DataSet, Trajectory};
    pub use learn::{Ahead, Context, Fitted, LearnError, Learner, Model, Past, Predicted, Step};
}

/// Every effect that a simulator may lack: equation, parameters with units and ranges, signature, literature.
///
/// ```
/// let drag = ringdown_lab::effects().find(|effect| effect.id == "quadratic_drag").unwrap();
/// assert_eq!(drag.equation, "-β θ′ |θ′|");
/// ```
pub fn effects() -> impl Iterator<Item = &'static Description> {
    dynamics::REGISTRY.iter().map(|effect| effect.description())
}
