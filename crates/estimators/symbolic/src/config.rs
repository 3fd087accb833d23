//! Settings of the estimator.

use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the evolution. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SymbolicConfig {
    /// Number of expressions in a generation.
    pub population: usize,
    /// Most generations.
    pub max_generations: u64,
    /// Generations without progress after which the evolution has converged.
    pub patience: u64,
    /// Number of expressions that compete to become a parent.
    pub tournament: usize,
    /// Share of children by crossover.
    pub crossover: f64,
    /// Share of children by a random subtree.
    pub subtree_mutation: f64,
    /// Share of children by a changed node; the rest are hoisted subtrees.
    pub point_mutation: f64,
    /// Most nodes of an expression.
    pub max_nodes: usize,
    /// Depth of the deepest random tree.
    pub initial_depth: usize,
    /// Cost of a node in a tournament, as a share of the loss.
    pub parsimony: f64,
    /// Most Levenberg–Marquardt steps for the constants of a child.
    pub constant_steps: u64,
    /// `true` if the sine is one of the functions.
    pub sine: bool,
    /// Most peaks that the evolution uses.
    pub search_peaks: usize,
    /// Steepest linear part of an expression in the first population.
    pub initial_steepness: f64,
}

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    Field::new("population", Kind::Integer { min: 10, max: 100_000 }, Default::Integer(200))
        .meaning("Number of expressions in a generation.")
        .source("small, because every constant is fitted"),
    Field::new("max_generations", Kind::Integer { min: 0, max: 100_000 }, Default::Integer(60))
        .meaning("Most generations; the first fits the constants of the drawn population.")
        .source("three times what ten seeds take on the measured record"),
    Field::new("patience", Kind::Integer { min: 1, max: 100_000 }, Default::Integer(8))
        .meaning(
            "The search has converged if the least held-out error fell by less than 1 % over this \
                many generations.",
        )
        .source("10 and 15 choose the same expression on nine of ten seeds"),
    Field::new("tournament", Kind::Integer { min: 1, max: 100 }, Default::Integer(4))
        .meaning("Number of drawn expressions of which the best becomes a parent.")
        .source("3 and 4 do alike on the measured record"),
    Field::new("crossover", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(0.6))
        .meaning("Share of children by crossover of two parents' subtrees.")
        .source("Koza 1992 takes 0.9 without fitted constants; mutation gains where they are fitted"),
    Field::new("subtree_mutation", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(0.2))
        .meaning("Share of children by a drawn subtree in a parent.")
        .source("Poli, Langdon, McPhee, A Field Guide to Genetic Programming (2008), section 2.4"),
    Field::new("point_mutation", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(0.15))
        .meaning(
            "Share of children by one changed node; what the three shares leave of 1 are hoisted \
                subtrees.",
        )
        .source("Poli, Langdon, McPhee 2008, section 2.4"),
    Field::new("max_nodes", Kind::Integer { min: 3, max: 200 }, Default::Integer(20))
        .meaning("Most nodes of an expression.")
        .source("four times a line's"),
    Field::new("initial_depth", Kind::Integer { min: 1, max: 8 }, Default::Integer(3))
        .meaning("Depth of the deepest tree of the first population, which is ramped half and half.")
        .source("full trees of this depth have up to 15 nodes, which max_nodes admits"),
    Field::new("parsimony", Kind::Float { min: 0.0, max: 10.0 }, Default::Float(0.01))
        .meaning("Cost of a node in a tournament, as a share of the loss.")
        .source("small, because the front already favors simplicity"),
    Field::new("constant_steps", Kind::Integer { min: 1, max: 1000 }, Default::Integer(10))
        .meaning("Most Levenberg-Marquardt steps for the constants of a child.")
        .source("a child starts from its parents' constants; the front is fitted in full at the end"),
    Field::new("sine", Kind::Boolean, Default::Boolean(false))
        .meaning("Whether the sine is one of the functions, beside exp, log, sqrt and square.")
        .source("an envelope does not oscillate by definition; a sine fits the scatter"),
    Field::new("search_peaks", Kind::Integer { min: 10, max: 1_000_000 }, Default::Integer(256))
        .meaning(
            "Most peaks, evenly chosen, that the evolution looks at; the front is fitted to all \
                of them.",
        )
        .source("more peaks make the evolution slower without changing the laws"),
    Field::new("initial_steepness", Kind::Float { min: 0.0, max: 10.0 }, Default::Float(1.0))
        .meaning(
            "Steepest straight part of a drawn expression, in spreads of ln A over the record; \
                steeper ones are drawn again.",
        )
        .source("an envelope near a line has 3.5 in these units: the start is no answer"),
];
