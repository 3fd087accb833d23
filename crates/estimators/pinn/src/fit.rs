//! Training of the network.

use crate::config::PinnConfig;
use crate::objective::{BESIDE, Objective};
use envelope::Envelope;
use estimator::{
    Estimate, Estimator, FitContext, FitError, ModelFile, Prediction, Reached, Scaling, Step, Uncertainty,
};
use nalgebra::DVector;
use neural::{
    AffineSkipNetwork, Laplace, LeastSquares, LevenbergMarquardt, Linearization, Minimum, NamedTensor,
    device, tensor, to_safetensors, values,
};
use rand::RngExt;
use std::ops::ControlFlow;

/// Fewest peaks that leave the interval a degree of freedom.
const FEWEST_PEAKS: usize = 4;

impl Estimator for PinnConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        if envelope.len() < FEWEST_PEAKS {
            return Err(FitError::TooFewPeaks {
                estimator: "pinn",
                found: envelope.len(),
                needed: FEWEST_PEAKS,
            });
        }
        let scaling = Scaling::of(envelope)?;
        let device = device()?;
        let collocation = self.collocation(context);
        let objective = Objective {
            hidden: &self.hidden,
            device: &device,
            times: &context.input("times", scaling.centered_times(envelope)),
            targets: &scaling.scaled_logs(envelope),
            collocation: &collocation,
            physics_weight: self.physics_weight,
            network_at_zero: context.is_at_zero(),
        };
        let max_steps = context.step_limit(self.training.max_steps);
        let method = LevenbergMarquardt { max_steps, ..self.training };
        let phase = format!("Levenberg-Marquardt, physics weight {}", self.physics_weight);
        let minimum = method.minimize(&objective, &self.start(context), context, |state| {
            context.observe(&Step {
                step: state.step,
                planned: method.max_steps,
                phase: phase.clone(),
                loss: state.loss,
                decay_rate: scaling.rate_per_centered_time(rate_of(state.parameters)),
            });
            if context.is_canceled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if !minimum.loss.is_finite() {
            return Err(FitError::NotFinite { loss: minimum.loss });
        }
        describe(&scaling, &objective, &minimum, context.query_times())
    }
}

impl PinnConfig {
    /// Draws one point in each of equal parts of −1..1.
    fn collocation(&self, context: &FitContext<'_>) -> Vec<f64> {
        let mut generator = context.seed("collocation").generator();
        let parts = self.collocation_points as f64;
        (0..self.collocation_points)
            .map(|part| {
                let within: f64 = generator.random();
                2.0 * (part as f64 + within) / parts - 1.0
            })
            .collect()
    }

    /// Draws the start values: those of the network, then λ, uniform in −scale..scale. In scaled units an
    /// envelope that is nearly a line has λ near 1.7, so that the start is never the answer.
    fn start(&self, context: &FitContext<'_>) -> DVector<f64> {
        let mut generator = context.seed("initial weights").generator();
        let mut parameters =
            AffineSkipNetwork::draw_parameters(&self.hidden, self.initial_scale, &mut generator);
        let uniform: f64 = context.seed("initial decay rate").generator().random();
        parameters.push(self.initial_scale * (2.0 * uniform - 1.0));
        if context.is_at_zero() {
            // The line beside the network and λ keep their values.
            let held = parameters.len().saturating_sub(BESIDE);
            parameters.iter_mut().take(held).for_each(|weight| *weight = 0.0);
        }
        DVector::from_vec(parameters)
    }
}

/// Returns λ in scaled units: the last entry of a vector of parameters.
fn rate_of(parameters: &DVector<f64>) -> f64 {
    parameters.iter().next_back().copied().unwrap_or(f64::NAN)
}

fn describe(
    scaling: &Scaling,
    objective: &Objective<'_>,
    minimum: &Minimum,
    query_times: &[f64],
) -> Result<Estimate, FitError> {
    let (network, rate) = objective.model(&minimum.parameters)?;
    let column = tensor(objective.times.to_vec(), [objective.times.len(), 1], objective.device);
    let fitted: Vec<f64> =
        values(network.forward(&column))?.into_iter().map(|z| scaling.log_amplitude(z)).collect();
    let mut tensors = network.named_tensors()?;
    tensors.push(NamedTensor { name: "decay_rate".to_owned(), shape: vec![1], values: vec![rate] });
    let stop = LevenbergMarquardt::stop(minimum);
    let laplace = match stop.reached {
        // Away from the minimum the Laplace approximation does not hold.
        Reached::Converged => laplace(objective, &minimum.parameters)?,
        _ => None,
    };
    let uncertainty = laplace.as_ref().and_then(|laplace| {
        let error = laplace.deviation(&of_rate(minimum.parameters.len()));
        let error = scaling.rate_per_centered_time(error);
        Uncertainty::students_t(scaling.rate_per_centered_time(rate), error, laplace.degrees_of_freedom())
    });
    Ok(Estimate {
        decay_rate: scaling.rate_per_centered_time(rate),
        // The network's own value at the first peak, where the envelope's time is zero.
        log_amplitude: fitted.first().copied().unwrap_or(f64::NAN),
        uncertainty,
        stop,
        steps: minimum.steps,
        parameters: minimum.parameters.len(),
        fitted_log_amplitudes: fitted,
        predictions: predictions(scaling, objective, &network, laplace.as_ref(), query_times)?,
        equation: None,
        model: Some(ModelFile { name: "weights.safetensors".to_owned(), bytes: to_safetensors(&tensors)? }),
    })
}

