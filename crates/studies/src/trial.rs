//! What one method predicts on one draw and one split.

use crate::problem::{Ready, line};
use crate::split::Split;
use envelope::{Envelope, EnvelopeError};
use estimator::Prediction;
use results::Failure;
use scoring::HeldOutPeak;
use serde::{Deserialize, Serialize};

/// What a method made of the peaks that it saw.
#[derive(Debug, Serialize, Deserialize)]
pub struct Trial {
    /// The fitted function at every peak of the problem; `None` where the method makes no prediction.
    pub curve: Option<Vec<Prediction>>,
    /// The 95 % interval of λ that it states, in 1/s.
    pub rate_interval: Option<[f64; 2]>,
    /// Law that it discovered.
    pub equation: Option<String>,
    /// Whether its optimizer converged.
    pub converged: bool,
    /// Duration of the fit, in s.
    pub seconds: f64,
}

/// The envelope of the peaks that the fit sees. The first peak is among them, so that times stay what they
/// are.
///
/// # Errors
/// [`EnvelopeError`] where the peaks that are left make no envelope.
pub fn seen(envelope: &Envelope, split: &Split) -> Result<Envelope, EnvelopeError> {
    let of = |values: &[f64]| split.seen_of(values);
    Envelope::new(of(envelope.times_s()), of(envelope.log_amplitudes()), envelope.omega_rad_s())
}

/// The best exponential through the peaks that the split leaves, at every peak, with the standard deviation
/// of a measured ln A about it under independent scatter of one variance.
///
/// # Errors
/// A sentence that says why there is no line.
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

/// The held-out peaks of a trial with the block that each belongs to; `None` where nothing is predicted.
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
