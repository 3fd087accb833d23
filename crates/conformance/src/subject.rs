//! An estimator under test.

use envelope::Envelope;
use estimator::{Ablation, Cancel, Entry, Estimate, Estimator, FitContext, FitError, Silent, Tag};
use seed::Seed;
use settings::{Document, Resolved, Section, SettingsError};
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The seed of a fit and the cap on its steps.
type Course = (u64, Option<u64>);

/// What pretraining gives.
type Reader = Option<Box<dyn Estimator>>;

/// An estimator under test, with its default settings. What one check has had it fit or learn, the next
/// one finds done.
pub struct Subject<'a> {
    /// The registry's line.
    pub entry: &'a Entry,
    estimator: Box<dyn Estimator>,
    pretrained: Done<Course, Result<Reader, FitError>>,
    fitted: Done<(Vec<u64>, Course), Result<Estimate, FitError>>,
}

/// Steps of an amortized estimator where a check asks for a training of its own and what it learns does
/// not matter.
const FEW_STEPS: u64 = 10;

impl<'a> Subject<'a> {
    /// The estimator with its default settings.
    ///
    /// # Errors
    /// What building it gives; every estimator has to build from its defaults.
    pub fn new(entry: &'a Entry) -> Result<Self, SettingsError> {
        let section = [Section { name: "estimator", fields: entry.fields }];
        let resolved = Resolved::new(&Document::default(), &section)?;
        let estimator = (entry.build)(&resolved)?;
        Ok(Self { entry, estimator, pretrained: Done::default(), fitted: Done::default() })
    }

    /// A fit with a seed and a cap on the steps, with predictions at [`query_times`]. The same fit is done
    /// once only, and so is the training of an amortized estimator.
    ///
    /// # Errors
    /// What the fit gives.
    pub fn fit(&self, envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Result<Estimate, FitError> {
        let numbers = envelope.times_s().iter().chain(envelope.log_amplitudes());
        let bits = numbers.chain([&envelope.omega_rad_s()]).map(|number| number.to_bits()).collect();
        let fit = self.fitted.of((bits, (seed, max_steps)), || self.read(envelope, seed, max_steps));
        fit.as_ref().clone()
    }

    /// As [`Subject::fit`], of many envelopes that are fitted once: the fit is not kept, the training of an
    /// amortized estimator is.
    ///
    /// # Errors
    /// What the fit gives.
    pub fn read(&self, envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Result<Estimate, FitError> {
        if !self.entry.has(Tag::Amortized) {
            return self.fit_anew(envelope, seed, max_steps);
        }
        let reader = self.pretrained.of((seed, max_steps), || self.pretrain(seed, max_steps));
        match reader.as_ref() {
            Ok(Some(reader)) => self.run(reader.as_ref(), envelope, seed, max_steps),
            Ok(None) => self.fit_anew(envelope, seed, max_steps),
            Err(error) => Err(error.clone()),
        }
    }

    /// A fit without a part of the estimator; an amortized estimator is trained whole, and reads without it.
    ///
    /// # Errors
    /// What the fit gives.
    pub fn ablated(&self, envelope: &Envelope, seed: u64, ablation: Ablation) -> Result<Estimate, FitError> {
        let cancel = Cancel::new();
        let context = self.context(seed, None, &cancel).ablating(ablation);
        if !self.entry.has(Tag::Amortized) {
            return self.estimator.fit(envelope, &context);
        }
        match self.pretrained.of((seed, None), || self.pretrain(seed, None)).as_ref() {
            Ok(Some(reader)) => reader.fit(envelope, &context),
            Ok(None) => self.estimator.fit(envelope, &context),
            Err(error) => Err(error.clone()),
        }
    }

    /// A fit from scratch, by the estimator itself.
    ///
    /// # Errors
    /// What the fit gives.
    pub fn fit_anew(
        &self,
        envelope: &Envelope,
        seed: u64,
        max_steps: Option<u64>,
    ) -> Result<Estimate, FitError> {
        self.run(self.estimator.as_ref(), envelope, seed, max_steps)
    }

    /// A cap on the steps for checks that ask for a training of their own: few for an amortized estimator,
    /// whose training is long and the same for every envelope, none for the others.
    #[must_use]
    pub fn short(&self) -> Option<u64> {
        self.entry.has(Tag::Amortized).then_some(FEW_STEPS)
    }

    /// The seed of a fit of the `draw`-th envelope of a cohort: an amortized estimator is trained once and
    /// reads them all.
    #[must_use]
    pub fn seed_of_draw(&self, draw: u64) -> u64 {
        if self.entry.has(Tag::Amortized) { 0 } else { draw }
    }

    fn pretrain(&self, seed: u64, max_steps: Option<u64>) -> Result<Reader, FitError> {
        let cancel = Cancel::new();
        self.estimator.pretrain(&self.context(seed, max_steps, &cancel))
    }

    fn run(
        &self,
        estimator: &dyn Estimator,
        envelope: &Envelope,
        seed: u64,
        max_steps: Option<u64>,
    ) -> Result<Estimate, FitError> {
        let (cancel, times) = (Cancel::new(), query_times(envelope));
        estimator.fit(envelope, &self.context(seed, max_steps, &cancel).predicting_at(&times))
    }

    fn context<'b>(&self, seed: u64, max_steps: Option<u64>, cancel: &'b Cancel) -> FitContext<'b> {
        FitContext::new(Seed::new(seed).child(self.entry.id), max_steps, &Silent, cancel)
    }
}

/// Where predictions are asked for, in seconds: at the envelope's own times, halfway between them, and at a
/// tenth of its length beyond.
#[must_use]
pub fn query_times(envelope: &Envelope) -> Vec<f64> {
    let times = envelope.times_s();
    let between = times.iter().zip(times.iter().skip(1)).map(|(one, next)| f64::midpoint(*one, *next));
    let beyond = times.last().map(|last| 1.1 * last);
    times.iter().copied().chain(between).chain(beyond).collect()
}

/// What has been worked out, by what it belongs to. Whoever asks while it is being worked out waits.
struct Done<K, V>(Mutex<HashMap<K, Arc<Once<V>>>>);

/// A result, once it is there.
type Once<V> = OnceLock<Arc<V>>;

impl<K, V> Default for Done<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Hash + Eq, V> Done<K, V> {
    fn of(&self, key: K, work: impl FnOnce() -> V) -> Arc<V> {
        // The lock is held to find the place only, not for the work; a panic elsewhere leaves the map whole.
        let place = Arc::clone(self.0.lock().unwrap_or_else(PoisonError::into_inner).entry(key).or_default());
        Arc::clone(place.get_or_init(|| Arc::new(work())))
    }
}

#[cfg(test)]
mod tests {
    use super::{Done, query_times};
    use envelope::Envelope;
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn what_is_done_is_not_done_again() {
        let (done, times) = (Done::default(), AtomicU32::new(0));
        let square = |number: u32| {
            *done.of(number, || {
                times.fetch_add(1, Ordering::Relaxed);
                number * number
            })
        };
        std::thread::scope(|scope| {
            for thread in [3, 3, 4, 3].map(|number| scope.spawn(move || (number, square(number)))) {
                let (number, found) = thread.join().unwrap();
                assert_eq!(found, number * number);
            }
        });
        assert_eq!(times.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn predictions_are_asked_for_at_the_peaks_between_and_beyond() {
        let envelope = Envelope::new(vec![0.0, 1.0, 4.0], vec![0.0; 3], 1.0).unwrap();
        assert_eq!(query_times(&envelope), [0.0, 1.0, 4.0, 0.5, 2.5, 4.4]);
    }
}
