//! Diagnosis.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod calibrate;
mod candidate;
mod dictionary;
mod error;
mod facts;
mod fit;
mod hypothesis;
mod noise;
mod observations;
mod period;
mod projection;
mod response;
mod score;
mod search;
mod segments;
mod spectrum;
mod statistics;
mod tangent;
#[cfg(test)]
mod trials;

pub use error::DiagnosisError;
pub use observations::Observations;
