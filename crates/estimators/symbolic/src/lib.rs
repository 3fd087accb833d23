//! Symbolic regression of the envelope by genetic programming.
//!
//! A population of expressions in the time, built from + − × ÷, exp, log, square root, square and constants,
//! evolves. Tournaments select parents; crossover of subtrees, mutation of subtrees and of nodes, and
//! hoisting create children; every child's constants are fitted by Levenberg–Marquardt on exact derivatives.
//! The front holds the expressions for which none is both simpler and better. An expression that is not
//! finite on a peak, or that may have a pole between peaks, is rejected; no operator is "protected" by
//! replacing it with another function.
//!
//! The result is the simplest adequate expression of the front: the one with the fewest nodes whose held-out
//! error (each peak left out in turn) is within one standard error of the least. λ is minus the slope of that
//! expression, projected on a straight line over the peak times. So that λ depends on the data and not on the
//! misfit of the shape, the straight line that a bent expression lacks is added to it and fitted with it; a
//! line needs no addition and gives its own slope. Fitted values, predictions and the stated equation are
//! those of the expression with its line.
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

/// Registry entry of the symbolic regression.
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
