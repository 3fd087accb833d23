//! Fit of the simulated envelope to the measured one.

use crate::config::EnvelopeMatchingConfig;
use crate::matching::{Linearized, Matching, Reading};
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError, Prediction, Reached, Step, Stop, Uncertainty};
use nalgebra::{Matrix2, Vector2};
use rand::RngExt;

/// Fewest peaks: two parameters and a degree of freedom.
const FEWEST_PEAKS: usize = 3;

/// Most rejected steps in a row, after which the point counts as the best one.
const MOST_REJECTIONS: u32 = 12;

/// Predicted decrease of the loss, as a share of the loss, below which it cannot be told from rounding.
const ROUNDING_SHARE: f64 = 1e-10;

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

    /// Minimizes the loss by Levenberg–Marquardt with Nielsen's update of the damping. Near the minimum,
    /// where the decrease of the loss is below rounding, a step is accepted if it lowers the gradient.
    ///
    /// Reference: Marquardt, SIAM J. Appl. Math. 11 (1963) 431; Nielsen, report IMM-REP-1999-05 (DTU 1999).
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
        let mut damping = 1e-6 * at.normal.diagonal().max();
        let (mut growth, mut rejections, mut steps) = (2.0, 0, 0);
        let mut last_step = f64::INFINITY;
        let (reached, because) = loop {
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
            if rejections >= MOST_REJECTIONS {
                let because = "no step lowers the misfit or its gradient any more".to_owned();
                break (Reached::Converged, because);
            }
            if steps >= max_steps {
                let because =
                    format!("the budget of {steps} steps ended; raise estimator.max_steps or fit.max_steps");
                break (Reached::BudgetSpent, because);
            }
            steps += 1;
            let damped = at.normal + Matrix2::from_diagonal_element(damping);
            let step = damped.cholesky().map(|factor| -factor.solve(&at.gradient));
            last_step = step.map_or(f64::INFINITY, |step| step.norm() / (1.0 + parameters.norm()));
            let trial = step.and_then(|step| {
                let next = matching.linearize(&(parameters + step))?;
                gain(&at, &next, &step, damping).map(|gain| (step, next, gain))
            });
            match trial {
                Some((step, next, gain)) => {
                    parameters += step;
                    at = next;
                    damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
                    growth = 2.0;
                    rejections = 0;
                }
                None => {
                    damping *= growth;
                    growth *= 2.0;
                    rejections += 1;
                }
            }
        };
        Ok(Found { parameters, at, steps, stop: Stop { reached, because } })
    }
}

/// Returns the ratio of the actual to the predicted decrease; `None` if the step is to be rejected.
fn gain(at: &Linearized, next: &Linearized, step: &Vector2<f64>, damping: f64) -> Option<f64> {
    // The predicted decrease is ‖r‖² − ‖r + J·s‖² = sᵀ(μ·s − g) for the damped step s.
    let predicted = step.dot(&(step * damping - at.gradient));
    if predicted <= ROUNDING_SHARE * at.loss {
        let flatter = next.gradient.norm() < at.gradient.norm();
        return (flatter && next.loss <= at.loss * (1.0 + ROUNDING_SHARE)).then_some(1.0);
    }
    (next.loss < at.loss).then(|| ((at.loss - next.loss) / predicted).min(1.0))
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
