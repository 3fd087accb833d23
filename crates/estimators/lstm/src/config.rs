//! Settings of the estimator.

use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the long short-term memory network. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct LstmConfig {
    /// Number of units of the hidden state, and of the cell.
    pub hidden_units: usize,
    /// Most entries that the network reads.
    pub longest_sequence: usize,
    /// Most L-BFGS steps.
    pub max_steps: u64,
    /// Number of curvature pairs that L-BFGS stores.
    pub memory: usize,
    /// Share of its initial length to which the gradient has to fall for the training to have converged.
    pub gradient_tolerance: f64,
    /// Factor on the random start values of the gates' weights.
    pub initial_scale: f64,
}

/// Number of units of the hidden state.
pub(crate) const HIDDEN_UNITS: Field =
    Field::new("hidden_units", Kind::Integer { min: 1, max: 256 }, Default::Integer(16))
        .meaning("Units of the hidden state, and of the cell.")
        .source("1 to 64 agree to rounding, 16 in the fewest steps or nearly");

/// Factor on the random start values.
pub(crate) const INITIAL_SCALE: Field =
    Field::new("initial_scale", Kind::Float { min: 1e-3, max: 10.0 }, Default::Float(1.0))
        .meaning("Factor on the drawn start values of the gates' weights.")
        .source("Glorot, Bengio 2010");

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    HIDDEN_UNITS,
    Field::new("longest_sequence", Kind::Integer { min: 3, max: 10_000 }, Default::Integer(1000))
        .unit("peaks")
        .meaning(
            "Most entries the network reads; a longer envelope is read as means over even runs of \
                neighboring peaks. The loss is over all peaks.",
        )
        .source("time grows in proportion; a longer sequence gains no digit"),
    Field::new("max_steps", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(200))
        .meaning("Most L-BFGS steps.")
        .source("several times what ten seeds take on the shipped record"),
    Field::new("memory", Kind::Integer { min: 1, max: 100 }, Default::Integer(10))
        .meaning("Curvature pairs that L-BFGS remembers.")
        .source("Nocedal, Wright, Numerical Optimization (2006), section 7.2: 3 to 20"),
    Field::new("gradient_tolerance", Kind::Float { min: 0.0, max: 0.1 }, Default::Float(1e-13))
        .meaning(
            "Training has converged when the gradient has fallen to this share of its length at \
                the start.",
        )
        .source("a few roundings above what double precision leaves"),
    INITIAL_SCALE,
];
