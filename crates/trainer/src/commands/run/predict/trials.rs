//! Fits of held-out prediction: one method on one draw and one split.

use crate::error::TrainerError;
use crate::fits::method::{Method, Request};
use crate::folders::resume::Ledger;
use envelope::Envelope;
use estimator::{Cancel, Reached, Silent};
use results::Failure;
use std::time::Instant;
use studies::{Split, Trial, seen};

/// Settings that all trials of a study share.
pub(crate) struct Trials<'a> {
    pub(crate) max_steps: Option<u64>,
    pub(crate) cancel: &'a Cancel,
    pub(crate) ledger: &'a Ledger,
}

impl Trials<'_> {
    /// Fits the peaks that are not held out and predicts all of them, unless the trial was already finished
    /// and stored under this name.
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
            return Ok(Err(Failure::NotBegun));
        }
        let trial = self.make(method, envelope, split, seed);
        match &trial {
            // The fit may have been stopped halfway.
            Ok(_) if self.cancel.is_requested() => return Ok(Err(Failure::NotBegun)),
            Ok(made) => self.ledger.keep(name, made, made.seconds)?,
            Err(_) => {}
        }
        Ok(trial)
    }

    fn make(&self, method: &Method, envelope: &Envelope, split: &Split, seed: u64) -> Result<Trial, Failure> {
        let seen = seen(envelope, split).map_err(|error| Failure::of(&error))?;
        let request =
            Request { query_times: envelope.times_s(), max_steps: self.max_steps, cancel: self.cancel };
        let start = Instant::now();
        let estimate =
            method.fit(&seen, seed, &request, &Silent, None).map_err(|error| Failure::of(&error))?;
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
