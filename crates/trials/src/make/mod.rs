//! Drawing of cases: records, a nominal simulator, and the truth that is hidden from the diagnosis.
//!
//! A [`TrialPlan`] is resolved from a configuration. [`TrialPlan::case`] makes any one of its cases from the
//! seed and the case's number. Systems, starts, sensors and the logger's timestamp errors are drawn in the
//! same way in every bank, so none of them reveals what is hidden.
//!
//! # Sizes
//! Hidden effects are sized so that they are as *detectable* as configured. The detectability is d = ‖P·Δ‖/σ.
//! Δ is the effect's contribution to the samples. P removes what a recalibration of damping, stiffness, rest
//! angle and initial states (and inertia, if there is an input) can absorb. σ is the standard deviation of
//! all white disturbances: the sensor's noise, its rounding, and the scatter of timestamps.
//!
//! In a pair, P also removes what the other effect can absorb. A preload is sized with the rest angle held,
//! because otherwise it would only be another rest angle. For a law outside the vocabulary, P also removes
//! what the nearest effects of the vocabulary can absorb. For random effects, the expectation of ‖Δ‖² is used
//! without a projection. Lost samples change no value and have a detectability of 0. Bursts of a logger are
//! drawn independently of the wanted detectability.

mod banks;
mod case;
pub(crate) mod draws;
mod error;
mod folders;
pub(crate) mod integrator;
mod job;
mod json_schema;
pub(crate) mod laws;
pub(crate) mod nuisances;
pub(crate) mod open_law;
mod pairs;
mod plan;
mod ranges;
mod recalibration;
mod schema;
mod setup;
pub(crate) mod situation;
mod size;
mod unlisted;

#[cfg(test)]
mod composite_tests;
#[cfg(test)]
mod integrator_tests;
#[cfg(test)]
mod random_tests;
#[cfg(test)]
mod recalibration_tests;
#[cfg(test)]
mod tests;

pub use case::Case;
pub use error::TrialError;
pub use json_schema::trials_schema;
pub use plan::{LeftOutBank, TrialPlan};
pub(crate) use schema::SECTIONS;
