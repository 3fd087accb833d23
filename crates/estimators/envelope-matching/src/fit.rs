//! Fit of the simulated envelope to the measured one.

use crate::config::EnvelopeMatchingConfig;
use crate::matching::{Linearized, Matching, Reading};
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError, Prediction, Reached, Step, Stop, Uncertainty};
use least_squares::{Descent, Method, StopReason, gain_ratio};
use nalgebra::{Matrix2, Vector2};
use rand::RngExt;

/// Fewest peaks: two parameters and a degree of freedom.
const FEWEST_PEAKS: usize = 3;

struct Found {
    parameters: Vector2<f64>,
    at: Linearized,
    steps: u64,
    stop: Stop,
}

impl Found {
    /// Returns `true` if the Gauss–Newton covariance holds at the final point, as it does only at a minimum.
    fn is_minimum(&self) -> bool {
        self.stop.reached == Reached::Converged
    }
}

impl Estimator for EnvelopeMatchingConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        if envelope.len() < FEWEST_PEAKS {
            return Err(FitError::TooFewPeaks {
                estimator: "envelope-matching",
                found: envelope.len(),
                needed: FEWEST_PEAKS,
            });
        }
        let matching = Matching::new(envelope, self.steps_per_period, self.most_periods)?;
        let found = self.minimize(&matching, self.start(context), context)?;
        let decay_rate = matching.scaling.rate_per_unit_time(found.parameters.y);
        let predictions = predictions(&matching, &found, context.query_times());
        Ok(Estimate {
            decay_rate,
            log_amplitude: matching.scaling.log_amplitude(found.parameters.x),
            uncertainty: uncertainty(&matching, &found).filter(|_| found.is_minimum()),
            stop: found.stop,
            steps: found.steps,
            parameters: 2,
            fitted_log_amplitudes: found
                .at
                .fitted
                .iter()
                .map(|&z| matching.scaling.log_amplitude(z))
                .collect(),
            predictions,
            equation: None,
            model: None,
        })
    }
}

impl EnvelopeMatchingConfig {
    /// Draws both start values, uniform within plus or minus the scale.
    fn start(&self, context: &FitContext<'_>) -> Vector2<f64> {
        let draw = |name: &str| {
            let uniform: f64 = context.seed(name).generator().random();
            self.initial_scale * (2.0 * uniform - 1.0)
        };
        Vector2::new(draw("initial amplitude"), draw("initial decay rate"))
    }

    /// Minimizes the loss by Levenberg–Marquardt with Nielsen's update of the damping. See [`gain_ratio`] for the
    /// steps that are accepted.
    fn minimize(
        &self,
        matching: &Matching,
        start: Vector2<f64>,
        context: &FitContext<'_>,
    ) -> Result<Found, FitError> {
        let max_steps = context.step_limit(self.max_steps);
        let mut parameters = start;
        let mut at = matching.linearize(&start).ok_or(FitError::NotFinite { loss: f64::NAN })?;
        // The problem is nearly linear, so that the Gauss–Newton step is right from the start.
        let first = 1e-6 * at.normal.diagonal().max();
        let mut descent = Descent::new(Method { first, max_steps, ..Method::NIELSEN });
        let mut last_step = f64::INFINITY;
        let (reached, because) = loop {
            let steps = descent.steps;
            context.observe(&Step {
                step: steps,
                planned: max_steps,
                phase: "matching".to_owned(),
                loss: at.loss / matching.len() as f64,
                decay_rate: matching.scaling.rate_per_unit_time(parameters.y),
            });
            if context.is_canceled() {
                break (Reached::Interrupted, format!("interrupted after {steps} steps"));
            }
            if at.loss <= matching.rounding() && steps > 0 {
                break (Reached::Converged, "the envelopes agree to rounding".to_owned());
            }
            if last_step <= self.step_tolerance.max(matching.simulation_noise()) {
                let because = format!("the last step was {last_step:.0e} of the scaled parameters");
                break (Reached::Converged, because);
            }
            let damping = match descent.next_damping() {
                Ok(damping) => damping,
                Err(reason) => break ended(reason, steps),
            };
            let damped = at.normal + Matrix2::from_diagonal_element(damping);
            let step = damped.cholesky().map(|factor| -factor.solve(&at.gradient));
            last_step = step.map_or(f64::INFINITY, |step| step.norm() / (1.0 + parameters.norm()));
            let trial = step.and_then(|step| {
                let next = matching.linearize(&(parameters + step))?;
                // The predicted decrease is ‖r‖² − ‖r + J·s‖² = sᵀ(μ·s − g) for the damped step s.
                let predicted = step.dot(&(step * damping - at.gradient));
                let is_flatter = || next.gradient.norm() < at.gradient.norm();
                let ratio = gain_ratio([at.loss, next.loss], predicted, is_flatter)?;
                Some((step, next, ratio))
            });
            let Some((step, next, ratio)) = trial else {
                descent.reject();
                continue;
            };
            parameters += step;
            at = next;
            // The length of the step says when the fit has converged, not its gain.
            descent.accept(ratio, f64::INFINITY);
        };
        Ok(Found { parameters, at, steps: descent.steps, stop: Stop { reached, because } })
    }
}

/// Returns what a descent reached that ended before its steps were small, and why it ended.
fn ended(reason: StopReason, steps: u64) -> (Reached, String) {
    if reason == StopReason::StepsSpent {
        let raise = "raise estimator.max_steps or fit.max_steps";
        return (Reached::BudgetSpent, format!("the budget of {steps} steps ended; {raise}"));
    }
    (Reached::Converged, "no step lowers the misfit or its gradient any more".to_owned())
}

/// Returns the Gauss–Newton covariance, (JᵀJ)⁻¹ times the residual variance, with Student's t on the peaks
/// minus two degrees of freedom. It is exact if the scatter of ln A is Gaussian and independent.
fn uncertainty(matching: &Matching, found: &Found) -> Option<Uncertainty> {
    let degrees = matching.len() as f64 - 2.0;
    let variance = found.at.loss / degrees * found.at.normal.try_inverse()?.m22;
    let std_error = matching.scaling.rate_per_unit_time(variance.sqrt());
    Uncertainty::students_t(matching.scaling.rate_per_unit_time(found.parameters.y), std_error, degrees)
}

/// Returns the simulated envelope at the query times; NaN where the simulation does not reach.
///
/// The variance of a measured ln A is s²·(1 + gᵀ(JᵀJ)⁻¹g), with g the derivatives of the simulated ln A
/// there.
fn predictions(matching: &Matching, found: &Found, query_times: &[f64]) -> Vec<Prediction> {
    let scaling = &matching.scaling;
    let times: Vec<f64> = query_times.iter().map(|&time| scaling.unit_time(time)).collect();
    let variance = found.at.loss / (matching.len() as f64 - 2.0);
    let inverse = found.at.normal.try_inverse().filter(|_| found.is_minimum());
    let predict = |reading: Option<Reading>| {
        let (value, gradient) = reading.unwrap_or((f64::NAN, Vector2::zeros()));
        let leverage = inverse.map(|inverse| gradient.dot(&(inverse * gradient)));
        let std_error = leverage.map(|leverage| scaling.deviation((variance * (1.0 + leverage)).sqrt()));
        Prediction::new(scaling.log_amplitude(value), std_error)
    };
    matching.readings(&found.parameters, &times).into_iter().map(predict).collect()
}
