//! Observer of one fit: records its trace, saves its state from time to time, and updates the progress bar.

use crate::error::TrainerError;
use crate::folders::resume::{Ledger, Resumed};
use crate::terminal::progress::Progress;
use estimator::{Cancel, Checkpoints, Observer, Step};
use results::TraceRow;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Duration of a step from which its result is worth a write. A longer step may be abandoned in its middle
/// (see [`crate::terminal::interrupt`]).
const LONG_STEP: Duration = Duration::from_millis(300);

/// Ledger and name under which the state of a fit is stored.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(crate) ledger: &'a Ledger,
    pub(crate) name: &'a str,
}

/// A fit's own request to stop, made once its trace has reached a given length.
pub(crate) struct Pause {
    after: u64,
    cancel: Cancel,
}

impl Pause {
    pub(crate) fn new(after: u64, above: &'static Cancel) -> Self {
        Self { after, cancel: Cancel::below(above) }
    }

    pub(crate) fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    fn where_due(&self, steps: usize) {
        if steps as u64 >= self.after {
            self.cancel.request();
        }
    }
}

/// Observer of one fit.
pub(crate) struct Watcher<'a> {
    progress: &'a Progress,
    place: Option<Place<'a>>,
    pause: Option<&'a Pause>,
    begun: Instant,
    /// Time that earlier processes spent on the fit.
    earlier: Duration,
    seen: Mutex<Seen>,
}

struct Seen {
    trace: Vec<TraceRow>,
    /// State to resume from; taken once.
    latest: Option<Vec<u8>>,
    kept_at: Instant,
    /// Time of the last query whether a state is due to be stored; it is made before every step.
    asked_at: Instant,
    steps_since: u64,
    /// Reason why a state could not be stored.
    failure: Option<TrainerError>,
}

impl<'a> Watcher<'a> {
    /// Creates the observer of a fit, starting from the state that an earlier process stored.
    pub(crate) fn new(
        progress: &'a Progress,
        place: Option<Place<'a>>,
        pause: Option<&'a Pause>,
    ) -> Result<Self, TrainerError> {
        let kept = place.map(|place| place.ledger.resumed(place.name)).transpose()?.flatten();
        let (trace, latest, seconds) =
            kept.map_or((Vec::new(), None, 0.0), |kept| (kept.trace, Some(kept.state), kept.seconds));
        let begun = Instant::now();
        if let Some(pause) = pause {
            pause.where_due(trace.len());
        }
        Ok(Self {
            progress,
            place,
            pause,
            begun,
            earlier: Duration::try_from_secs_f64(seconds).unwrap_or_default(),
            seen: Mutex::new(Seen {
                trace,
                latest,
                kept_at: begun,
                asked_at: begun,
                steps_since: 0,
                failure: None,
            }),
        })
    }

    /// Returns the time spent on the fit, in seconds.
    pub(crate) fn seconds(&self) -> f64 {
        (self.earlier + self.begun.elapsed()).as_secs_f64()
    }

    pub(crate) fn into_trace(self) -> Vec<TraceRow> {
        self.seen.into_inner().unwrap_or_else(PoisonError::into_inner).trace
    }

    /// Returns the reason why a state could not be stored, if the fit failed because of it.
    pub(crate) fn failure(&self) -> Option<TrainerError> {
        self.seen().failure.take()
    }

    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Watcher<'_> {
    fn observe(&self, step: &Step) {
        self.progress.step(step);
        let mut seen = self.seen();
        seen.trace.push(TraceRow {
            step: step.step,
            phase: step.phase.clone(),
            loss: step.loss,
            decay_rate: step.decay_rate,
        });
        if let Some(pause) = self.pause {
            pause.where_due(seen.trace.len());
        }
    }
}

impl Checkpoints for Watcher<'_> {
    fn latest(&self) -> Option<Vec<u8>> {
        self.seen().latest.take()
    }

    fn is_due(&self) -> bool {
        let Some(Place { ledger, .. }) = self.place else { return false };
        let mut seen = self.seen();
        seen.steps_since += 1;
        let took = std::mem::replace(&mut seen.asked_at, Instant::now()).elapsed();
        match ledger.settings.interval_steps {
            Some(steps) => seen.steps_since >= steps,
            None => took >= LONG_STEP || seen.kept_at.elapsed().as_secs_f64() >= ledger.settings.interval_s,
        }
    }

    fn keep(&self, step: u64, state: &[u8]) -> Result<(), String> {
        let Some(Place { ledger, name }) = self.place else { return Ok(()) };
        let seconds = self.seconds();
        let mut seen = self.seen();
        let trace = seen.trace.iter().filter(|row| row.step < step).cloned().collect();
        let outcome = ledger.keep_state(name, Resumed { state: state.to_vec(), trace, seconds });
        (seen.kept_at, seen.steps_since) = (Instant::now(), 0);
        outcome.map_err(|error| {
            let sentence = error.to_string();
            seen.failure = Some(error);
            sentence
        })
    }
}
