//! Where the gap between a record and a nominal simulator lies, which unmodeled effect causes it, and how far it
//! shrinks once that effect is added.
//!
//! Blind by construction: all that goes in is [`Observations`] (times by a believed clock, values, input) and
//! the nominal simulator; what made the record cannot be reached from here. [`diagnose`] gives a
//! [`Diagnosis`].
//!
//! # How
//! 1. Records are cut into segments of about six periods, each with a start state of its own (`data`).
//! 2. The nominal simulator is fitted as it is and recalibrated (`fit`).
//! 3. Every candidate's first-order effect on the observed values, at many shapes, is projected on what calibration and start
//!    states cannot imitate (`model`); what the best of them gains by chance is drawn (`search::null`).
//! 4. Sets of a few are searched and fitted in full (`search`), scored by tempered evidence, and have to predict held-out
//!    segments; a free latent torque says what is left without a name (`evidence`).
//! 5. Shares, maps, rivals and the next experiment follow (`explain`).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod answer;
mod data;
mod diagnose;
mod error;
mod evidence;
mod explain;
mod fit;
#[cfg(test)]
mod fixtures;
mod measurement;
mod model;
mod noise;
#[cfg(test)]
#[allow(clippy::print_stdout, reason = "what a trial finds is read, not only checked")]
mod repaired_tests;
mod search;
mod settings;
mod stages;
#[cfg(test)]
#[allow(clippy::print_stdout, reason = "what a trial finds is read, not only checked")]
mod trials;

pub use answer::{
    Budget, Calibrated, Cell, ClassEvidence, Detectability, Diagnosis, EffectClass, EffectProbability,
    Experiment, Finding, Gap, Interval, Kind, KnownRow, LeftOver, MeasuringChain, ParameterEstimate,
    RepairedSimulator, Rivalry, Series, SetScore, Stage, Status, Undetermined, Verdict, Where,
};
pub use data::observations::Observations;
pub use diagnose::{diagnose, diagnose_watched};
pub use error::DiagnosisError;
pub use evidence::weights::DISTINCT_DISTANCE;
pub use explain::backbone::{SurfaceCell, Swing, backbone, surface};
pub use explain::repaired::rounded;
pub use explain::single_effect::single_effect;
pub use model::vocabulary::{evidence_class, has_fitted_hidden_start, is_flexible};
pub use noise::floor::NoiseFloor;
pub use settings::Settings;
