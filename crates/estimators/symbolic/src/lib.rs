//! Symbolic regression of the envelope by genetic programming.
//!
//! A population of expressions in the time, built from + − × ÷, exp, log, square root, square and
//! constants, evolves: tournaments choose parents; crossover of subtrees, mutation of subtrees and of
//! nodes, and hoisting make children; every child's constants are fitted by Levenberg–Marquardt on exact
//! derivatives. The expressions than which none is both simpler and better make the front. An expression
//! that is not finite on a peak, or that may have a pole between peaks, is rejected; no operator is
//! "protected" into another function.
//!
//! Of the front the simplest adequate expression is taken: the one with the fewest nodes whose held-out
//! error (each peak left out in turn) is within one standard error of the least. λ is minus the slope of
//! that expression, projected on a straight line over the peak times. So that this reads the data and
//! not what the shape leaves over, the straight line that a bent expression lacks is joined to it and
//! fitted with it; a line needs nothing and gives its own slope. Fitted values, predictions and the
//! equation stated are those of the expression with its line.
//!
//! Reference: Koza, Genetic Programming (MIT Press 1992); Kommenda, Burlacu, Kronberger, Affenzeller, Genetic
//! Programming and Evolvable Machines 21 (2020) 471, for the fitted constants.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod basis;
mod config;
mod constants;
mod data;
mod equation;
mod evolution;
mod expression;
mod fit;
mod front;
mod operators;
#[cfg(test)]
mod tests;
mod variation;

pub use config::SymbolicConfig;

use estimator::{Entry, Estimator, Tag};

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "symbolic",
    paper_number: Some(16),
    title: "Symbolic regression",
    summary: "Genetic programming over expression trees; the simplest adequate expression of the front of error \
              against complexity.",
    tags: &[Tag::Iterative, Tag::Seeded, Tag::Interval, Tag::Ablation],
    citations: &[
        "Koza, Genetic Programming (MIT Press 1992)",
        "Kommenda, Burlacu, Kronberger, Affenzeller, Genetic Programming and Evolvable Machines 21 (2020) 471-501",
        "Breiman, Friedman, Olshen, Stone, Classification and Regression Trees (Wadsworth 1984)",
        "Keijzer, EuroGP 2003, Lecture Notes in Computer Science 2610, 70-82",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: SymbolicConfig = settings.section("estimator")?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
