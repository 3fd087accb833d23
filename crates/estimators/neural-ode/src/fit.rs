//! Training.

use crate::config::NeuralOdeConfig;
use crate::field::VectorField;
use crate::objective::Objective;
use crate::scaling::Scaling;
use envelope::Envelope;
use estimator::{Estimate, Estimator, FitContext, FitError, ModelFile, Reached, Step, Stop, Uncertainty};
use nalgebra::{Cholesky, DMatrix, DVector};
use neural::{LeastSquares, LevenbergMarquardt, Minimum, NamedTensor, StopReason, device, to_safetensors};
use rand_distr::{Distribution, StandardNormal};
use std::ops::ControlFlow;

/// Fewest peaks that tell a bend from a line.
const FEWEST_PEAKS: usize = 3;

impl Estimator for NeuralOdeConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        if envelope.len() < FEWEST_PEAKS {
            return Err(FitError::TooFewPeaks {
                estimator: "neural-ode",
                found: envelope.len(),
                needed: FEWEST_PEAKS,
            });
        }
        let scaling = Scaling::of(envelope)?;
        let device = device()?;
        let (times, targets) = (scaling.scaled_times(envelope), scaling.scaled_logs(envelope));
        let objective = Objective::new(self, &device, &times, &targets);
        let method = LevenbergMarquardt {
            max_steps: context.step_limit(self.max_steps),
            loss_tolerance: self.loss_tolerance,
        };
        // λ of the state in force: a rejected step leaves both as they were.
        let mut told: Option<(DVector<f64>, f64)> = None;
        let minimum = method.minimize(&objective, self.start(context), |state| {
            let known = told.take().filter(|(of, _)| of == state.parameters);
            let decay_rate = known.map_or_else(
                || {
                    // This state has just been solved: nothing can fail that has not failed before.
                    let fitted = objective.fitted(state.parameters).unwrap_or_default();
                    scaling.rate(-objective.projected_slope(&fitted))
                },
                |(_, rate)| rate,
            );
            context.observe(&Step {
                step: state.step,
                planned: method.max_steps,
                phase: "Levenberg-Marquardt through the solver".to_owned(),
                loss: state.loss,
                decay_rate,
            });
            told = Some((state.parameters.clone(), decay_rate));
            if context.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if !minimum.loss.is_finite() {
            return Err(FitError::NotFinite { loss: minimum.loss });
        }
        describe(&scaling, &objective, &minimum)
    }
}

impl NeuralOdeConfig {
    /// Start values: the field's, then the initial state, normal. In scaled units an envelope that is
    /// nearly a line has a slope of about 1.7: a drawn field is not the answer.
    fn start(&self, context: &FitContext<'_>) -> DVector<f64> {
        let mut generator = context.seed("initial weights").generator();
        let mut parameters = VectorField::draw_parameters(&self.hidden, self.initial_scale, &mut generator);
        let normal: f64 = StandardNormal.sample(&mut context.seed("initial state").generator());
        parameters.push(self.initial_scale * normal);
        DVector::from_vec(parameters)
    }
}

fn stop(minimum: &Minimum) -> Stop {
    let steps = minimum.steps;
    let (reached, because) = match minimum.reason {
        StopReason::Settled => (
            Reached::Converged,
            format!("the last step lowered the loss by {:.0e} of itself", minimum.last_gain),
        ),
        StopReason::Stationary => {
            (Reached::Converged, "no step lowers the loss or its gradient any more".to_owned())
        }
        StopReason::StepsSpent => (
            Reached::BudgetSpent,
            format!("the budget of {steps} steps ended; raise estimator.max_steps or fit.max_steps"),
        ),
        StopReason::NotFinite => (
            Reached::Diverged,
            format!("the loss is not finite after {steps} steps; lower estimator.initial_scale"),
        ),
        StopReason::Interrupted => (Reached::Interrupted, format!("interrupted after {steps} steps")),
    };
    Stop { reached, because }
}

fn describe(scaling: &Scaling, objective: &Objective<'_>, minimum: &Minimum) -> Result<Estimate, FitError> {
    let (field, initial) = objective.model(&minimum.parameters)?;
    let scaled = objective.fitted(&minimum.parameters)?;
    let fitted: Vec<f64> = scaled.iter().map(|&z| scaling.log_amplitude(z)).collect();
    let decay_rate = scaling.rate(-objective.projected_slope(&scaled));
    let mut tensors = field.named_tensors()?;
    tensors.push(NamedTensor { name: "initial_state".to_owned(), shape: vec![1], values: vec![initial] });
    Ok(Estimate {
        decay_rate,
        // The trajectory's own start: the envelope's time is zero at the first peak.
        log_amplitude: fitted.first().copied().unwrap_or(f64::NAN),
        uncertainty: uncertainty(scaling, objective, minimum, decay_rate)?,
        stop: stop(minimum),
        steps: minimum.steps,
        parameters: minimum.parameters.len(),
        fitted_log_amplitudes: fitted,
        predictions: Vec::new(),
        equation: None,
        model: Some(ModelFile { name: "weights.safetensors".to_owned(), bytes: to_safetensors(&tensors)? }),
    })
}

/// Laplace approximation about the trained parameters for the projected slope: a Gaussian posterior
/// whose precision A is the loss's Gauss–Newton matrix over the residual variance, the curvature and
/// weight terms acting as a prior; the slope's variance is gᵀA⁻¹g with its gradient g.
///
/// The residual variance is the residual sum of squares over n − 2·tr H + tr H², with H = JA⁻¹Jᵀ the map
/// from data to fitted values: the expectation of that sum for a linear smoother, so that a trajectory
/// that bends pays for it. On a bent envelope the interval is narrower than a line's, which takes the bend
/// for scatter: it is one for the slope of the line through the bent function. `None` where less than one
/// degree of freedom is left.
///
/// References: MacKay, Neural Computation 4 (1992) 448; Hastie, Tibshirani, Generalized Additive Models
/// (Chapman and Hall 1990), section 3.5.
fn uncertainty(
    scaling: &Scaling,
    objective: &Objective<'_>,
    minimum: &Minimum,
    decay_rate: f64,
) -> Result<Option<Uncertainty>, FitError> {
    let linearized = objective.linearize(&minimum.parameters)?;
    let jacobian = &linearized.jacobian;
    let all = jacobian.tr_mul(jacobian);
    // Directions that neither data nor curvature see keep a wide prior.
    let prior = DMatrix::from_diagonal_element(all.nrows(), all.ncols(), 1e-12 * all.diagonal().max());
    let Some(factor) = Cholesky::new(all + prior) else {
        return Ok(None);
    };
    let peaks = objective.peaks();
    let data = jacobian.rows(0, peaks);
    // tr H = tr A⁻¹JᵀJ: parameters by parameters, however many peaks there are.
    let hat = factor.solve(&data.tr_mul(&data));
    let degrees = peaks as f64 - 2.0 * hat.trace() + (&hat * &hat).trace();
    if degrees < 1.0 {
        return Ok(None);
    }
    // The rows of peaks carry 1/√peaks each; undo it for a variance per peak.
    let mean_square = linearized.residuals.rows(0, peaks).norm_squared();
    let variance = mean_square * peaks as f64 / degrees;
    let gradient = objective.slope_gradient(jacobian);
    let slope_variance = gradient.dot(&factor.solve(&gradient)) * variance / peaks as f64;
    Ok(Uncertainty::students_t(decay_rate, scaling.rate(slope_variance.sqrt()), degrees))
}
