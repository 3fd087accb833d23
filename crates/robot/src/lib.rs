//! Robots of several joints.
//!
//! [`Urdf`] reads a model, [`Foreign`] asks another simulator; [`columns`] finds the columns of a log of several joints; [`project`] turns a
//! recording into one problem per joint, which the diagnosis of one joint solves; [`closed_loop`] runs the whole model; [`Model::repaired`] writes back what was
//! found.
//!
//! Angles are in rad, displacements in m, torques in N m, forces in N. This crate does not read files, print, or
//! write.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod agreement;
mod along;
mod closed_loop;
pub mod columns;
mod drive_noise;
mod error;
mod foreign;
mod mjcf;
mod model;
mod projection;
mod recording;
mod repair;
mod smoothing;
mod tracking;
mod urdf;

pub use agreement::{JointCoefficient, coefficients};
pub use along::Along;
pub use closed_loop::{ClosedLoop, JointError, Variant, closed_loop};
pub use drive_noise::Gain;
pub use error::RobotError;
pub use foreign::{Foreign, Simulator};
pub use model::{Evaluated, JointInfo, Model, RepairedModel};
pub use projection::{Part, Projected, Scale, project};
pub use recording::{Channel, Recording};
pub use repair::JointRepair;
pub use smoothing::{Smoothed, smoothed};
pub use tracking::Tracking;
pub use urdf::Urdf;
