//! Estimator under test.

use envelope::Envelope;
use estimator::{Ablation, Cancel, Entry, Estimate, Estimator, FitContext, FitError, Silent, Tag};
use seed::Seed;
use settings::{Document, Resolved, Section, SettingsError};
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Seed of a fit and cap on its steps.
type Course = (u64, Option<u64>);

/// Result of pretraining.
type Reader = Option<Box<dyn Estimator>>;

/// Estimator under test, with its default settings. Fits and trainings are stored, so that several checks can
/// use them.
pub struct Subject<'a> {
    /// Registry entry of the estimator.
    pub entry: &'a Entry,
    /// Its settings, in the section `estimator`.
    pub settings: Resolved,
    estimator: Box<dyn Estimator>,
    pretrained: Done<Course, Result<Reader, FitError>>,
    fitted: Done<(Vec<u64>, Course), Result<Estimate, FitError>>,
}

/// Steps of an amortized estimator in checks that need a separate training but not its result.
const FEW_STEPS: u64 = 10;

/// Envelopes on which an amortized estimator of few steps is calibrated.
const FEW_CALIBRATIONS: u64 = 100;

impl<'a> Subject<'a> {
    /// Builds the estimator with its default settings.
    ///
    /// # Errors
    /// Error of the build; every estimator has to build from its defaults.
    pub fn new(entry: &'a Entry) -> Result<Self, SettingsError> {
        Self::with(entry, &[])
    }

    /// Builds an amortized estimator whose training has few steps and few envelopes to calibrate on, so that it runs to its end
    /// in a second.
    ///
    /// # Errors
    /// Error of the build.
    pub fn brief(entry: &'a Entry) -> Result<Self, SettingsError> {
        Self::with(entry, &[("max_steps", FEW_STEPS), ("calibration", FEW_CALIBRATIONS)])
    }

    /// Builds the estimator with numbers for those of its settings that it has.
    fn with(entry: &'a Entry, numbers: &[(&str, u64)]) -> Result<Self, SettingsError> {
        let section = [Section { name: "estimator", fields: entry.fields }];
        let mut document = Document::default();
        for (key, number) in
            numbers.iter().filter(|(key, _)| entry.fields.iter().any(|field| field.key == *key))
        {
            document.apply_override(&format!("estimator.{key}={number}"))?;
        }
        let settings = Resolved::new(&document, &section)?;
        let estimator = (entry.build)(&settings)?;
        Ok(Self { entry, settings, estimator, pretrained: Done::default(), fitted: Done::default() })
    }

    /// Fits an envelope with a seed and a cap on the steps, and predicts at [`query_times`]. Each distinct
    /// fit runs only once, and so does the training of an amortized estimator.
    ///
    /// # Errors
    /// Error of the fit.
    pub fn fit(&self, envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Result<Estimate, FitError> {
        let numbers = envelope.times_s().iter().chain(envelope.log_amplitudes());
        let bits = numbers.chain([&envelope.omega_rad_s()]).map(|number| number.to_bits()).collect();
        let fit = self.fitted.of((bits, (seed, max_steps)), || self.read(envelope, seed, max_steps));
        fit.as_ref().clone()
    }

    /// Fits as [`Subject::fit`] does, for envelopes that are fitted only once: the fit is not stored, but the
    /// training of an amortized estimator is.
    ///
    /// # Errors
    /// Error of the fit.
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

    /// Fits with an ablation. An amortized estimator is trained without it, and evaluated with it.
    ///
    /// # Errors
    /// Error of the fit.
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

    /// Fits from scratch, by the estimator itself.
    ///
    /// # Errors
    /// Error of the fit.
    pub fn fit_anew(
        &self,
        envelope: &Envelope,
        seed: u64,
        max_steps: Option<u64>,
    ) -> Result<Estimate, FitError> {
        self.run(self.estimator.as_ref(), envelope, seed, max_steps)
    }

    /// Returns the cap on the steps for checks that need a separate training: few steps for an amortized
    /// estimator, whose training is long and the same for every envelope; no cap for the others.
    #[must_use]
    pub fn short(&self) -> Option<u64> {
        self.entry.has(Tag::Amortized).then_some(FEW_STEPS)
    }

    /// Returns the seed for the fit of the `draw`-th envelope of a cohort. It is always 0 for an amortized
    /// estimator, which is trained once for all envelopes.
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

/// Returns the times of predictions, in seconds: the envelope's own times, the midpoints between them, and a
/// time beyond its end by a tenth of its length.
#[must_use]
pub fn query_times(envelope: &Envelope) -> Vec<f64> {
    let times = envelope.times_s();
    let between = times.iter().zip(times.iter().skip(1)).map(|(one, next)| f64::midpoint(*one, *next));
    let beyond = times.last().map(|last| 1.1 * last);
    times.iter().copied().chain(between).chain(beyond).collect()
}

/// Store of finished results by key. A thread that asks for a result in progress waits for it.
struct Done<K, V>(Mutex<HashMap<K, Arc<Once<V>>>>);

/// Result that is computed once.
type Once<V> = OnceLock<Arc<V>>;

impl<K, V> Default for Done<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Hash + Eq, V> Done<K, V> {
    fn of(&self, key: K, work: impl FnOnce() -> V) -> Arc<V> {
        // The lock is held only to find the place, not during the work; a panic elsewhere leaves the map
        // intact.
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
