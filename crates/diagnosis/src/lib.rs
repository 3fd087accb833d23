//! Diagnosis of the gap between records and a nominal simulator: the place of the gap, the unmodeled effects
//! that cause it, and how far it shrinks once these effects are added.
//!
//! The diagnosis is blind by construction: its only inputs are [`Observations`] (times by a believed clock,
//! values, input) and the nominal simulator. It has no access to the source of a record. [`diagnose`] returns
//! a [`Diagnosis`].
//!
//! # Method
//! 1. Records are cut into segments of about six periods, each with its own start state (`data`).
//! 2. The nominal simulator is fitted as it is, and recalibrated (`fit`).
//! 3. The first-order effect of every candidate on the observed values, at many shapes, is projected on what
//!    calibration and start states cannot imitate (`model`). The largest gain by chance is estimated from
//!    random draws (`search::null`).
//! 4. Sets of a few candidates are searched and fitted in full (`search`), scored by tempered evidence, and
//!    tested on held-out segments. A free latent torque shows what is left without a name (`evidence`).
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
