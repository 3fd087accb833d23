//! What generated a simulated record, as a sealed type.
//!
//! A [`Truth`] says everything that a record's bits follow from. It travels as a [`Sealed`] truth, which shows
//! its SHA-256 digest and nothing else until it is opened; opening checks the digest. Who makes records,
//! scores answers or runs trials may reach this crate; whoever estimates or diagnoses may not
//! (`tests/architecture.rs`).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod sealed;
mod truth;

pub use sealed::{SealError, Sealed, digest};
pub use truth::{Draws, Excitation, Sampling, TRUTH_SCHEMA, Truth, Waveform};
