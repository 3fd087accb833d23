//! What an estimator is given besides the envelope.

use crate::ablation::noise_like;
use crate::error::FitError;
use results::Ablation;
use seed::Seed;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::atomic::{AtomicBool, Ordering};

/// One step of a training, for the trace and the progress bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Steps taken so far; 0 is the untrained state.
    pub step: u64,
    /// Most steps that this fit will take.
    pub planned: u64,
    /// Phase of the training, such as `physics weight 100`.
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
pub struct Cancel {
    asked: AtomicBool,
    above: Option<&'static Cancel>,
}

impl Cancel {
    /// Nobody asked yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { asked: AtomicBool::new(false), above: None }
    }

    /// One that is requested by itself, or with the one above it.
    #[must_use]
    pub const fn below(above: &'static Self) -> Self {
        Self { asked: AtomicBool::new(false), above: Some(above) }
    }

    /// Asks every fit that watches this to stop after its current step.
    pub fn request(&self) {
        self.asked.store(true, Ordering::Relaxed);
    }

    /// Returns whether somebody asked.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.asked.load(Ordering::Relaxed) || self.above.is_some_and(Self::is_requested)
    }
}

/// Where a fit keeps its state, so that it can go on where it was after a crash or a request to stop.
pub trait Checkpoints {
    /// The state kept last, where there is one.
    fn latest(&self) -> Option<Vec<u8>>;

    /// Returns whether it is time to keep the state again.
    fn is_due(&self) -> bool;

    /// Keeps a state, that before `step` is observed, in place of the one before.
    ///
    /// # Errors
    /// A sentence that says why it could not be kept; the one before is then still there.
    fn keep(&self, step: u64, state: &[u8]) -> Result<(), String>;
}

/// Context of a fit beside the envelope: seeds by name, a budget, whoever watches, the
/// request to stop, and a place for its state.
///
/// An estimator that takes more than a second keeps its state: it begins from [`resumed`](Self::resumed) where that has
/// something, and calls [`checkpoint`](Self::checkpoint) before every step. It then gives to the bit what it would
/// have given in one go. Others call neither, and begin anew.
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
    /// A context that draws from a seed, reports to an observer and watches a request to stop.
    ///
    /// `max_steps` caps the training steps; `None` leaves them to the estimator's own settings, 0 asks
    /// for the untrained estimate.
    #[must_use]
    pub fn new(seed: Seed, max_steps: Option<u64>, observer: &'a dyn Observer, cancel: &'a Cancel) -> Self {
        Self { seed, max_steps, observer, cancel, query_times: &[], checkpoints: None, ablation: None }
    }

    /// Asks for the fitted function at `times` as well: seconds after the envelope's
    /// first peak, finite, in any order, within the envelope or beyond it.
    #[must_use]
    pub fn predicting_at(self, times: &'a [f64]) -> Self {
        Self { query_times: times, ..self }
    }

    /// Sets the place where the fit's state is kept.
    #[must_use]
    pub fn checkpointing_to(self, checkpoints: &'a dyn Checkpoints) -> Self {
        Self { checkpoints: Some(checkpoints), ..self }
    }

    /// The same context with a part of the estimator taken away; only an estimator with [`Tag::Ablation`](crate::Tag)
    /// obeys.
    #[must_use]
    pub fn ablating(self, ablation: Ablation) -> Self {
        Self { ablation: Some(ablation), ..self }
    }

    /// The part of the estimator that this fit does without.
    #[must_use]
    pub fn ablation(&self) -> Option<Ablation> {
        self.ablation
    }

    /// Whether the learned part is held at zero.
    #[must_use]
    pub fn is_at_zero(&self) -> bool {
        self.ablation == Some(Ablation::LearnedPartAtZero)
    }

    /// What a learned part reads: `values` themselves, or white noise of the same range where the ablation asks for it.
    /// `name` is that of the input, and of the noise's seed.
    #[must_use]
    pub fn input(&self, name: &str, values: Vec<f64>) -> Vec<f64> {
        match self.ablation {
            Some(Ablation::NoiseForInput) => noise_like(&values, &self.seed(&format!("noise for {name}"))),
            _ => values,
        }
    }

    /// The state to begin from, where one was kept.
    ///
    /// # Errors
    /// [`FitError::Checkpoint`] where it is none of this kind.
    pub fn resumed<T: DeserializeOwned>(&self) -> Result<Option<T>, FitError> {
        let Some(bytes) = self.checkpoints.and_then(Checkpoints::latest) else { return Ok(None) };
        let refused =
            |problem: &str| FitError::Checkpoint { problem: format!("what was kept is none: {problem}") };
        match postcard::take_from_bytes(&bytes) {
            Ok((state, [])) => Ok(Some(state)),
            Ok((_, rest)) => Err(refused(&format!("{} bytes too many", rest.len()))),
            Err(error) => Err(refused(&error.to_string())),
        }
    }

    /// Keeps a state where it is time to, or where the fit is about to stop on request; called before `step` is
    /// observed.
    ///
    /// # Errors
    /// [`FitError::Checkpoint`] where it cannot be kept.
    pub fn checkpoint<T: Serialize>(&self, step: u64, state: impl FnOnce() -> T) -> Result<(), FitError> {
        let Some(checkpoints) = self.checkpoints.filter(|place| place.is_due() || self.is_canceled()) else {
            return Ok(());
        };
        let refused = |problem| FitError::Checkpoint { problem };
        let bytes = postcard::to_allocvec(&state()).map_err(|error| refused(error.to_string()))?;
        checkpoints.keep(step, &bytes).map_err(refused)
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

    /// Returns whether the fit should stop after its current step.
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

    /// Keeps at every other step.
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
        // Asked to stop it keeps at once.
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
        // Eight bytes are no three numbers, and more than four.
        assert!(matches!(context.resumed::<State>(), Err(FitError::Checkpoint { .. })));
        assert!(context.resumed::<[u8; 4]>().unwrap_err().to_string().contains("4 bytes too many"));
        // Without a place nothing is kept.
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
        context.checkpoint(9, || 1.0_f64).unwrap();
        assert_eq!(context.resumed::<f64>().unwrap(), None);
    }
}
