//! Export of finished runs to experiment trackers: event files of TensorBoard, MLflow's file store.
//!
//! [`Finished::read`] reads a run's folder. [`tensorboard`] and [`mlflow`] return the content and the name of
//! each file; they write nothing.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod finished;
pub mod mlflow;
pub mod tensorboard;

pub use finished::{Curve, Finished, TrackingError};
