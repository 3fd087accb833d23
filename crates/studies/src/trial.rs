//! Predictions of one method on one draw and one split.

use crate::problem::{Ready, line};
use crate::split::Split;
use envelope::{Envelope, EnvelopeError};
use estimator::Prediction;
use results::Failure;
use scoring::HeldOutPeak;
use serde::{Deserialize, Serialize};

/// Result of fitting a method to the peaks that are not held out.
#[derive(Debug, Serialize, Deserialize)]
pub struct Trial {
    /// Fitted function at every peak of the problem; `None` if the method makes no prediction.
    pub curve: Option<Vec<Prediction>>,
    /// Stated 95 % interval of λ, in 1/s; `None` if the method states none.
    pub rate_interval: Option<[f64; 2]>,
    /// Law that the method discovered.
    pub equation: Option<String>,
    /// `true` if the method's optimizer converged.
    pub converged: bool,
    /// Duration of the fit, in s.
    pub seconds: f64,
}

/// Returns the envelope of the fitted peaks. The first peak is always among them, so that the times keep
/// their origin.
///
/// # Errors
/// [`EnvelopeError`] if the remaining peaks do not form an envelope.
pub fn seen(envelope: &Envelope, split: &Split) -> Result<Envelope, EnvelopeError> {
    let of = |values: &[f64]| split.seen_of(values);
    Envelope::new(of(envelope.times_s()), of(envelope.log_amplitudes()), envelope.omega_rad_s())
}

/// Fits the best exponential to the peaks that are not held out and evaluates it at every peak, with the
/// standard deviation of a measured ln A about it, assuming independent scatter of constant variance.
///
/// # Errors
/// A sentence that says why no line can be fitted.
pub(crate) fn best_exponential(
    problem: &Ready,
    envelope: &Envelope,
    split: &Split,
) -> Result<Trial, Failure> {
    let seen = seen(envelope, split).map_err(|error| Failure::of(&error))?;
    let fit = line(&problem.id, &seen).map_err(|error| Failure::of(&error))?;
    let count = seen.len() as f64;
    let mean = seen.times_s().iter().sum::<f64>() / count;
    let spread = seen.times_s().iter().map(|time| (time - mean).powi(2)).sum::<f64>().sqrt();
    let scatter = fit.std_error * spread;
    let at = |&time: &f64| {
        let leverage = 1.0 / count + ((time - mean) / spread).powi(2);
        let std_error = scatter * (1.0 + leverage).sqrt();
        Prediction::new(fit.log_amplitude_at(time), Some(std_error))
    };
    Ok(Trial {
        curve: Some(envelope.times_s().iter().map(at).collect()),
        rate_interval: Some(fit.interval_95),
        equation: None,
        converged: true,
        seconds: 0.0,
    })
}

/// Returns the held-out peaks of a trial, each with its block; `None` if nothing is predicted.
pub(crate) fn held_out(trial: &Trial, observed: &[f64], split: &Split) -> Option<Vec<(usize, HeldOutPeak)>> {
    let curve = trial.curve.as_ref()?;
    let peaks =
        curve.iter().zip(observed).zip(&split.held_out).filter_map(|((prediction, &observed), block)| {
            let peak = HeldOutPeak {
                observed,
                predicted: prediction.log_amplitude,
                std_error: prediction.std_error,
            };
            Some(((*block)?, peak))
        });
    Some(peaks.collect())
}
