//! Significance of the difference of two fits on the same data.

use crate::fit::fitted::Fit;
use crate::noise::statistics::chi_squared_above;

/// Returns the tempered log likelihood ratio of a fit over another on the same data. `time` is the
/// autocorrelation time in samples.
pub(crate) fn ratio(fit: &Fit, other: &Fit, time: f64) -> f64 {
    other.nats_behind(fit.squares, time)
}

/// Probability with which a correct calibration is called wrong.
pub(crate) const OFF_BY_CHANCE: f64 = 0.01;

/// Returns `true` if `parameters` additional coefficients improve a fit by more than chance does with
/// probability `chance`. `time` is the autocorrelation time in samples.
pub(crate) fn significant(better: &Fit, worse: &Fit, time: f64, parameters: usize, chance: f64) -> bool {
    2.0 * ratio(better, worse, time) > chi_squared_above(parameters as f64, chance)
}
