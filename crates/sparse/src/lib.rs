//! What the sparse identification methods share: terms of a law, thresholded regression, choice among laws.
//!
//! A law d ln A/dt = c₀ + Σ cₖ θₖ is sought in a library of terms θₖ(A, t). How its coefficients are found is
//! each method's own; what they are found for is here: the envelope in scaled coordinates ([`Scaled`]), the
//! terms ([`Term`], standardized: [`Column`]), the law ([`Law`]), the threshold that rises from the richest law
//! to the constant ([`Path`]), the choice among the laws on that path ([`choose`]), what is said of it
//! ([`because`], [`model_text`]), and what it says of other times ([`predictions`]).

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
