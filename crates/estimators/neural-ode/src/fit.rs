//! Training of the vector field.

use crate::config::NeuralOdeConfig;
use crate::field::VectorField;
use crate::objective::{BESIDE, Objective, Reading};
use envelope::Envelope;
use estimator::{
    Estimate, Estimator, FitContext, FitError, ModelFile, Prediction, Reached, Scaling, Step, Uncertainty,
};
use nalgebra::DVector;
use neural::{
    Laplace, LeastSquares, LevenbergMarquardt, Linearized, Minimum, NamedTensor, device, to_safetensors,
};
use rand_distr::{Distribution, StandardNormal};
use std::ops::ControlFlow;

/// Fewest peaks with which a bend can be told from a line.
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
        let times = context.input("times", scaling.centered_times(envelope));
        let targets = scaling.scaled_logs(envelope);
        let objective = Objective::new(self, &device, &times, &targets, context.is_at_zero());
        let max_steps = context.step_limit(self.training.max_steps);
        let method = LevenbergMarquardt { max_steps, ..self.training };
        // λ of the current state: a rejected step leaves both unchanged.
        let mut told: Option<(DVector<f64>, f64)> = None;
        let minimum = method.minimize(&objective, &self.start(context), context, |state| {
            let known = told.take().filter(|(of, _)| of == state.parameters);
            let decay_rate = known.map_or_else(
                || {
                    // This state has just been solved, so that it cannot fail here.
                    let rate = |fitted| scaling.rate_per_centered_time(-objective.projected_slope(&fitted));
                    objective.fitted(state.parameters).map_or(f64::NAN, rate)
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
            if context.is_canceled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if !minimum.loss.is_finite() {
            return Err(FitError::NotFinite { loss: minimum.loss });
        }
        describe(&scaling, &objective, &minimum, context.query_times())
    }
}

impl NeuralOdeConfig {
    /// Draws the start values: those of the field, then the initial state, which is normal. In scaled units
    /// an envelope that is nearly a line has a slope of about 1.7, so that a drawn field is not the answer.
    fn start(&self, context: &FitContext<'_>) -> DVector<f64> {
        let mut generator = context.seed("initial weights").generator();
        let mut parameters = VectorField::draw_parameters(&self.hidden, self.initial_scale, &mut generator);
        let normal: f64 = StandardNormal.sample(&mut context.seed("initial state").generator());
        parameters.push(self.initial_scale * normal);
        if context.is_at_zero() {
            // The constant part c and the initial state keep their values.
            let held = parameters.len().saturating_sub(BESIDE);
            parameters.iter_mut().take(held).for_each(|weight| *weight = 0.0);
        }
        DVector::from_vec(parameters)
    }
}

fn describe(
    scaling: &Scaling,
    objective: &Objective<'_>,
    minimum: &Minimum,
    query_times: &[f64],
) -> Result<Estimate, FitError> {
    let (field, initial) = objective.model(&minimum.parameters)?;
    let scaled = objective.fitted(&minimum.parameters)?;
    let fitted: Vec<f64> = scaled.iter().map(|&z| scaling.log_amplitude(z)).collect();
    let decay_rate = scaling.rate_per_centered_time(-objective.projected_slope(&scaled));
    let linearized = objective.linearize(&minimum.parameters)?;
    let stop = LevenbergMarquardt::stop(minimum);
    let laplace = match stop.reached {
        // Away from the minimum the Laplace approximation does not hold.
        Reached::Converged => laplace(objective, &linearized),
        _ => None,
    };
    let uncertainty = laplace.as_ref().and_then(|laplace| {
        let error = laplace.deviation(&objective.slope_gradient(&linearized.jacobian));
        let error = scaling.rate_per_centered_time(error);
        Uncertainty::students_t(decay_rate, error, laplace.degrees_of_freedom())
    });
    let mut tensors = field.named_tensors()?;
    tensors.push(NamedTensor { name: "initial_state".to_owned(), shape: vec![1], values: vec![initial] });
    Ok(Estimate {
        decay_rate,
        // The trajectory's own start, since the envelope's time is zero at the first peak.
        log_amplitude: fitted.first().copied().unwrap_or(f64::NAN),
        uncertainty,
        stop,
        steps: minimum.steps,
        parameters: minimum.parameters.len(),
        fitted_log_amplitudes: fitted,
        predictions: predictions(scaling, objective, &minimum.parameters, laplace.as_ref(), query_times)?,
        equation: None,
        model: Some(ModelFile { name: "weights.safetensors".to_owned(), bytes: to_safetensors(&tensors)? }),
    })
}

/// Computes the Laplace approximation about the trained parameters, with the curvature and weight terms as a
/// prior.
///
/// The residual variance is the residual sum of squares over n − 2·tr H + tr H², with H = JA⁻¹Jᵀ the map from
/// data to fitted values. This is the expectation of that sum for a linear smoother, so that a more flexible
/// trajectory has fewer degrees of freedom. On a bent envelope the interval of λ is narrower than a line's,
/// which treats the bend as scatter; it is an interval for the slope of the line through the bent function.
/// `None` if less than one degree of freedom is left.
///
/// Reference: Hastie, Tibshirani, Generalized Additive Models (Chapman and Hall 1990), section 3.5.
fn laplace(objective: &Objective<'_>, linearized: &Linearized) -> Option<Laplace> {
    Laplace::about(linearized, objective.peaks(), |peaks, hat| {
        peaks - 2.0 * hat.trace() + (hat * hat).trace()
    })
}

/// Follows the field to the query times; NaN where they are too far away.
fn predictions(
    scaling: &Scaling,
    objective: &Objective<'_>,
    parameters: &DVector<f64>,
    laplace: Option<&Laplace>,
    query_times: &[f64],
) -> Result<Vec<Prediction>, FitError> {
    if query_times.is_empty() {
        return Ok(Vec::new());
    }
    let times: Vec<f64> = query_times.iter().map(|&time| scaling.centered_time(time)).collect();
    let predict = |reading: Option<Reading>| {
        let Some(Reading { value, gradient }) = reading else { return Prediction::new(f64::NAN, None) };
        let std_error = laplace.map(|laplace| scaling.deviation(laplace.predictive_deviation(&gradient)));
        Prediction::new(scaling.log_amplitude(value), std_error)
    };
    Ok(objective.readings(parameters, &times)?.into_iter().map(predict).collect())
}
