//! One method on one draw and one split.

use crate::error::TrainerError;
use crate::fit::FitSetting;
use crate::method::Method;
use crate::predict::problem::{Ready, line};
use crate::predict::split::Split;
use crate::progress::Progress;
use crate::resume::Ledger;
use envelope::{Envelope, EnvelopeError};
use estimator::{Cancel, Prediction, Reached, Silent};
use runs::result::NOT_BEGUN;
use scoring::HeldOutPeak;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// What a method made of the peaks that it saw.
#[derive(Serialize, Deserialize)]
pub(crate) struct Trial {
    /// The fitted function at every peak of the problem; `None` where the method makes no prediction.
    pub(crate) curve: Option<Vec<Prediction>>,
    /// The 95 % interval of λ that it states, in 1/s.
    pub(crate) rate_interval: Option<[f64; 2]>,
    pub(crate) equation: Option<String>,
    pub(crate) converged: bool,
    pub(crate) seconds: f64,
}

/// Why a trial has no outcome: the method's own sentence.
pub(crate) type Failure = String;

/// What every trial of a study shares.
pub(crate) struct Trials<'a> {
    pub(crate) max_steps: Option<u64>,
    pub(crate) progress: &'a Progress,
    pub(crate) cancel: &'a Cancel,
    pub(crate) ledger: &'a Ledger,
}

impl Trials<'_> {
    /// Fits the peaks that the split leaves and asks for all, unless that was done before and kept under the name.
    pub(crate) fn run(
        &self,
        name: &str,
        method: &Method,
        envelope: &Envelope,
        split: &Split,
        seed: u64,
    ) -> Result<Result<Trial, Failure>, TrainerError> {
        if let Some(trial) = self.ledger.finished(name)? {
            return Ok(Ok(trial));
        }
        if self.cancel.is_requested() {
            return Ok(Err(NOT_BEGUN.to_owned()));
        }
        let trial = self.make(method, envelope, split, seed);
        match &trial {
            // It may have been stopped halfway.
            Ok(_) if self.cancel.is_requested() => return Ok(Err(NOT_BEGUN.to_owned())),
            Ok(made) => self.ledger.keep(name, made, made.seconds)?,
            Err(_) => {}
        }
        Ok(trial)
    }

    fn make(&self, method: &Method, envelope: &Envelope, split: &Split, seed: u64) -> Result<Trial, Failure> {
        let seen = seen(envelope, split).map_err(|error| error.to_string())?;
        let setting = FitSetting {
            envelope: &seen,
            query_times: envelope.times_s(),
            max_steps: self.max_steps,
            progress: self.progress,
            cancel: self.cancel,
            ledger: None,
        };
        let start = Instant::now();
        let estimate = method.fit(&seen, seed, &setting, &Silent, None).map_err(|error| error.to_string())?;
        let seconds = start.elapsed().as_secs_f64();
        let is_complete = estimate.predictions.len() == envelope.len();
        Ok(Trial {
            curve: is_complete.then_some(estimate.predictions),
            rate_interval: estimate.uncertainty.map(|known| known.interval_95),
            equation: estimate.equation,
            converged: estimate.stop.reached == Reached::Converged,
            seconds,
        })
    }
}

/// The envelope of the peaks that the fit sees. The first peak is among them, so that times stay what they
/// are.
fn seen(envelope: &Envelope, split: &Split) -> Result<Envelope, EnvelopeError> {
    let of = |values: &[f64]| split.seen_of(values);
    Envelope::new(of(envelope.times_s()), of(envelope.log_amplitudes()), envelope.omega_rad_s())
}

/// The best exponential through the peaks that the split leaves, at every peak, with the standard deviation
/// of a measured ln A about it under independent scatter of one variance.
pub(crate) fn best_exponential(
    problem: &Ready,
    envelope: &Envelope,
    split: &Split,
) -> Result<Trial, Failure> {
    let seen = seen(envelope, split).map_err(|error| error.to_string())?;
    let fit = line(&problem.id, &seen).map_err(|error| error.to_string())?;
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
