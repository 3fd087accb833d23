//! One estimator on one seed.

use crate::error::TrainerError;
use crate::input::Input;
use crate::progress::{Progress, Watcher};
use estimator::{Cancel, Entry, Estimate, Estimator, FitContext};
use runs::result::{SeedRow, TraceRow};
use seed::Seed;
use std::time::Instant;

/// One seed's fit.
pub(crate) struct SeedFit {
    pub(crate) estimate: Estimate,
    pub(crate) trace: Vec<TraceRow>,
    pub(crate) row: SeedRow,
}

/// What a fit needs besides the estimator and the seed.
pub(crate) struct FitSetting<'a> {
    pub(crate) input: &'a Input,
    pub(crate) max_steps: Option<u64>,
    pub(crate) progress: &'a Progress,
    pub(crate) cancel: &'a Cancel,
}

impl FitSetting<'_> {
    /// Fits, times, and compares with the oracle.
    pub(crate) fn fit(
        &self,
        entry: &Entry,
        estimator: &dyn Estimator,
        seed: u64,
    ) -> Result<SeedFit, TrainerError> {
        let envelope = &self.input.extraction.envelope;
        let watcher = Watcher::new(self.progress);
        let branch = Seed::new(seed).child(entry.id);
        let context = FitContext::new(branch, self.max_steps, &watcher, self.cancel);
        let start = Instant::now();
        let estimate = estimator.fit(envelope, &context).map_err(|source| TrainerError::Fit {
            estimator: entry.id,
            seed,
            source,
        })?;
        let seconds = start.elapsed().as_secs_f64();
        if !(estimate.decay_rate.is_finite() && estimate.log_amplitude.is_finite()) {
            return Err(TrainerError::NotFinite { estimator: entry.id, seed });
        }
        let oracle = self.input.oracle.decay_rate;
        let row = SeedRow {
            seed,
            decay_rate: estimate.decay_rate,
            zeta: envelope.damping_ratio(estimate.decay_rate),
            error_percent: scoring::error_percent(estimate.decay_rate, oracle),
            reached: estimate.stop.reached.name().to_owned(),
            steps: estimate.steps,
            seconds,
        };
        Ok(SeedFit { estimate, trace: watcher.into_trace(), row })
    }
}

/// The seeds of an experiment.
pub(crate) fn seeds(first: u64, count: u64) -> Result<std::ops::Range<u64>, TrainerError> {
    let end = first.checked_add(count).ok_or(TrainerError::TooManySeeds { seed: first })?;
    Ok(first..end)
}
