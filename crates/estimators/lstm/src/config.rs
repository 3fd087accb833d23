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
pub(crate) const HIDDEN_UNITS: Field = Field {
    key: "hidden_units",
    kind: Kind::Integer { min: 1, max: 256 },
    default: Default::Integer(16),
    unit: "",
    meaning: "Units of the hidden state, and of the cell.",
    source: "1 to 64 agree to rounding, 16 in the fewest steps or nearly",
};

/// Factor on the random start values.
pub(crate) const INITIAL_SCALE: Field = Field {
    key: "initial_scale",
    kind: Kind::Float { min: 1e-3, max: 10.0 },
    default: Default::Float(1.0),
    unit: "",
    meaning: "Factor on the drawn start values of the gates' weights.",
    source: "Glorot, Bengio 2010",
};

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    HIDDEN_UNITS,
    Field {
        key: "longest_sequence",
        kind: Kind::Integer { min: 3, max: 10_000 },
        default: Default::Integer(1000),
        unit: "peaks",
        meaning: "Most entries the network reads; a longer envelope is read as means over even runs of neighboring peaks. The loss is over all peaks.",
        source: "time grows in proportion; a longer sequence gains no digit",
    },
    Field {
        key: "max_steps",
        kind: Kind::Integer { min: 0, max: 1_000_000 },
        default: Default::Integer(200),
        unit: "",
        meaning: "Most L-BFGS steps.",
        source: "several times what ten seeds take on the shipped record",
    },
    Field {
        key: "memory",
        kind: Kind::Integer { min: 1, max: 100 },
        default: Default::Integer(10),
        unit: "",
        meaning: "Curvature pairs that L-BFGS remembers.",
        source: "Nocedal, Wright, Numerical Optimization (2006), section 7.2: 3 to 20",
    },
    Field {
        key: "gradient_tolerance",
        kind: Kind::Float { min: 0.0, max: 0.1 },
        default: Default::Float(1e-13),
        unit: "",
        meaning: "Training has converged when the gradient has fallen to this share of its length at the start.",
        source: "a few roundings above what double precision leaves",
    },
    INITIAL_SCALE,
];
