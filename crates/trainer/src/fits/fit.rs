//! Fit of one method on one seed, made without knowledge of the oracle's result.

use crate::error::TrainerError;
use crate::fits::method::{Method, Request};
use crate::fits::watcher::{Pause, Place, Watcher};
use crate::folders::resume::Ledger;
use crate::terminal::progress::Progress;
use envelope::Envelope;
use estimator::{Cancel, Estimate, Reached};
use results::{SeedRow, TraceRow};
use serde::{Deserialize, Serialize};

/// Fit of one seed.
#[derive(Serialize, Deserialize)]
pub(crate) struct SeedFit {
    pub(crate) seed: u64,
    pub(crate) estimate: Estimate,
    pub(crate) trace: Vec<TraceRow>,
    pub(crate) seconds: f64,
}

/// Inputs of a fit besides the method and the seed.
pub(crate) struct FitSetting<'a> {
    pub(crate) envelope: &'a Envelope,
    pub(crate) request: Request<'a>,
    pub(crate) progress: &'a Progress,
    /// Ledger in which finished fits and the state of unfinished ones are stored.
    pub(crate) ledger: Option<&'a Ledger>,
    /// Number of steps of its trace after which a fit pauses, to be resumed later, and the parent of the
    /// pause's own request to stop.
    pub(crate) pause: Option<(u64, &'static Cancel)>,
}

impl FitSetting<'_> {
    /// Fits and measures the duration; continues from a stored fit, finished or not.
    pub(crate) fn fit(&self, method: &Method, seed: u64) -> Result<SeedFit, TrainerError> {
        let name = format!("{} seed {seed}", method.id());
        if let Some(done) = self.ledger.map(|ledger| ledger.finished(&name)).transpose()?.flatten() {
            return Ok(done);
        }
        let pause = self.pause.map(|(after, above)| Pause::new(after, above));
        let place = self.ledger.map(|ledger| Place { ledger, name: &name });
        let watcher = Watcher::new(self.progress, place, pause.as_ref())?;
        let cancel = pause.as_ref().map_or(self.request.cancel, Pause::cancel);
        let estimate = method
            .fit(self.envelope, seed, &Request { cancel, ..self.request }, &watcher, Some(&watcher))
            .map_err(|error| watcher.failure().unwrap_or(error))?;
        let seconds = watcher.seconds();
        let fit = SeedFit { seed, estimate, trace: watcher.into_trace(), seconds };
        match self.ledger {
            Some(ledger) if !fit.is_interrupted() => ledger.keep(&name, &fit, seconds)?,
            _ => {}
        }
        Ok(fit)
    }
}

impl SeedFit {
    /// Returns `true` if the fit was stopped before its end.
    pub(crate) fn is_interrupted(&self) -> bool {
        self.estimate.stop.reached == Reached::Interrupted
    }

    /// Returns the fit as a row, with its error against the oracle's decay rate.
    pub(crate) fn row(&self, envelope: &Envelope, oracle: f64) -> SeedRow {
        let rate = self.estimate.decay_rate;
        let zeta = envelope.damping_ratio(rate);
        SeedRow {
            seed: self.seed,
            decay_rate: rate,
            zeta,
            error_percent: scoring::error_percent(zeta, envelope.damping_ratio(oracle)),
            reached: self.estimate.stop.reached,
            steps: self.estimate.steps,
            seconds: self.seconds,
        }
    }
}

/// Returns the seeds of an experiment.
pub(crate) fn seeds(first: u64, count: u64) -> Result<std::ops::Range<u64>, TrainerError> {
    let end = first.checked_add(count).ok_or(TrainerError::TooManySeeds { seed: first })?;
    Ok(first..end)
}
