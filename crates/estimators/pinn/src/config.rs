//! Settings of the estimator.

use neural::LevenbergMarquardt;
use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the physics-informed network. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct PinnConfig {
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// Number of collocation points.
    pub collocation_points: usize,
    /// Weight of the physics term.
    pub physics_weight: f64,
    /// Settings of the training.
    #[serde(flatten)]
    pub training: LevenbergMarquardt,
    /// Factor on the random start values.
    pub initial_scale: f64,
}

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    Field::new(
        "hidden",
        Kind::Integers { min: 1, max: 256, at_least: 1, at_most: 6 },
        Default::Integers(&[16, 16]),
    )
    .meaning("Widths of the hidden layers, each followed by tanh.")
    .source("8, 16 and 32 agree to 1e-7; 16 trains in half the time of 32"),
    Field::new("collocation_points", Kind::Integer { min: 2, max: 100_000 }, Default::Integer(128))
        .meaning(
            "Points at which the physics is asked for, one drawn in each equal part of the \
                record.",
        )
        .source("more than the peaks, so that the network cannot bend between them"),
    Field::new("physics_weight", Kind::Float { min: 1e-6, max: 1e12 }, Default::Float(1e5))
        .meaning("Weight of the physics term against the data term.")
        .source(
            "leaves a bias of about 3e-3 / weight on a bent envelope; above 1e6 training turns \
                slow",
        ),
    LevenbergMarquardt::max_steps(500, "several times what ten seeds take on the shipped record"),
    LevenbergMarquardt::loss_tolerance(1e-8, "MINPACK's default ftol"),
    Field::new("initial_scale", Kind::Float { min: 0.0, max: 10.0 }, Default::Float(0.5))
        .meaning("Factor on the drawn start values of weights, biases and decay rate.")
        .source("Glorot, Bengio 2010, halved: the target is close to a line"),
];
