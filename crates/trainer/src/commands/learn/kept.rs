//! Checkpoints of a learning study: finished models, and the states of unfinished training.

use crate::error::TrainerError;
use crate::folders::resume::{Ledger, Resumed};
use ::learn::learners::find;
use ::learn::{Context, LearnError, Step, Stored};
use estimator::{Cancel, Checkpoints};
use results::Reached;
use seed::Seed;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use workflow::learning::{Judged, Method, Ready, Tried, attempt, judged};

/// Finished model.
#[derive(Serialize, Deserialize)]
struct Finished {
    /// Bytes of the model's file.
    model: Vec<u8>,
    reached: Reached,
    seconds: f64,
    steps: Vec<Step>,
}

/// Conditions under which methods are fitted: seed, cap on the steps, request to stop, pause, and ledger for
/// checkpoints.
#[derive(Clone, Copy)]
pub(super) struct Trying<'a> {
    pub(super) seed: u64,
    pub(super) max_steps: Option<u64>,
    pub(super) cancel: &'static Cancel,
    /// Number of steps of its trace after which a training pauses, to be resumed later.
    pub(super) pause_after: Option<u64>,
    pub(super) ledger: &'a Ledger,
    /// Ending of the names of checkpoints: empty for the study's own seed.
    pub(super) mark: &'a str,
}

impl Trying<'_> {
    /// Returns the seed of a method on a problem.
    pub(super) fn seed_of(&self, problem: &str, method: &Method<'_>) -> Seed {
        Seed::new(self.seed).child("learn").child(problem).child(method.id)
    }

    /// Fits a method to a data set, or restores the model that was finished before, and scores it.
    pub(super) fn tried(
        &self,
        problem: &str,
        ready: &Ready,
        method: &Method<'_>,
    ) -> Result<Tried, TrainerError> {
        let name = format!("{problem}/{}{}", method.id, self.mark);
        if let Some(finished) = self.ledger.finished::<Finished>(&name)? {
            let restored = Stored::from_bytes(&finished.model).and_then(|stored| {
                let entry = find(&stored.learner).ok_or(LearnError::Interrupted)?;
                (entry.restore)(&stored)
            });
            if let Ok(model) = restored {
                let fitted = judged(model, finished.reached, &ready.data);
                return Ok(Tried { fitted: Ok(fitted), seconds: finished.seconds, steps: finished.steps });
            }
        }
        let place = Place::new(self.ledger, &name)?;
        let stop = Cancel::below(self.cancel);
        let pause_where_due = |steps: usize| {
            if self.pause_after.is_some_and(|after| steps as u64 >= after) {
                stop.request();
            }
        };
        // A training that was paused but not yet reported pauses at the same step again.
        pause_where_due(place.seen().steps.len());
        let observe = |step: &Step| {
            let mut seen = place.seen();
            seen.steps.push(step.clone());
            pause_where_due(seen.steps.len());
        };
        let seed = self.seed_of(problem, method);
        let max_steps = self.max_steps;
        let context =
            Context { seed, max_steps, cancel: &stop, observe: &observe, checkpoints: Some(&place) };
        let fitted = attempt(ready, method, &context);
        let seconds = place.seconds();
        let seen = place.seen.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(failure) = seen.failure {
            return Err(failure);
        }
        let tried = Tried { fitted, seconds, steps: seen.steps };
        if let Ok(Judged { model, reached, .. }) = &tried.fitted
            && let Some(bytes) = model.stored().and_then(|stored| stored.to_bytes().ok())
        {
            let finished = Finished { model: bytes, reached: *reached, seconds, steps: tried.steps.clone() };
            self.ledger.keep(&name, &finished, seconds)?;
        }
        Ok(tried)
    }
}

/// Place where the state of one training is stored.
struct Place<'a> {
    ledger: &'a Ledger,
    name: &'a str,
    begun: Instant,
    /// Time spent by earlier processes, in seconds.
    earlier: f64,
    seen: Mutex<Seen>,
}

struct Seen {
    steps: Vec<Step>,
    latest: Option<Vec<u8>>,
    kept_at: Instant,
    failure: Option<TrainerError>,
}

/// State of a training with the steps before it.
#[derive(Serialize, Deserialize)]
struct InTraining {
    state: Vec<u8>,
    steps: Vec<Step>,
}

impl<'a> Place<'a> {
    fn new(ledger: &'a Ledger, name: &'a str) -> Result<Self, TrainerError> {
        let kept = ledger.resumed(name)?;
        let earlier = kept.as_ref().map_or(0.0, |kept| kept.seconds);
        let kept = kept.and_then(|kept| postcard::from_bytes::<InTraining>(&kept.state).ok());
        let (steps, latest) = kept.map_or((Vec::new(), None), |kept| (kept.steps, Some(kept.state)));
        let begun = Instant::now();
        let seen = Mutex::new(Seen { steps, latest, kept_at: begun, failure: None });
        Ok(Self { ledger, name, begun, earlier, seen })
    }

    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn seconds(&self) -> f64 {
        self.earlier + self.begun.elapsed().as_secs_f64()
    }
}

impl Checkpoints for Place<'_> {
    fn latest(&self) -> Option<Vec<u8>> {
        self.seen().latest.take()
    }

    fn is_due(&self) -> bool {
        self.seen().kept_at.elapsed().as_secs_f64() >= self.ledger.settings.interval_s
    }

    fn keep(&self, step: u64, state: &[u8]) -> Result<(), String> {
        let seconds = self.seconds();
        let mut seen = self.seen();
        let steps = seen.steps.iter().filter(|own| own.step <= step).cloned().collect();
        let kept = InTraining { state: state.to_vec(), steps };
        let state = postcard::to_allocvec(&kept).map_err(|error| error.to_string())?;
        let outcome = self.ledger.keep_state(self.name, Resumed { state, trace: Vec::new(), seconds });
        seen.kept_at = Instant::now();
        outcome.map_err(|error| {
            let sentence = error.to_string();
            seen.failure = Some(error);
            sentence
        })
    }
}
