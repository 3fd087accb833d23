//! Settings of the estimator.

use neural::LevenbergMarquardt;
use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the neural ODE. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct NeuralOdeConfig {
    /// Widths of the vector field's hidden layers.
    pub hidden: Vec<usize>,
    /// Number of steps of the ODE solver over the record.
    pub solver_steps: usize,
    /// Weight of the trajectory's mean squared second derivative, scaled.
    pub curvature_weight: f64,
    /// Weight of the sum of squares of those weights that do not change when a line is added to ln A.
    pub weight_decay: f64,
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
        Default::Integers(&[6]),
    )
    .meaning("Widths of the vector field's hidden layers, each followed by tanh.")
    .source(
        "4, 6, 8 and 16 agree to 1e-9; 6 bends nearly as freely as 8 and trains in half the \
                steps",
    ),
    Field::new("solver_steps", Kind::Integer { min: 1, max: 100_000 }, Default::Integer(32))
        .meaning("Steps of the Runge-Kutta method over the record, whatever the number of peaks.")
        .source(
            "256 change the fitted values by 2e-4 of their bend; 8 take three times the training \
                steps",
        ),
    Field::new("curvature_weight", Kind::Float { min: 1e-9, max: 1e9 }, Default::Float(1e-3))
        .meaning("Weight of the trajectory's mean squared second derivative, in scaled units.")
        .source(
            "leaves residuals without correlation on the paper's record, at five degrees of \
                freedom",
        ),
    Field::new("weight_decay", Kind::Float { min: 1e-9, max: 1e9 }, Default::Float(1e-2))
        .meaning("Weight of the sum of squared weights, those that carry lines left out.")
        .source("every one of 100 seeds ends in the same fit; below 1e-4 weights grow without end"),
    LevenbergMarquardt::max_steps(
        2000,
        "the paper's record takes 50 to 100, the slowest of 1000 simulated envelopes 650",
    ),
    LevenbergMarquardt::loss_tolerance(
        1e-10,
        "leaves the decay rate within 1e-8 of its limit on 1000 simulated envelopes",
    ),
    Field::new("initial_scale", Kind::Float { min: 1e-3, max: 10.0 }, Default::Float(0.5))
        .meaning("Factor on the drawn start values of weights, biases and initial state.")
        .source("Glorot, Bengio 2010, halved: the field is close to constant"),
];
