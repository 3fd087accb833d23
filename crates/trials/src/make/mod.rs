//! Drawing cases: records, a nominal simulator, and the truth that is hidden from whoever diagnoses.
//!
//! A [`TrialPlan`] is resolved from a configuration; [`TrialPlan::case`] makes any of its cases alone, from
//! the seed and its number. Systems, starts, sensors and what the logger does to stamps are drawn alike in
//! every bank, so that none of it tells what is hidden.
//!
//! # Sizes
//! Hidden effects are as large as makes them as *detectable* as configured: d = ‖P·Δ‖/σ, where Δ is what the
//! effect adds to the samples, P takes away what a recalibration of damping, stiffness, rest angle, starts
//! (and inertia, where there is an input) makes up for, and σ is the standard deviation of all that is
//! white: the sensor's noise, its rounding, what scattered stamps do. In a pair P takes away the other effect
//! too. A preload is sized with the rest angle held, as it would be nothing but another rest angle. For something
//! foreign P takes away the nearest effects of the vocabulary too. For effects that are random the
//! expectation of ‖Δ‖² is taken and nothing projected off; lost samples change no value and have a
//! detectability of 0, bursts of a logger are as detectable as they are.

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
