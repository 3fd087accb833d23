//! Simulated decays whose truth is known and kept apart from what estimators read.
//!
//! A [`Plan`] holds priors of systems, starts and measurement chains, as a configuration states them. Drawing
//! from it yields records, each with its sealed [`truth::Truth`]; [`generate`] computes the same record from
//! a truth again, to the bit.
//!
//! A [`DecayLaw`] yields the noise-free turning points of an oscillator ([`EnvelopeTruth`]). Drawing scatter
//! on them yields an [`Envelope`](envelope::Envelope), which is all that an estimator gets. Nothing leads
//! from an envelope back to its truth, and no estimator's crate may depend on this one.
//!
//! # Example
//! A record of a decay with dry friction, as a configuration states it, and the same record from its truth:
//!
//! ```
//! use settings::Document;
//! use simulator::{Plan, generate};
//!
//! let text = r#"
//!     inertia = 1.0
//!     damping = 0.3
//!     stiffness = 484.0
//!     rest_angle = 0.0
//!     [record]
//!     rate_hz = 130.0
//!     seconds = 4.0
//!     [start]
//!     position = 0.7
//!     [sensor]
//!     noise = 5e-4
//!     [[effects]]
//!     id = "coulomb_friction"
//!     parameters.torque = 2.0
//! "#;
//! let plan = Plan::resolve(&Document::parse("friction.toml", text)?)?;
//! let (record, _sealed) = plan.record(0, 0)?;
//! assert_eq!(record.len(), 520);
//!
//! let truth = &plan.draw(0)?.truths[0];
//! assert_eq!(generate(truth)?.values(), record.values());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod decay_law;
mod draw;
mod envelope_draw;
mod error;
mod generate;
mod generation_error;
mod json_schema;
mod number;
mod plan;
mod prior;
mod schema;

#[cfg(test)]
mod oscillator;
#[cfg(test)]
mod tests;

pub use decay_law::DecayLaw;
pub use draw::DrawnSystem;
pub use envelope_draw::{EnvelopeSimulation, EnvelopeTruth, SMALLEST_IN_SCATTER, Scatter};
pub use error::SimulationError;
pub use export::nominal_text;
pub use generate::{MOST_DECIMALS, MOST_SAMPLES, csv_text, generate};
pub use generation_error::GenerationError;
pub use json_schema::simulate_schema;
pub use plan::Plan;
pub use prior::Prior;
