//! Closed-form least squares with certified digits: the reference for every estimator.
//!
//! The oracle computes in its own double-double arithmetic (about 31 decimal digits). It states how many
//! digits of its answer the conditioning of the problem leaves, and refuses to answer if fewer than four
//! remain. It shares the envelope with the estimators, but no arithmetic.
//!
//! The crate also contains the paper's eleven [`classical`] methods in plain double precision, and
//! linfa-linear.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod certified;
pub mod classical;
mod curvature;
mod decay;
mod double_double;
mod error;
#[cfg(not(target_arch = "wasm32"))]
mod library;

pub use certified::{Intercept, LinearFit, least_squares};
pub use curvature::{Curvature, curvature};
pub use decay::{DecayFit, decay_rate};
pub use error::OracleError;
#[cfg(not(target_arch = "wasm32"))]
pub use library::linfa_decay_rate;

/// Fewest significant digits that an answer must have.
pub const FEWEST_DIGITS: f64 = 4.0;
