//! Context of a fit: everything an estimator receives besides the envelope.

use crate::ablation::noise_like;
use crate::error::FitError;
use results::Ablation;
use seed::Seed;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::atomic::{AtomicBool, Ordering};

/// One step of a training run, for the trace and the progress bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Steps taken so far; 0 is the untrained state.
    pub step: u64,
    /// Largest number of steps that this fit will take.
    pub planned: u64,
    /// Phase of the training, such as `physics weight 100`.
    pub phase: String,
    /// Loss that is minimized in this phase, in the method's own units.
    pub loss: f64,
    /// λ at this step, in 1/s.
    pub decay_rate: f64,
}

/// Observer of a training run.
pub trait Observer {
    /// Receives the untrained state and the state after every step.
    fn observe(&self, step: &Step);
}

/// Observer that ignores every step.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn observe(&self, _step: &Step) {}
}

/// Request to stop, shared between threads. Once set, it is never cleared.
#[derive(Debug, Default)]
pub struct Cancel {
    asked: AtomicBool,
    above: Option<&'static Cancel>,
}

impl Cancel {
    /// Creates a request that has not been made yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { asked: AtomicBool::new(false), above: None }
    }

    /// Creates a request that counts as made if it was made itself or if `above` was.
    #[must_use]
    pub const fn below(above: &'static Self) -> Self {
        Self { asked: AtomicBool::new(false), above: Some(above) }
    }

    /// Asks every fit that watches this request to stop after its current step.
    pub fn request(&self) {
        self.asked.store(true, Ordering::Relaxed);
    }

    /// Returns `true` if the request was made.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.asked.load(Ordering::Relaxed) || self.above.is_some_and(Self::is_requested)
    }
}

/// Storage for the state of a fit, so that the fit can continue after a crash or a request to stop.
pub trait Checkpoints {
    /// Returns the state stored last; `None` if there is none.
    fn latest(&self) -> Option<Vec<u8>>;

    /// Returns `true` if it is time to store the state again.
    fn is_due(&self) -> bool;

    /// Stores the state from before `step` is observed, in place of the previous one.
    ///
    /// # Errors
    /// A sentence that says why the state could not be stored; the previous one is then still there.
    fn keep(&self, step: u64, state: &[u8]) -> Result<(), String>;
}

/// Context of a fit besides the envelope: named seeds, a step budget, an observer, the request to stop, and
/// storage for the fit's state.
///
/// An estimator that takes more than a second stores its state: it starts from [`resumed`](Self::resumed) if
/// a state was stored, and calls [`checkpoint`](Self::checkpoint) before every step. The resumed fit then
/// gives the same bits as an uninterrupted one. Other estimators call neither and start again.
pub struct FitContext<'a> {
    seed: Seed,
    max_steps: Option<u64>,
    observer: &'a dyn Observer,
    cancel: &'a Cancel,
    query_times: &'a [f64],
    checkpoints: Option<&'a dyn Checkpoints>,
    ablation: Option<Ablation>,
}

impl<'a> FitContext<'a> {
    /// Creates a context that draws from a seed, reports to an observer and watches a request to stop.
    ///
    /// `max_steps` caps the training steps: `None` leaves them to the estimator's own settings, and 0 asks
    /// for the untrained estimate.
    #[must_use]
    pub fn new(seed: Seed, max_steps: Option<u64>, observer: &'a dyn Observer, cancel: &'a Cancel) -> Self {
        Self { seed, max_steps, observer, cancel, query_times: &[], checkpoints: None, ablation: None }
    }

    /// Asks for the fitted function at `times` as well: seconds after the envelope's first peak, finite, in
    /// any order, within the envelope or beyond it.
    #[must_use]
    pub fn predicting_at(self, times: &'a [f64]) -> Self {
        Self { query_times: times, ..self }
    }

    /// Sets the storage for the fit's state.
    #[must_use]
    pub fn checkpointing_to(self, checkpoints: &'a dyn Checkpoints) -> Self {
        Self { checkpoints: Some(checkpoints), ..self }
    }

    /// Returns this context with an ablation: a part of the estimator is replaced. Only an estimator with
    /// [`Tag::Ablation`](crate::Tag) follows it.
    #[must_use]
    pub fn ablating(self, ablation: Ablation) -> Self {
        Self { ablation: Some(ablation), ..self }
    }

    /// Returns the ablation of this fit; `None` for a full fit.
    #[must_use]
    pub fn ablation(&self) -> Option<Ablation> {
        self.ablation
    }

    /// Returns `true` if the learned part is held at zero.
    #[must_use]
    pub fn is_at_zero(&self) -> bool {
        self.ablation == Some(Ablation::LearnedPartAtZero)
    }

    /// Returns the input of a learned part: `values` themselves, or white noise of the same range if the
    /// ablation asks for it. `name` identifies the input and seeds its noise.
    #[must_use]
    pub fn input(&self, name: &str, values: Vec<f64>) -> Vec<f64> {
        match self.ablation {
            Some(Ablation::NoiseForInput) => noise_like(&values, &self.seed(&format!("noise for {name}"))),
            _ => values,
        }
    }

