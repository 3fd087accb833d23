//! The ground under diagnosis and trials: a nominal oscillator, the effects that a simulator may lack, two
//! integrators, and the measuring chain.
//!
//! A [`Nominal`] oscillator and [`Active`] effects of the [`registry`] make a [`System`].
//! [`reference::simulate`] gives its motion to twelve digits, with its events and the work of every effect;
//! [`sensitivity::Model`] gives it fast, with exact derivatives, for fitting. A [`chain::Chain`] makes of a motion
//! what a file says of it.
//!
//! # Units
//! SI: seconds, radians or meters, N m or N, kg m² or kg. Where only the motion is known everything is
//! divided by the inertia, which is then exactly 1; torques are in rad/s² or m/s² then. [`Quantity::unit`]
//! tells the symbol.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod active;
pub mod chain;
mod description;
mod edges;
pub mod effects;
mod error;
#[cfg(test)]
mod event_tests;
mod export;
mod field;
#[cfg(test)]
mod fixtures;
mod input;
mod law;
mod nominal;
mod nominal_simulator;
pub mod reference;
pub mod registry;
#[cfg(test)]
mod rest_tests;
mod root;
pub mod scalar;
pub mod sensitivity;
mod system;
#[cfg(test)]
mod tests;
mod times;
mod units;

pub use active::Active;
pub use description::{Class, Description, Kind, Parameter, Range};
pub use error::DynamicsError;
pub use export::{Export, Joint, StateExport};
pub use field::SYSTEM_HIDDEN;
pub use input::{Hold, Input};
pub use law::{Hidden, Law, MOST_HIDDEN, MOST_PARAMETERS, Margins, Moment, Values};
pub use nominal::{Coefficients, Nominal};
pub use nominal_simulator::{KnownEffect, NominalSimulator};
pub use registry::{ChainEffect, Effect, REGISTRY, SystemEffect, UNNAMED};
pub use system::{Start, System};
pub use units::{Coordinate, Quantity, Units};
