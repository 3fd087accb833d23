//! Truth of a simulated record, as a sealed type.
//!
//! A [`Truth`] holds everything that determines a record's bits. It travels as a [`Sealed`] truth, which
//! shows only its SHA-256 digest until it is opened; opening verifies the digest. Crates that make records,
//! score answers or run trials may depend on this crate; crates that estimate or diagnose may not
//! (`tests/architecture.rs`).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod sealed;
mod truth;

pub use sealed::{SealError, Sealed, digest};
pub use truth::{Draws, Excitation, Sampling, TRUTH_SCHEMA, Truth, Waveform};
