//! Shared parts of the sparse identification methods: terms of a law, thresholded regression, choice among
//! laws.
//!
//! The methods search for a law d ln A/dt = c₀ + Σ cₖ θₖ in a library of terms θₖ(A, t). Each method has its
//! own way to find the coefficients; this crate holds the rest: the envelope in scaled coordinates
//! ([`Scaled`]), the terms ([`Term`], standardized: [`Column`]), the law ([`Law`]), the threshold that rises
//! from the richest law to the constant ([`Path`]), the choice among the laws on that path ([`choose`]), the
//! report on it ([`because`], [`model_text`]), and the law's predictions at other times ([`predictions`]).

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod choice;
pub mod config;
mod flow;
mod law;
mod path;
mod prediction;
mod progress;
mod regression;
mod report;
mod scaled;
mod term;

pub use choice::choose;
pub use law::{Column, Law, running_integral};
pub use path::Path;
pub use prediction::predictions;
pub use progress::{Halt, Progress};
pub use regression::solve;
pub use report::{because, model_text};
pub use scaled::Scaled;
pub use term::Term;
