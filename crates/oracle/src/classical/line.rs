//! Line of an envelope as a problem for the iterative routes.

use super::local::ROUNDING;
use super::problem::{LeastSquaresProblem, LeastSquaresSolution, SmoothFunction};
use super::vectors::{UNIT_ROUNDOFF, dot, length, sum};
use super::{ClassicalFit, Reached};
use envelope::Envelope;

/// Neutral start of every iterative route: no decay, and the mean amplitude.
pub(super) const NEUTRAL: [f64; 2] = [0.0, 0.0];

/// Orthogonality, or relative gradient, at which a search for the line has converged.
pub(super) const TOLERANCE: f64 = 1e-12;

/// Line v ≈ a + s·u. u is the time over the envelope's duration, and v is the log amplitude minus its mean,
/// in its standard deviations; only this range, mean and standard deviation are taken from the data. The
/// parameters are s, a.
pub(super) struct Line {
    pub(super) u: Vec<f64>,
    pub(super) v: Vec<f64>,
    duration: f64,
    mean: f64,
    deviation: f64,
}

impl Line {
    pub(super) fn new(envelope: &Envelope) -> Self {
        let duration = envelope.duration_s();
        let logs = envelope.log_amplitudes();
        let count = logs.len() as f64;
        let mean = sum(logs) / count;
        let centered: Vec<f64> = logs.iter().map(|y| y - mean).collect();
        let deviation = match length(&centered) / count.sqrt() {
            // A constant envelope, up to rounding.
            deviation if deviation <= 4.0 * UNIT_ROUNDOFF * mean.abs() => mean.abs().max(1.0),
            deviation => deviation,
        };
        Self {
            u: envelope.times_s().iter().map(|t| t / duration).collect(),
            v: centered.iter().map(|y| y / deviation).collect(),
            duration,
            mean,
            deviation,
        }
    }

    /// Returns λ in 1/s and ln A₀ for slope and constant.
    pub(super) fn decay(&self, parameters: &[f64]) -> (f64, f64) {
        let (slope, constant) = pair(parameters);
        (-slope * self.deviation / self.duration, constant.mul_add(self.deviation, self.mean))
    }

    pub(super) fn fit(
        &self,
        parameters: &[f64],
        steps: u64,
        reached: Reached,
        because: String,
    ) -> ClassicalFit {
        let (decay_rate, log_amplitude) = self.decay(parameters);
        ClassicalFit {
            decay_rate,
            log_amplitude,
            std_error: None,
            promised_digits: None,
            steps,
            reached,
            because,
        }
    }

    pub(super) fn fit_with_error(&self, solution: LeastSquaresSolution) -> ClassicalFit {
        let LeastSquaresSolution { parameters, std_errors, steps, reached, because, .. } = solution;
        let std_error = std_errors.and_then(|errors| errors.first().copied());
        ClassicalFit {
            std_error: std_error.map(|error| error * self.deviation / self.duration),
            ..self.fit(&parameters, steps, reached, because)
        }
    }
}

/// Returns slope and constant.
pub(super) fn pair(parameters: &[f64]) -> (f64, f64) {
    match parameters {
        &[slope, constant] => (slope, constant),
        _ => (f64::NAN, f64::NAN),
    }
}

impl LeastSquaresProblem for Line {
    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        let (slope, constant) = pair(parameters);
        self.u.iter().zip(&self.v).map(|(u, v)| slope.mul_add(*u, constant) - v).collect()
    }

    fn jacobian(&self, _: &[f64]) -> Vec<Vec<f64>> {
        vec![self.u.clone(), vec![1.0; self.u.len()]]
    }

    /// Returns the length of v with its mean added back, since the rounding errors are those of the
    /// uncentered data.
    fn data_length(&self) -> f64 {
        length(&self.v) + (self.v.len() as f64).sqrt() * (self.mean / self.deviation).abs()
    }
}

/// Sum of squares.
impl SmoothFunction for Line {
    fn value_and_gradient(&self, parameters: &[f64]) -> (f64, Vec<f64>) {
        let residuals = self.residuals(parameters);
        let gradient = vec![2.0 * dot(&self.u, &residuals), 2.0 * sum(&residuals)];
        (dot(&residuals, &residuals), gradient)
    }

    fn relative_gradient(&self, parameters: &[f64], gradient: &[f64]) -> f64 {
        let (slope, constant) = pair(gradient);
        // The part of the gradient that comes from rounding of the data counts as the tolerance.
        let rounding = ROUNDING * UNIT_ROUNDOFF * self.data_length() / TOLERANCE;
        let residual = 2.0 * (length(&self.residuals(parameters)) + rounding);
        let count = (self.u.len() as f64).sqrt();
        let angle = (slope / length(&self.u)).abs().max((constant / count).abs());
        if angle == 0.0 { 0.0 } else { angle / residual }
    }
}
