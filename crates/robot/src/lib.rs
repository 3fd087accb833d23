//! Robots of several joints.
//!
//! [`Urdf`] reads a model; [`columns`] finds the columns of a log of several joints; [`project`] turns a
//! recording into one problem per joint, which the diagnosis of one joint solves; [`closed_loop`] runs the whole model; [`repaired`] writes back what was
//! found.
//!
//! Angles are in rad, displacements in m, torques in N m, forces in N. This crate does not read files, print, or
//! write.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod closed_loop;
pub mod columns;
mod drive_noise;
mod error;
mod model;
mod projection;
mod repair;
mod smoothing;
mod tracking;
mod urdf;

pub use closed_loop::{ClosedLoop, JointError, closed_loop};
pub use error::RobotError;
pub use model::{JointInfo, Model};
pub use projection::{Channel, Part, Projected, Recording, project};
pub use repair::{JointRepair, repaired};
pub use smoothing::{Smoothed, smoothed};
pub use tracking::Tracking;
pub use urdf::Urdf;
