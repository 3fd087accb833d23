//! Trials of the diagnosis on records whose effect is withheld.
//!
//! Two rooms with a door between them that opens once: `make` draws cases, each a folder of records and a
//! nominal simulator with a sealed [`Hidden`] truth; `score` lays answers beside opened truths. Neither reaches the
//! diagnosis: that runs as a process of its own on the folders.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod hidden;
pub mod make;

pub use hidden::{Bank, HIDDEN_SCHEMA, Hidden, HiddenEffect};
