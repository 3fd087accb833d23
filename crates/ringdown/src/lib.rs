//! Estimates the damping of an oscillator, and diagnoses the gap between a simulator and records of it.
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
//! [`diagnose`] compares records of one system with a [`Nominal`] simulator, your own or a
//! [`guess`](Nominal::guess). It finds the location of the gap, the effects that cause it, and the share of
//! it that they close. A [`Diagnosis`] holds the content of `diagnosis.json`, the repaired simulator, and a
//! report.
//!
//! [`diagnose_robot`] does the same for a [`Robot`] of several joints.
//!
//! # Simulation
//!
//! [`Simulation`] makes records with any of the [`effects`] known to the diagnosis, including those of the
//! measurement chain. Such a record is marked as simulated wherever it is shown.
//!
//! # Custom estimators
//!
//! [`contract`] contains the trait of an estimator; [`estimate_with`] runs a custom one on a record. All
//! estimators of the workspace implement the same contract.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod diagnose;
mod error;
mod estimate;
mod learn;
mod nominal;
mod record;
mod robot;
mod simulate;

pub use crate::learn::{LearnOptions, OwnLearner, learn};
pub use crate::record::{Arrays, Record};
pub use crate::robot::{Joints, JointsOptions, Robot, diagnose_robot};
pub use ::robot::Simulator;
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

/// Contract of an estimator, which every estimator of the workspace implements: its inputs (peaks and
/// context) and its result.
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

/// Returns all effects that a simulator may lack: equation, parameters with units and ranges, signature,
/// literature.
///
/// ```
/// let drag = ringdown_lab::effects().find(|effect| effect.id == "quadratic_drag").unwrap();
/// assert_eq!(drag.equation, "-β θ′ |θ′|");
/// ```
pub fn effects() -> impl Iterator<Item = &'static Description> {
    dynamics::REGISTRY.iter().map(|effect| effect.description())
}
