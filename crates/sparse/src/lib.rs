//! Shared parts of the sparse identification methods: terms of a law, thresholded regression, choice among
//! laws.
//!
//! The methods search for a law d ln A/dt = c₀ + Σ cₖ θₖ in a library of terms θₖ(A, t). Each method has its
//! own way to find the coefficients; this crate holds the rest: the envelope in scaled coordinates
//! ([`Scaled`]), the terms ([`Term`], standardized: [`Column`]), the law ([`Law`]), the threshold that rises
//! from the richest law to the constant ([`Path`]), and the estimate by the simplest law on that path that the
//! peaks allow, with its errors and predictions ([`Regression`]).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod choice;
pub mod config;
mod estimate;
mod flow;
mod law;
mod path;
mod prediction;
mod progress;
mod regression;
mod scaled;
mod term;

pub use estimate::Regression;
pub use law::{Column, Law, running_integral};
pub use path::Path;
pub use progress::{Halt, Progress};
pub use regression::solve;
pub use scaled::Scaled;
pub use term::Term;
