//! Settings of the estimator.

use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the matching. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EnvelopeMatchingConfig {
    /// Number of integration steps per period.
    pub steps_per_period: usize,
    /// Most periods that are simulated.
    pub most_periods: usize,
    /// Most Levenberg–Marquardt steps.
    pub max_steps: u64,
    /// Relative change of the parameters in one step below which the fit has converged.
    pub step_tolerance: f64,
    /// Half-width of the interval that the start values are drawn from, in scaled units.
    pub initial_scale: f64,
}

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    Field::new("steps_per_period", Kind::Integer { min: 3, max: 1000 }, Default::Integer(8))
        .meaning("Integration steps in a period of the simulated oscillator, each of order 16.")
        .source("at 8 the error of 69 periods is 3e-13 in ln A, which is rounding; at 4 it is 2e-9"),
    Field::new("most_periods", Kind::Integer { min: 10, max: 10_000_000 }, Default::Integer(20_000))
        .meaning("Most periods that are simulated; a longer record is matched by a slower oscillator.")
        .source(
            "0.1 s for each simulation; the envelope of a linear oscillator does not depend on \
                its frequency",
        ),
    Field::new("max_steps", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(100))
        .meaning("Most Levenberg-Marquardt steps.")
        .source("twenty times what ten seeds take on the measured record"),
    Field::new("step_tolerance", Kind::Float { min: 0.0, max: 0.1 }, Default::Float(1e-12))
        .meaning("Matched when a step moves the scaled ln A0 and decay rate by less than this.")
        .source("ten times what the rounding of a long simulation leaves"),
    Field::new("initial_scale", Kind::Float { min: 0.0, max: 10.0 }, Default::Float(0.5))
        .meaning(
            "Start values are uniform within plus or minus this, in spreads of ln A over the \
                record.",
        )
        .source(
            "an envelope near a line has a decay rate near 3.5 in these units: the start is no \
                answer",
        ),
];
