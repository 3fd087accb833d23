//! Where the gap between a record and a nominal simulator lies, which unmodeled effect causes it, and how far it
//! shrinks once that effect is added.
//!
//! Blind by construction: all that goes in is [`Observations`] (times by a believed clock, values, input) and
//! the nominal simulator; what made the record cannot be reached from here. [`diagnose`] gives a
//! [`Diagnosis`].
//!
//! # How
//! 1. Records are cut into segments of about six periods, each with a start state of its own (`segments`).
//! 2. The nominal simulator is fitted as it is and recalibrated (`calibrate`, `fit`).
//! 3. Every candidate's first-order effect on the observed values, at many shapes, is projected on what calibration and start
//!    states cannot imitate (`tangent`, `dictionary`, `projection`); what the best of them gains by chance is drawn
//!    (`null`).
//! 4. Sets of a few are searched and fitted in full (`search`, `refine`), scored by tempered evidence (`score`), and
//!    have to predict held-out segments (`held_out`).
//! 5. A free latent torque says what is left without a name (`latent`, `verdict`).
//! 6. Shares, maps, rivals and the next experiment follow (`budget`, `maps`, `experiment`).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod answer;
mod budget;
mod calibrate;
mod candidate;
mod chain_statistics;
mod coefficients;
mod conclusion;
mod confidence;
mod contact;
mod determined;
mod diagnose;
mod dictionary;
mod ending;
mod error;
mod experiment;
mod facts;
mod fit;
#[cfg(test)]
mod fixtures;
mod gap;
mod held_out;
mod horizon;
mod hypothesis;
mod latent;
mod maps;
mod matrices;
mod noise;
mod null;
mod observations;
mod outliers;
mod period;
mod pool;
mod portrait;
mod projection;
mod proposal;
mod ratio;
mod reading;
mod refine;
mod release;
mod repaired;
#[cfg(test)]
#[allow(clippy::print_stdout, reason = "what a trial finds is read, not only checked")]
mod repaired_tests;
mod response;
mod rounding;
mod score;
mod search;
mod second_mode;
mod segments;
mod settle;
mod single_effect;
mod spectrum;
mod stand_ins;
mod statistics;
mod tangent;
#[cfg(test)]
#[allow(clippy::print_stdout, reason = "what a trial finds is read, not only checked")]
mod trials;
mod unexplained;
mod unnamed;
mod verdict;
mod work;

pub use answer::{
    Budget, Calibrated, Cell, Detectability, Diagnosis, EffectProbability, Experiment, Finding, Gap,
    Interval, KnownRow, MeasuringChain, ParameterEstimate, RepairedSimulator, Rivalry, Series, SetScore,
    Stage, Status, Undetermined, Verdict, Where,
};
pub use candidate::has_fitted_hidden_start;
pub use conclusion::DISTINCT_DISTANCE;
pub use diagnose::{Settings, diagnose};
pub use error::DiagnosisError;
pub use noise::NoiseFloor;
pub use observations::Observations;
pub use portrait::{SurfaceCell, Swing, backbone, surface};
pub use repaired::rounded;
pub use single_effect::single_effect;
