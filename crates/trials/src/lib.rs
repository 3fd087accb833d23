//! Blind trials of the diagnosis, on records whose effect is withheld.
//!
//! `make` draws cases: each is a folder of records and a nominal simulator, with a sealed [`Hidden`] truth.
//! `score` compares answers with truths, which are opened only once. Everything that both need to know of an
//! effect stands in that effect's file below `effects`. Neither part calls the diagnosis, which runs as a
//! separate process on the folders.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod baseline;
mod effects;
mod hidden;
pub mod make;
mod score;

pub use baseline::{Baseline, BaselineRecord, WEAK_FORM, WEAK_FORM_METHOD, most_common, weak_form};
pub use hidden::{Bank, Foreign, HIDDEN_SCHEMA, Hidden, HiddenEffect, Unlisted};
pub use make::{Case, TrialError, TrialPlan, trials_schema};
pub use score::{
    AnsweredCase, Gate, Trials, case_rows, misses_a_bar, misses_the_gate, score, true_closure, with_the_truth,
};
