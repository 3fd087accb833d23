//! Contract that every estimator of a decay rate fulfills.
//!
//! An estimator receives an [`Envelope`](envelope::Envelope) and a [`FitContext`] and returns an [`Estimate`]
//! or a [`FitError`]. It draws random numbers from the context's named seeds only, uses no clock, no disk and
//! no other estimator, and cannot reach the oracle or the truth: its crate does not depend on them, which a
//! test checks.
//!
//! A new estimator is one crate with one [`Entry`]; `trainer new estimator NAME` writes a start.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod ablation;
mod context;
mod entry;
mod error;
mod estimate;
mod scaling;

pub use context::{Cancel, Checkpoints, FitContext, Observer, Silent, Step};
pub use entry::{Entry, Estimator, Tag};
pub use error::FitError;
pub use estimate::{Estimate, ModelFile, Prediction, Stop, Uncertainty};
pub use results::{Ablation, Estimand, Reached};
pub use scaling::Scaling;
