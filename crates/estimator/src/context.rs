//! What an estimator is given besides the envelope.

use seed::Seed;
use std::sync::atomic::{AtomicBool, Ordering};

/// One step of a training, for the trace and the progress bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Steps taken so far; 0 is the untrained state.
    pub step: u64,
    /// Most steps that this fit will take.
    pub planned: u64,
    /// What the step is part of, such as `physics weight 100`.
    pub phase: String,
    /// The loss that is minimized in this phase, in the method's own units.
    pub loss: f64,
    /// λ at this step, in 1/s.
    pub decay_rate: f64,
}

/// Whoever watches a training.
pub trait Observer {
    /// Called with the untrained state and after every step.
    fn observe(&self, step: &Step);
}

/// Watches nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn observe(&self, _step: &Step) {}
}

/// A request to stop, shared between threads. Set once, never cleared.
#[derive(Debug, Default)]
pub struct Cancel(AtomicBool);

impl Cancel {
    /// Nobody asked yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(AtomicBool::new(false))
    }

    /// Asks every fit that watches this to stop after its current step.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether somebody asked.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// What an estimator is given besides the envelope: seeds by name, a budget, whoever watches, and the
/// request to stop.
pub struct FitContext<'a> {
    seed: Seed,
    max_steps: Option<u64>,
    observer: &'a dyn Observer,
    cancel: &'a Cancel,
    query_times: &'a [f64],
}

impl<'a> FitContext<'a> {
    /// A context that draws from a seed, reports to an observer and watches a request to stop.
    ///
    /// `max_steps` caps the training steps; `None` leaves them to the estimator's own settings, 0 asks
    /// for the untrained estimate.
    #[must_use]
    pub fn new(seed: Seed, max_steps: Option<u64>, observer: &'a dyn Observer, cancel: &'a Cancel) -> Self {
        Self { seed, max_steps, observer, cancel, query_times: &[] }
    }

    /// The same context, asking for the fitted function at `times` as well: seconds after the envelope's
    /// first peak, finite, in any order, within the envelope or beyond it.
    #[must_use]
    pub fn predicting_at(self, times: &'a [f64]) -> Self {
        Self { query_times: times, ..self }
    }

    /// Times at which [`Estimate::predictions`](crate::Estimate::predictions) are asked for, in seconds
    /// after the envelope's first peak.
    #[must_use]
    pub fn query_times(&self) -> &'a [f64] {
        self.query_times
    }

    /// The seed of a named part of the estimator, such as `initial weights`.
    #[must_use]
    pub fn seed(&self, name: &str) -> Seed {
        self.seed.child(name)
    }

    /// The estimator's own step limit under this context's cap.
    #[must_use]
    pub fn step_limit(&self, own: u64) -> u64 {
        self.max_steps.map_or(own, |cap| cap.min(own))
    }

    /// Tells the observer of a step.
    pub fn observe(&self, step: &Step) {
        self.observer.observe(step);
    }

    /// Whether the fit should stop after its current step.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_requested()
    }
}
