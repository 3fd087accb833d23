//! Finished runs for the trackers of experiments: event files of TensorBoard, MLflow's file store.
//!
//! [`Finished::read`] takes a run's folder; [`tensorboard`] and [`mlflow`] say what to write and where, and write nothing.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod finished;
pub mod mlflow;
pub mod tensorboard;

pub use finished::{Curve, Finished, TrackingError};