/// Computes the Laplace approximation about the trained parameters, with the physics term as a prior.
///
/// The degrees of freedom are the number of peaks minus the trace of the map from data to fitted values, so
/// that a more flexible network has fewer of them. `None` if no degree of freedom is left.
fn laplace(objective: &Objective<'_>, parameters: &DVector<f64>) -> Result<Option<Laplace>, FitError> {
    let linearized = objective.linearize(parameters)?;
    Ok(Laplace::about(&linearized, objective.times.len(), |peaks, hat| peaks - hat.trace()))
}

/// Returns the derivatives of λ by the parameters; λ is the last parameter.
fn of_rate(parameters: usize) -> DVector<f64> {
    DVector::from_fn(parameters, |at, _| if at + 1 == parameters { 1.0 } else { 0.0 })
}

/// Predicts by the network at the query times. The physics holds it within the record only; beyond, the
/// predictive deviation grows as the weights leave it free.
fn predictions(
    scaling: &Scaling,
    objective: &Objective<'_>,
    network: &AffineSkipNetwork,
    laplace: Option<&Laplace>,
    query_times: &[f64],
) -> Result<Vec<Prediction>, FitError> {
    if query_times.is_empty() {
        return Ok(Vec::new());
    }
    let times: Vec<f64> = query_times.iter().map(|&time| scaling.centered_time(time)).collect();
    let Linearization { values, jacobian } = network.linearize_values(&times, objective.device)?;
    let predict = |(at, value): (usize, f64)| {
        let std_error = laplace.map(|laplace| {
            // λ has no effect on the network's values.
            let own = jacobian.row(at).transpose();
            let gradient = own.push(0.0);
            scaling.deviation(laplace.predictive_deviation(&gradient))
        });
        Prediction::new(scaling.log_amplitude(value), std_error)
    };
    Ok(values.into_iter().enumerate().map(predict).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ENTRY;
    use estimator::{Cancel, Observer, Reached, Silent};
    use seed::Seed;
    use settings::{Document, Resolved, Section};
    use std::cell::RefCell;

    fn config() -> PinnConfig {
        let sections = [Section { name: "estimator", fields: ENTRY.fields }];
        let resolved = Resolved::new(&Document::default(), &sections).unwrap();
        resolved.section("estimator").unwrap()
    }

    /// Returns an envelope that is no exponential: it bends and scatters.
    fn envelope() -> Envelope {
        conformance::bent().unwrap()
    }

    /// Returns minus the slope of the least-squares line, and its standard error, by the textbook formulas.
    fn line(envelope: &Envelope) -> (f64, f64) {
        let (t, y) = (envelope.times_s(), envelope.log_amplitudes());
        let n = t.len() as f64;
        let (mt, my) = (t.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let sxx: f64 = t.iter().map(|t| (t - mt).powi(2)).sum();
        let sxy: f64 = t.iter().zip(y).map(|(t, y)| (t - mt) * (y - my)).sum();
        let slope = sxy / sxx;
        let rss: f64 = t.iter().zip(y).map(|(t, y)| (y - my - slope * (t - mt)).powi(2)).sum();
        (-slope, (rss / (n - 2.0) / sxx).sqrt())
    }

    fn fit(seed: u64, max_steps: Option<u64>, observer: &dyn Observer) -> Estimate {
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(seed).child("pinn"), max_steps, observer, &cancel);
        config().fit(&envelope(), &context).unwrap()
    }

    #[test]
    fn trained_it_agrees_with_the_line_and_its_error() {
        let (rate, std_error) = line(&envelope());
        for seed in 0..3 {
            let estimate = fit(seed, None, &Silent);
            let off = (estimate.decay_rate / rate - 1.0).abs();
            assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
            assert!(off < 1e-6, "{off:e}");
            let stated = estimate.uncertainty.unwrap().std_error;
            assert!((stated / std_error - 1.0).abs() < 1e-2, "{stated} {std_error}");
        }
    }

    #[test]
    fn untrained_it_is_wrong_on_every_seed() {
        let (rate, _) = line(&envelope());
        for seed in 0..20 {
            let estimate = fit(seed, Some(0), &Silent);
            assert!((estimate.decay_rate / rate - 1.0).abs() > 0.01, "seed {seed}");
            assert_eq!(estimate.stop.reached, Reached::BudgetSpent);
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bits_and_another_another_way() {
        let [one, same, other] = [1, 1, 2].map(|seed| fit(seed, Some(5), &Silent));
        assert_eq!(one, same);
        assert_ne!(one.decay_rate.to_bits(), other.decay_rate.to_bits());
    }

    #[test]
    fn every_step_is_told_once() {
        struct Steps(RefCell<Vec<u64>>);
        impl Observer for Steps {
            fn observe(&self, step: &Step) {
                self.0.borrow_mut().push(step.step);
            }
        }
        let steps = Steps(RefCell::default());
        let estimate = fit(0, None, &steps);
        assert_eq!(*steps.0.borrow(), (0..=estimate.steps).collect::<Vec<_>>());
    }

    #[test]
    fn a_request_to_stop_is_heard() {
        let cancel = Cancel::new();
        cancel.request();
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
        let estimate = config().fit(&envelope(), &context).unwrap();
        assert_eq!((estimate.stop.reached, estimate.steps), (Reached::Interrupted, 0));
    }

    #[test]
    fn a_constant_envelope_is_refused() {
        let flat = Envelope::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.3; 4], 6.0).unwrap();
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
        assert!(matches!(config().fit(&flat, &context), Err(FitError::NoSpread { .. })));
    }

    fn fit_at(envelope: &Envelope, seed: u64, times: &[f64]) -> Estimate {
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(seed).child("pinn"), None, &Silent, &cancel);
        config().fit(envelope, &context.predicting_at(times)).unwrap()
    }

    #[test]
    fn at_the_peaks_predictions_are_the_fitted_function() {
        let estimate = fit_at(&envelope(), 0, envelope().times_s());
        assert_eq!(estimate.predictions.len(), 69);
        for (prediction, fitted) in estimate.predictions.iter().zip(&estimate.fitted_log_amplitudes) {
            assert!((prediction.log_amplitude - fitted).abs() < 1e-9);
        }
        // Asking for predictions changes nothing else.
        assert_eq!(Estimate { predictions: Vec::new(), ..estimate }, fit(0, None, &Silent));
    }

    #[test]
    fn an_exponential_is_extrapolated_and_less_is_known_the_farther_off() {
        let times = [-3.0, 10.0, 25.0, 40.0, 80.0];
        let envelope = conformance::scattered(69, 0.2, 0.05, &Seed::new(1)).unwrap();
        let estimate = fit_at(&envelope, 0, &times);
        for (time, found) in times.iter().zip(&estimate.predictions) {
            let off = (found.log_amplitude + 0.6 + 0.2 * time).abs();
            assert!(off < 3.0 * found.std_error.unwrap(), "{time}: {off} {found:?}");
        }
        let errors: Vec<f64> = estimate.predictions.iter().map(|found| found.std_error.unwrap()).collect();
        // Near the record the error is that of a straight line; four lengths away the weights leave much
        // freedom.
        assert!(errors[2] < 1.1 * errors[1] && errors[4] > 10.0 * errors[1], "{errors:?}");
        let pure = fit_at(&conformance::exponential(69, -0.6, 0.2).unwrap(), 0, &times[..3]);
        for (time, found) in times.iter().zip(&pure.predictions) {
            let off = (found.log_amplitude + 0.6 + 0.2 * time).abs();
            assert!(off < 1e-5, "{time}: {off:e}");
        }
    }

    #[test]
    fn predictive_intervals_hold_fresh_peaks() {
        let (mut held, replicates) = (0, 8);
        // Times from the first peak to a third of the record beyond the last.
        let times: Vec<f64> = (0..20).map(|i| 0.55 * f64::from(i)).collect();
        for replicate in 0..replicates {
            let seed = Seed::new(replicate).child("fresh");
            let envelope = conformance::scattered(30, 0.2, 0.1, &seed.child("peaks")).unwrap();
            // Scatter without a decay, to be added to the truth at the query times.
            let fresh = conformance::scattered(20, 0.0, 0.1, &seed.child("new")).unwrap();
            let found = fit_at(&envelope, replicate, &times).predictions;
            held += found
                .iter()
                .zip(times.iter().zip(fresh.log_amplitudes()))
                .filter(|(found, (time, fresh))| {
                    let off = *fresh - 0.2 * *time - found.log_amplitude;
                    // Quantile of Student's t with 28 degrees of freedom.
                    off.abs() <= 2.0484 * found.std_error.unwrap()
                })
                .count();
        }
        let count = (20 * replicates) as f64;
        let share = held as f64 / count;
        // The bounds are four standard deviations of such a share.
        assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / count).sqrt(), "{share}");
    }
}