    /// Returns the state to start from; `None` if none was stored.
    ///
    /// # Errors
    /// [`FitError::Checkpoint`] if the stored bytes are not a state of this type.
    pub fn resumed<T: DeserializeOwned>(&self) -> Result<Option<T>, FitError> {
        let Some(bytes) = self.checkpoints.and_then(Checkpoints::latest) else { return Ok(None) };
        let refused = |problem: &str| FitError::Checkpoint {
            problem: format!("the saved state cannot be read: {problem}"),
        };
        match postcard::take_from_bytes(&bytes) {
            Ok((state, [])) => Ok(Some(state)),
            Ok((_, rest)) => Err(refused(&format!("{} bytes too many", rest.len()))),
            Err(error) => Err(refused(&error.to_string())),
        }
    }

    /// Stores a state if it is time to, or if the fit is about to stop on request. Call it before `step` is
    /// observed.
    ///
    /// # Errors
    /// [`FitError::Checkpoint`] if the state cannot be stored.
    pub fn checkpoint<T: Serialize>(&self, step: u64, state: impl FnOnce() -> T) -> Result<(), FitError> {
        let Some(checkpoints) = self.checkpoints.filter(|place| place.is_due() || self.is_canceled()) else {
            return Ok(());
        };
        let refused = |problem| FitError::Checkpoint { problem };
        let bytes = postcard::to_allocvec(&state()).map_err(|error| refused(error.to_string()))?;
        checkpoints.keep(step, &bytes).map_err(refused)
    }

    /// Returns the times for which [`Estimate::predictions`](crate::Estimate::predictions) are asked, in
    /// seconds after the envelope's first peak.
    #[must_use]
    pub fn query_times(&self) -> &'a [f64] {
        self.query_times
    }

    /// Returns the seed of a named part of the estimator, such as `initial weights`.
    #[must_use]
    pub fn seed(&self, name: &str) -> Seed {
        self.seed.child(name)
    }

    /// Returns the estimator's own step limit, lowered to this context's cap.
    #[must_use]
    pub fn step_limit(&self, own: u64) -> u64 {
        self.max_steps.map_or(own, |cap| cap.min(own))
    }

    /// Reports a step to the observer.
    pub fn observe(&self, step: &Step) {
        self.observer.observe(step);
    }

    /// Returns `true` if the fit should stop after its current step.
    #[must_use]
    pub fn is_canceled(&self) -> bool {
        self.cancel.is_requested()
    }
}

#[cfg(test)]
mod tests {
    use super::{Cancel, Checkpoints, FitContext, Silent};
    use crate::error::FitError;
    use seed::Seed;
    use std::cell::RefCell;

    /// Storage that is due at every other step.
    #[derive(Default)]
    struct Place(RefCell<Vec<(u64, Vec<u8>)>>, RefCell<u64>);

    impl Checkpoints for Place {
        fn latest(&self) -> Option<Vec<u8>> {
            self.0.borrow().last().map(|(_, state)| state.clone())
        }

        fn is_due(&self) -> bool {
            *self.1.borrow_mut() += 1;
            self.1.borrow().is_multiple_of(2)
        }

        fn keep(&self, step: u64, state: &[u8]) -> Result<(), String> {
            self.0.borrow_mut().push((step, state.to_vec()));
            if step == 9 { Err("the disk is full".to_owned()) } else { Ok(()) }
        }
    }

    type State = (f64, Vec<f64>, u128);

    #[test]
    fn a_state_comes_back_to_the_bit() {
        let (place, cancel) = (Place::default(), Cancel::new());
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(&place);
        assert_eq!(context.resumed::<State>().unwrap(), None);
        let state: State = (f64::INFINITY, vec![0.1, -0.0, f64::MIN_POSITIVE / 8.0], u128::MAX - 1);
        for step in 0..4 {
            context.checkpoint(step, || state.clone()).unwrap();
        }
        assert_eq!(place.0.borrow().iter().map(|(step, _)| *step).collect::<Vec<_>>(), [1, 3]);
        let kept = context.resumed::<State>().unwrap().unwrap();
        let bits = |state: &State| state.1.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!((kept.0, bits(&kept), kept.2), (state.0, bits(&state), state.2));
        // A request to stop makes every checkpoint due.
        cancel.request();
        context.checkpoint(4, || state.clone()).unwrap();
        context.checkpoint(5, || state.clone()).unwrap();
        assert_eq!(place.0.borrow().len(), 4);
    }

    #[test]
    fn what_cannot_be_kept_or_is_no_state_is_an_error() {
        let (place, cancel) = (Place::default(), Cancel::new());
        cancel.request();
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(&place);
        let refused = context.checkpoint(9, || 1.0_f64).unwrap_err();
        assert_eq!(refused.to_string(), "the state of the fit: the disk is full");
        // Eight bytes cannot hold the three values of a `State`, and they are more than four.
        assert!(matches!(context.resumed::<State>(), Err(FitError::Checkpoint { .. })));
        assert!(context.resumed::<[u8; 4]>().unwrap_err().to_string().contains("4 bytes too many"));
        // Without storage nothing is stored.
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
        context.checkpoint(9, || 1.0_f64).unwrap();
        assert_eq!(context.resumed::<f64>().unwrap(), None);
    }
}
