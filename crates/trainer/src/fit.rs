//! One method on one seed. Nothing here knows what the oracle found.

use crate::error::TrainerError;
use crate::method::Method;
use crate::progress::{Progress, Watcher};
use envelope::Envelope;
use estimator::{Cancel, Estimate};
use runs::result::{SeedRow, TraceRow};
use std::time::Instant;

/// One seed's fit.
pub(crate) struct SeedFit {
    pub(crate) seed: u64,
    pub(crate) estimate: Estimate,
    pub(crate) trace: Vec<TraceRow>,
    pub(crate) seconds: f64,
}

/// What a fit needs besides the method and the seed.
pub(crate) struct FitSetting<'a> {
    pub(crate) envelope: &'a Envelope,
    /// Times at which the fitted function is asked for, in seconds after the first peak.
    pub(crate) query_times: &'a [f64],
    pub(crate) max_steps: Option<u64>,
    pub(crate) progress: &'a Progress,
    pub(crate) cancel: &'a Cancel,
}

impl FitSetting<'_> {
    /// Fits and times.
    pub(crate) fn fit(&self, method: &Method, seed: u64) -> Result<SeedFit, TrainerError> {
        let watcher = Watcher::new(self.progress);
        let start = Instant::now();
        let estimate = method.fit(self.envelope, seed, self, &watcher)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(SeedFit { seed, estimate, trace: watcher.into_trace(), seconds })
    }
}

impl SeedFit {
    /// The fit as a row, beside the oracle's decay rate.
    pub(crate) fn row(&self, envelope: &Envelope, oracle: f64) -> SeedRow {
        let rate = self.estimate.decay_rate;
        SeedRow {
            seed: self.seed,
            decay_rate: rate,
            zeta: envelope.damping_ratio(rate),
            error_percent: scoring::error_percent(rate, oracle),
            reached: self.estimate.stop.reached.name().to_owned(),
            steps: self.estimate.steps,
            seconds: self.seconds,
        }
    }
}

/// The seeds of an experiment.
pub(crate) fn seeds(first: u64, count: u64) -> Result<std::ops::Range<u64>, TrainerError> {
    let end = first.checked_add(count).ok_or(TrainerError::TooManySeeds { seed: first })?;
    Ok(first..end)
}
