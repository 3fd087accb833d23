//! Settings of the estimator.

use crate::kernel::Kernel;
use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the Gaussian process. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct GaussianProcessConfig {
    /// Covariance function.
    pub kernel: Kernel,
    /// Number of random starts.
    pub starts: u64,
    /// Most steps, over all starts.
    pub max_steps: u64,
    /// Predicted gain of the log likelihood at or below which a start has converged.
    pub tolerance: f64,
    /// Shortest length scale, as a share of the record's duration.
    pub shortest_length: f64,
    /// Longest length scale, as a share of the record's duration.
    pub longest_length: f64,
    /// Scale of the half-Cauchy prior of the ratio of the signal's standard deviation to the noise's.
    pub signal_scale: f64,
    /// Most peaks: the cost grows with their cube.
    pub most_peaks: usize,
    /// Half-width of the interval that the mean's coefficients start in, uniformly about zero, in scaled
    /// units.
    pub initial_scale: f64,
}

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    Field::new("kernel", Kind::Choice(&["rbf", "matern-3/2", "matern-5/2"]), Default::Text("rbf"))
        .meaning("Covariance function of the deviation of the envelope from a line.")
        .source("the paper; Rasmussen, Williams 2006, section 4.2"),
    Field::new("starts", Kind::Integer { min: 1, max: 100 }, Default::Integer(4))
        .meaning("Number of drawn starts; the one with the greatest likelihood counts.")
        .source("the likelihood has more than one maximum"),
    Field::new("max_steps", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(500))
        .meaning("Most steps, all starts together.")
        .source("several times what ten seeds take on the shipped record"),
    Field::new("tolerance", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(1e-8))
        .unit("nats")
        .meaning("A start has converged when no step promises a greater gain of the log likelihood.")
        .source("leaves the scales uncertain by 1e-4 of themselves; the mean is settled exactly"),
    Field::new("shortest_length", Kind::Float { min: 0.01, max: 10.0 }, Default::Float(0.2))
        .unit("durations of the record")
        .meaning("Shortest length scale.")
        .source("shorter ones take scatter for signal and make the interval too narrow"),
    Field::new("longest_length", Kind::Float { min: 0.01, max: 100.0 }, Default::Float(3.0))
        .unit("durations of the record")
        .meaning("Longest length scale; from there on the function is a parabola.")
        .source("longer ones only lose digits"),
    Field::new("signal_scale", Kind::Float { min: 1e-3, max: 1e9 }, Default::Float(1.0))
        .unit("standard deviations of the noise")
        .meaning("Scale of the half-Cauchy prior of the signal's standard deviation; 1e9 is no prior.")
        .source(
            "Gelman 2006, section 5; 1 makes the 95 % interval of straight envelopes hold 94.5 to \
                95 %",
        ),
    Field::new("most_peaks", Kind::Integer { min: 6, max: 20_000 }, Default::Integer(500))
        .meaning("Most peaks: time grows with their cube, memory with their square.")
        .source("measured on one core: 69 peaks take 20 ms, 500 ten seconds, 1000 two minutes"),
    Field::new("initial_scale", Kind::Float { min: 0.0, max: 10.0 }, Default::Float(1.0))
        .meaning("The mean's coefficients start uniformly within this far from zero, in scaled units.")
        .source("a nearly straight envelope has a slope of 1.7 there: the start is never the answer"),
];
