//! Settings of the estimator.

use neural::{Lbfgs, Reconstruction};
use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the long short-term memory network. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct LstmConfig {
    /// Number of units of the hidden state, and of the cell.
    pub hidden_units: usize,
    /// Options of the training.
    #[serde(flatten)]
    pub training: Reconstruction,
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
    Reconstruction::longest_sequence(
        10_000,
        1000,
        "time grows in proportion; a longer sequence gains no digit",
    ),
    Lbfgs::MAX_STEPS,
    Lbfgs::MEMORY,
    Lbfgs::GRADIENT_TOLERANCE,
    INITIAL_SCALE,
];
