//! Simulated decays whose truth is known, kept apart from what estimators see.
//!
//! A [`DecayLaw`] gives the noise-free turning points of an oscillator ([`EnvelopeTruth`]); drawing scatter
//! on them gives an [`Envelope`](envelope::Envelope), which is all that an estimator is handed. Nothing
//! leads from an envelope back to its truth, and no estimator's crate may depend on this one.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod decay_law;
mod envelope_draw;
mod error;

#[cfg(test)]
mod oscillator;

pub use decay_law::DecayLaw;
pub use envelope_draw::{EnvelopeSimulation, EnvelopeTruth, SMALLEST_IN_SCATTER, Scatter};
pub use error::SimulationError;
