//! Method 6: plain gradient descent.

use super::linear::singular;
use super::local::ROUNDING;
use super::vectors::{UNIT_ROUNDOFF, dot, length};
use super::{ClassicalFit, ClassicalRoute, Reached};
use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// Plain gradient descent, 10,000 steps from (0, 0).
pub const ROUTE: ClassicalRoute = ClassicalRoute {
    id: "gradient-descent",
    paper_number: 6,
    title: "Gradient descent",
    summary: "10,000 steps of one fixed length down the gradient, from (0, 0), in seconds and ln A.",
    citations: &["Nocedal, Wright, Numerical Optimization (2nd ed., Springer 2006), section 3.3"],
    draws: false,
    fit,
};

/// Number of steps, as in the paper.
pub const STEPS: u64 = 10_000;

/// |cos| of the angle between residuals and columns below which the descent counts as converged.
pub const TOLERANCE: f64 = 1e-10;

fn fit(envelope: &Envelope, _: &Seed) -> Result<ClassicalFit, OracleError> {
    let fit = descend(envelope, STEPS);
    // If the times are so long that their squares overflow, there is no step size.
    if fit.decay_rate.is_finite() && fit.log_amplitude.is_finite() { Ok(fit) } else { Err(singular()) }
}

/// Descends F(s, a) = ½·mean of (a + s·t − ln A)² from (0, 0), with times in seconds, unscaled.
///
/// The step size is 1/L with L the largest eigenvalue of F's second derivative [[mean t², mean t], [mean t,
/// 1]], which is constant: the largest step size for which no direction oscillates. Along the other
/// eigenvector the error shrinks by 1 − l/L per step, with l the smaller eigenvalue. For 69 peaks over 20 s
/// that is 1 − 1/500, and 10,000 steps leave about 10⁻⁹ of the first error. The paper does not give its step
/// size, and its error of 0.046 % is larger than the one left here. Nothing is scaled, so that a longer
/// record in the same time unit converges worse: that is how the method works.
#[must_use]
pub fn descend(envelope: &Envelope, steps: u64) -> ClassicalFit {
    let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
    let count = times.len() as f64;
    let (mean, mean_square) = (times.iter().sum::<f64>() / count, dot(times, times) / count);
    let step = 1.0 / largest_eigenvalue(mean, mean_square);
    let (mut slope, mut constant) = (0.0_f64, 0.0_f64);
    for _ in 0..steps {
        let (mut along_slope, mut along_constant) = (0.0, 0.0);
        for (t, y) in times.iter().zip(logs) {
            let residual = slope.mul_add(*t, constant) - y;
            along_slope += residual * t;
            along_constant += residual;
        }
        slope -= step * along_slope / count;
        constant -= step * along_constant / count;
    }
    let cosine = largest_cosine(times, logs, slope, constant);
    let reached = if cosine <= TOLERANCE { Reached::Converged } else { Reached::BudgetSpent };
    ClassicalFit {
        decay_rate: -slope,
        log_amplitude: constant,
        std_error: None,
        promised_digits: None,
        steps,
        reached,
        because: format!(
            "{steps} steps of length {step:.2e}; the residuals' largest cosine with 1 and t is {cosine:.1e}, \
             {TOLERANCE:.0e} counts as converged"
        ),
    }
}

/// Returns the larger eigenvalue of [[mean square, mean], [mean, 1]].
fn largest_eigenvalue(mean: f64, mean_square: f64) -> f64 {
    let half = f64::midpoint(mean_square, 1.0);
    half + libm::hypot((mean_square - 1.0) / 2.0, mean)
}

/// Returns the largest |cos| of the angles that the residuals make with the constant and with t, without the
/// rounding errors of the data.
fn largest_cosine(times: &[f64], logs: &[f64], slope: f64, constant: f64) -> f64 {
    let residuals: Vec<f64> = times.iter().zip(logs).map(|(t, y)| slope.mul_add(*t, constant) - y).collect();
    let rounding = ROUNDING * UNIT_ROUNDOFF * length(logs) / TOLERANCE;
    let size = length(&residuals) + rounding;
    let along_slope = dot(times, &residuals).abs() / length(times);
    let along_constant = residuals.iter().sum::<f64>().abs() / (times.len() as f64).sqrt();
    if size > 0.0 { along_slope.max(along_constant) / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::{descend, largest_eigenvalue};
    use crate::classical::Reached;
    use envelope::Envelope;

    fn envelope() -> Envelope {
        let times: Vec<f64> = (0..69).map(|i| f64::from(i) * 0.288).collect();
        let logs = times.iter().map(|t| -0.6 - 0.19 * t + 0.1 * (7.0 * t).sin()).collect();
        Envelope::new(times, logs, 21.8).unwrap()
    }

    #[test]
    fn the_eigenvalue_solves_its_equation() {
        let (mean, square) = (9.8, 130.0);
        let l = largest_eigenvalue(mean, square);
        assert!(((square - l) * (1.0 - l) - mean * mean).abs() < 1e-10);
        assert!(l > square);
    }

    #[test]
    fn the_error_shrinks_at_the_stated_rate() {
        let (envelope, certified) = (envelope(), crate::decay_rate(&envelope()).unwrap().decay_rate);
        let count = envelope.len() as f64;
        let mean = envelope.times_s().iter().sum::<f64>() / count;
        let square = envelope.times_s().iter().map(|t| t * t).sum::<f64>() / count;
        let large = largest_eigenvalue(mean, square);
        // The product of the eigenvalues is the variance of t.
        let rate = 1.0 - (square - mean * mean) / large / large;
        let error = |steps| (descend(&envelope, steps).decay_rate - certified).abs();
        let measured = (error(3000) / error(1000)).powf(1.0 / 2000.0);
        assert!((measured - rate).abs() < 1e-6, "{measured} {rate}");
    }

    #[test]
    fn a_budget_of_nothing_is_not_converged() {
        let fit = descend(&envelope(), 0);
        assert_eq!((fit.decay_rate, fit.reached), (0.0, Reached::BudgetSpent));
        assert!(fit.because.contains("0 steps"), "{}", fit.because);
    }
}
