//! Attempt of one method on one data set.

use super::Ready;
use super::method::{Judged, Method, attempt};
use estimator::Cancel;
use learn::{Context, LearnError, Step};
use seed::Seed;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Result of a method on a data set.
pub struct Tried {
    /// Model with its scores, or the reason why there is none.
    pub fitted: Result<Judged, LearnError>,
    /// Duration of the fit, in seconds.
    pub seconds: f64,
    /// Steps of the training.
    pub steps: Vec<Step>,
}

/// Fits a method to a data set and scores its model; `observe` is called after every step.
#[must_use]
pub fn tried(
    ready: &Ready,
    method: &Method<'_>,
    seed: Seed,
    max_steps: Option<u64>,
    cancel: &Cancel,
    observe: &(dyn Fn(&Step) + Sync),
) -> Tried {
    let steps = Mutex::new(Vec::new());
    let observe = |step: &Step| {
        observe(step);
        if let Ok(mut steps) = steps.lock() {
            steps.push(step.clone());
        }
    };
    let start = Instant::now();
    let fitted =
        attempt(ready, method, &Context { seed, max_steps, cancel, observe: &observe, checkpoints: None });
    let seconds = start.elapsed().as_secs_f64();
    Tried { fitted, seconds, steps: steps.into_inner().unwrap_or_else(PoisonError::into_inner) }
}
