//! Learning of an oscillator's dynamics from records, and scoring of learned models on unseen records.
//!
//! A [`data::DataSet`] holds trajectories split into training, validation and test parts. A [`Learner`] turns
//! it into a [`Model`], which predicts freely from a stretch of the past and the input. A model may also
//! state a torque, coefficients with intervals, and an equation. [`judge`] scores models on the test part,
//! next to the [`baselines`]. The registry of learners is [`learners::LEARNERS`].
//!
//! # Units
//! SI throughout: seconds; positions in rad or m. Torques are stated as accelerations: rad/s² is a torque
//! divided by the inertia, because motion alone reveals only this ratio.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

pub mod baselines;
pub mod data;
mod error;
pub mod expression;
pub mod flow;
mod hold;
pub mod judge;
mod learner;
pub mod learners;
mod linear;
mod model;
pub mod sequence;
mod stored;
#[cfg(test)]
mod testing;
pub mod training;

pub use error::LearnError;
pub use hold::{data_set, data_set_of_parts};
pub use learner::{Context, Entry, Fitted, Kind, Learner, Step};
pub use model::{Ahead, Coefficient, Model, Past, Place, Predicted, Torque};
pub use stored::{Stored, Tensor};
