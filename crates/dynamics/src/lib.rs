//! Dynamics of the systems that are diagnosed: a nominal oscillator, the effects that a simulator may lack,
//! two integrators, and the measurement chain.
//!
//! A [`Nominal`] oscillator and [`Active`] effects of the [`registry`] form a [`System`].
//! [`reference::simulate`] computes its motion to twelve digits, with its events and the work of every
//! effect; [`sensitivity::Model`] computes it fast and with exact derivatives, for fitting. A
//! [`chain::Chain`] turns a motion into the samples of a file.
//!
//! # Example
//! Release of an oscillator of 3.5 Hz with dry friction:
//!
//! ```
//! use dynamics::reference::{Tolerance, simulate};
//! use dynamics::{Active, Nominal, Start, System};
//!
//! // Inertia, damping, stiffness, rest angle; all per unit of inertia.
//! let nominal = Nominal::new(1.0, 0.3, 484.0, 0.0)?;
//! let friction = Active::named("coulomb_friction", &[("torque", 2.0)])?;
//! let system = System::new(nominal, vec![friction])?;
//!
//! let times: Vec<f64> = (0..260).map(|sample| f64::from(sample) / 130.0).collect();
//! let motion = simulate(&system, Start::release(0.7), None, &times, &Tolerance::default())?;
//!
//! assert_eq!(motion.position.len(), times.len());
//! let late = motion.position[200..].iter().fold(0.0_f64, |most, position| most.max(position.abs()));
//! assert!(late < 0.6, "friction and damping take amplitude: {late} rad");
//! # Ok::<(), dynamics::DynamicsError>(())
//! ```
//!
//! # Units
//! SI: seconds, radians or meters, N m or N, kg m² or kg. If only the motion is known, all coefficients are
//! divided by the inertia, which is then exactly 1, and torques are in rad/s² or m/s². [`Quantity::unit`]
//! returns the symbol.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod active;
mod actuator;
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
pub mod tree;
mod units;
pub mod weak_form;

pub use active::Active;
pub use actuator::{Actuator, Command, Stated};
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
