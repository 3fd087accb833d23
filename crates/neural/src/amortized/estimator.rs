//! Amortized estimator: trains a network, then reads envelopes with it.

use super::bank::Prior;
use super::calibration::QUANTILE_975;
use super::mirror::SAID;
use super::reading::Reading;
use super::training::{Skill, Training};
use crate::decay::Encoder;
use crate::device::device;
use crate::flat::{named_parameters, with_parameters};
use crate::sequence::Sequence;
use crate::weights::to_safetensors;
use burn::tensor::Device;
use envelope::Envelope;
use estimator::{
    Estimate, Estimator, FitContext, FitError, ModelFile, Prediction, Reached, Scaling, Stop, Uncertainty,
};
use seed::Seed;
use settings::{Resolved, SettingsError};

/// Network architecture that can be trained to read envelopes.
pub trait Skilled: Clone + Send + Sync + 'static {
    /// Network type.
    type Encoder: Encoder;

    /// Builds a network that outputs `says` numbers per sequence; its weights are arbitrary.
    fn encoder(&self, says: usize, device: &Device) -> Self::Encoder;

    /// Returns initial values in the order of the flat parameter list.
    ///
    /// # Errors
    /// [`FitError::Backend`] if burn fails.
    fn start(&self, encoder: &Self::Encoder, seed: &Seed) -> Result<Vec<f64>, FitError>;
}

/// Amortized estimator: a network, the prior of its training envelopes, and the training options.
#[derive(Debug, Clone, PartialEq)]
pub struct Amortized<N> {
    /// Network architecture.
    pub network: N,
    /// Prior of the training envelopes.
    pub prior: Prior,
    /// Options for training and reading.
    pub training: Training,
}

/// Trained amortized estimator.
struct Trained<N> {
    estimator: Amortized<N>,
    skill: Skill,
}

/// Envelope that is watched during a training if there is none to read: this many peaks of λ = 1/s, a tenth
/// of a second apart.
const WATCHED_PEAKS: usize = 30;
const WATCHED_INTERVAL_S: f64 = 0.1;

/// Number of looks at the watched envelope: enough to show the progress of the training, at a tenth of its
/// time.
const WATCHED_LOOKS: usize = 2;

impl<N: Skilled> Amortized<N> {
    /// Builds the estimator from checked settings: prior and training options come from the section
    /// `estimator`, which holds the keys of [`fields`](super::fields) and the network's own keys.
    ///
    /// # Errors
    /// [`SettingsError::Declaration`] if a key is not declared; [`SettingsError::BadValue`] if the largest
    /// number of peaks is below the smallest.
    pub fn new(network: N, settings: &Resolved) -> Result<Self, SettingsError> {
        let (prior, training): (Prior, _) = (settings.section("estimator")?, settings.section("estimator")?);
        let [fewest, most] = prior.peaks;
        if fewest > most {
            let peaks = settings.setting("estimator.peaks")?;
            return Err(SettingsError::BadValue {
                origin: peaks.origin.clone(),
                key: peaks.key(),
                found: format!("[{fewest}, {most}]"),
                expected: "the fewest peaks first, then the most".to_owned(),
                unit: String::new(),
            });
        }
        Ok(Self { network, prior, training })
    }

    /// Trains the network. At every step, the observer gets the λ read from `watched`, converted by a
    /// scaling.
    fn train(
        &self,
        context: &FitContext<'_>,
        watched: &Sequence,
        scaling: &Scaling,
    ) -> Result<Skill, FitError> {
        let device = device()?;
        let encoder = self.network.encoder(SAID, &device);
        let start = self.network.start(&encoder, &context.seed("initial weights"))?;
        let glance = Training { most_looks: WATCHED_LOOKS, ..self.training.clone() };
        let rate_of = |parameters: &[f64]| {
            let encoder = with_parameters(encoder.clone(), parameters, &device)?;
            let reading = glance.read(&encoder, watched, &device)?;
            Ok(scaling.rate_per_centered_time(reading.rate))
        };
        self.training.train(&self.prior, &encoder, start, context, &device, rate_of)
    }

    fn read(
        &self,
        skill: &Skill,
        envelope: &Envelope,
        context: &FitContext<'_>,
    ) -> Result<Estimate, FitError> {
        let scaling = Scaling::of(envelope)?;
        let peaks = Sequence::of(envelope, &scaling);
        let device = device()?;
        let parameters = match context.is_at_zero() {
            true => &vec![0.0; skill.parameters.len()],
            false => &skill.parameters,
        };
        let encoder = with_parameters(self.network.encoder(SAID, &device), parameters, &device)?;
        // The answer is a line through the sequence that was read.
        let mut reading = self.training.read(&encoder, &peaks.clone().as_read(context), &device)?;
        reading.level_std_error *= skill.calibration.level;
        reading.rate_std_error *= skill.calibration.rate;
        let decay_rate = scaling.rate_per_centered_time(reading.rate);
        let fitted = |s: f64| scaling.log_amplitude(reading.level - reading.rate * s);
        // The network was never trained on envelopes with fewer peaks, so its stated error would be a guess.
        let [fewest, _] = self.prior.peaks;
        let knows_its_error = skill.reached == Reached::Converged && envelope.len() >= fewest;
        let rate_std_error = scaling.rate_per_centered_time(reading.rate_std_error);
        let half_width = QUANTILE_975 * rate_std_error;
        let uncertainty = knows_its_error.then_some(Uncertainty {
            std_error: rate_std_error,
            interval_95: [decay_rate - half_width, decay_rate + half_width],
        });
        let scatter = reading.scatter_variance(&peaks);
        let predict = |&time: &f64| {
            let s = scaling.centered_time(time);
            let line = reading.level_std_error.powi(2) + (s * reading.rate_std_error).powi(2);
            let std_error = knows_its_error.then(|| scaling.deviation((scatter + line).sqrt()));
            Prediction::new(fitted(s), std_error)
        };
        Ok(Estimate {
            decay_rate,
            log_amplitude: fitted(-1.0),
            uncertainty,
            stop: self.stop(skill, &reading),
            steps: skill.steps,
            parameters: skill.parameters.len(),
            fitted_log_amplitudes: peaks.times.iter().map(|&s| fitted(s)).collect(),
            predictions: context.query_times().iter().map(predict).collect(),
            equation: None,
            model: Some(ModelFile {
                name: "weights.safetensors".to_owned(),
                bytes: to_safetensors(&named_parameters(&encoder)?)?,
            }),
        })
    }

    fn stop(&self, skill: &Skill, reading: &Reading) -> Stop {
        let Skill { steps, reached, .. } = skill;
        let (looks, moved) = (reading.looks, reading.moved);
        let (reached, because) = match reached {
            Reached::Converged if reading.is_settled() => {
                let envelopes = steps * self.training.batch as u64;
                let last = match reading.exact {
                    true => "changed λ only by rounding".to_owned(),
                    false => format!("moved λ by {moved:.1e} of its stated error"),
                };
                (
                    Reached::Converged,
                    format!("trained on {envelopes} simulated envelopes; look {looks} {last}"),
                )
            }
            Reached::Converged => (
                Reached::BudgetSpent,
                format!(
                    "look {looks} still moved λ by {moved:.1e} of its stated error: the envelope is unlike \
                     the simulated ones; widen their ranges or raise estimator.most_looks"
                ),
            ),
            Reached::BudgetSpent | Reached::Stalled => (
                Reached::BudgetSpent,
                format!(
                    "the training ended after {steps} of {} steps; raise fit.max_steps",
                    self.training.max_steps
                ),
            ),
            Reached::Diverged => (
                Reached::Diverged,
                format!("the loss is not finite after {steps} steps; lower estimator.learning_rate"),
            ),
            Reached::Interrupted => {
                (Reached::Interrupted, format!("the training was interrupted after {steps} steps"))
            }
        };
        Stop { reached, because }
    }
}

impl<N: Skilled> Estimator for Amortized<N> {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let scaling = Scaling::of(envelope)?;
        let skill = self.train(context, &Sequence::of(envelope, &scaling), &scaling)?;
        self.read(&skill, envelope, context)
    }

    fn pretrain(&self, context: &FitContext<'_>) -> Result<Option<Box<dyn Estimator>>, FitError> {
        let times: Vec<f64> = (0..WATCHED_PEAKS).map(|at| WATCHED_INTERVAL_S * at as f64).collect();
        let logs = times.iter().map(|time| -time).collect();
        let watched = Envelope::new(times, logs, 1.0)
            .map_err(|error| FitError::Backend { problem: error.to_string() })?;
        let scaling = Scaling::of(&watched)?;
        let skill = self.train(context, &Sequence::of(&watched, &scaling), &scaling)?;
        Ok(Some(Box::new(Trained { estimator: self.clone(), skill })))
    }
}

impl<N: Skilled> Estimator for Trained<N> {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        self.estimator.read(&self.skill, envelope, context)
    }
}

#[cfg(test)]
mod tests {
    use super::Amortized;
    use crate::amortized::bank::Prior;
    use crate::amortized::fields;
    use crate::amortized::tiny::{Pupil, estimator};
    use crate::amortized::training::Training;
    use crate::kept::Kept;
    use crate::weights::from_safetensors;
    use envelope::Envelope;
    use estimator::{Cancel, Estimate, Estimator, FitContext, FitError, Observer, Reached, Silent, Step};
    use seed::Seed;
    use settings::{Document, Resolved, Section, SettingsError};
    use std::cell::RefCell;

    /// Builds an envelope with λ = 0.2 1/s and a scatter of about 0.03.
    fn envelope(peaks: usize) -> Envelope {
        let times: Vec<f64> = (0..peaks).map(|at| 0.3 * at as f64).collect();
        let scatter = |at: usize| 0.1 * ((at * 7919 % 101) as f64 / 101.0 - 0.5);
        let logs = times.iter().enumerate().map(|(at, t)| 1.0 - 0.2 * t + scatter(at)).collect();
        Envelope::new(times, logs, 21.0).unwrap()
    }

    fn fit(estimator: &dyn Estimator, peaks: usize, steps: Option<u64>) -> Result<Estimate, FitError> {
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(1), steps, &Silent, &cancel);
        estimator.fit(&envelope(peaks), &context.predicting_at(&[0.0, 3.3, 40.0]))
    }

    fn pretrained(estimator: &dyn Estimator, steps: Option<u64>) -> Box<dyn Estimator> {
        let cancel = Cancel::new();
        estimator.pretrain(&FitContext::new(Seed::new(1), steps, &Silent, &cancel)).unwrap().unwrap()
    }

    #[test]
    fn pretrained_it_reads_to_the_bit_what_it_reads_when_asked_to_train() {
        for steps in [None, Some(0), Some(7)] {
            let reader = pretrained(&estimator(), steps);
            for peaks in [5, 40] {
                let estimate = fit(&estimator(), peaks, steps).unwrap();
                assert_eq!(fit(reader.as_ref(), peaks, steps).unwrap(), estimate);
                assert_eq!(estimate.steps, steps.unwrap_or(300));
            }
        }
    }

    #[test]
    fn it_learns_from_simulated_envelopes_to_read_another() {
        let estimate = fit(&estimator(), 40, None).unwrap();
        let known = estimate.uncertainty.unwrap();
        let [low, high] = known.interval_95;
        assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
        assert!((low..high).contains(&0.2), "{known:?}");
        // σ·√(12/n)/duration = 0.029·0.55/11.7, plus the error of so small a network.
        assert!((0.001..0.003).contains(&known.std_error), "{known:?}");
        assert!(estimate.stop.because.contains("trained on 4800 simulated envelopes"));
        // Without training, the answer is far off.
        let untrained = fit(&estimator(), 40, Some(0)).unwrap();
        assert!((untrained.decay_rate / 0.2 - 1.0).abs() > 0.1, "{}", untrained.decay_rate);
        assert_eq!((untrained.stop.reached, untrained.uncertainty), (Reached::BudgetSpent, None));
    }

    #[test]
    fn it_predicts_the_line_and_the_scatter_about_it() {
        let estimate = fit(&estimator(), 40, None).unwrap();
        let [first, inside, beyond] = estimate.predictions[..] else { panic!() };
        assert!((first.log_amplitude - estimate.log_amplitude).abs() < 1e-12);
        for (prediction, time) in [(inside, 3.3), (beyond, 40.0)] {
            let expected = estimate.log_amplitude - estimate.decay_rate * time;
            assert!((prediction.log_amplitude - expected).abs() < 1e-12);
        }
        let [inside, beyond] = [inside, beyond].map(|prediction| prediction.std_error.unwrap());
        // The scatter is uniform with width 0.1.
        assert!((inside / (0.1 / 12_f64.sqrt()) - 1.0).abs() < 0.1, "{inside}");
        assert!(beyond > inside);
        let few = fit(&estimator(), 40, Some(5)).unwrap();
        assert!(few.predictions.iter().all(|prediction| prediction.std_error.is_none()));
    }

    #[test]
    fn fewer_peaks_than_it_was_shown_are_read_without_a_stated_error() {
        let [nine, ten] = [9, 10].map(|peaks| fit(&estimator(), peaks, None).unwrap());
        assert!(nine.uncertainty.is_none() && ten.uncertainty.is_some());
        assert!((nine.decay_rate / 0.2 - 1.0).abs() < 0.2, "{}", nine.decay_rate);
    }

    #[test]
    fn every_step_is_told_once_and_a_request_to_stop_is_heard() {
        struct Steps(RefCell<Vec<u64>>);
        impl Observer for Steps {
            fn observe(&self, step: &Step) {
                assert!(step.decay_rate.is_finite() && step.loss.is_finite() && step.planned == 300);
                self.0.borrow_mut().push(step.step);
            }
        }
        let (steps, cancel) = (Steps(RefCell::default()), Cancel::new());
        let context = FitContext::new(Seed::new(0), None, &steps, &cancel);
        estimator().fit(&envelope(20), &context).unwrap();
        assert_eq!(*steps.0.borrow(), (0..=300).collect::<Vec<_>>());
        cancel.request();
        let reader = estimator().pretrain(&context).unwrap().unwrap();
        let estimate = reader.fit(&envelope(20), &context).unwrap();
        assert_eq!((estimate.stop.reached, estimate.steps), (Reached::Interrupted, 0));
        assert_eq!(steps.0.borrow().len(), 302);
    }

    /// Stopped at any step or during the calibration, the training resumes bit for bit, and each step is
    /// reported once.
    #[test]
    fn stopped_anywhere_it_goes_on_to_the_same_bits() {
        struct Stopping<'a>(u64, &'a Cancel, RefCell<Vec<Step>>);
        impl Observer for Stopping<'_> {
            fn observe(&self, step: &Step) {
                self.2.borrow_mut().push(step.clone());
                if step.step == self.0 {
                    self.1.request();
                }
            }
        }
        let fit = |kept: &Kept, stop_at: u64| {
            let cancel = Cancel::new();
            let observer = Stopping(stop_at, &cancel, RefCell::default());
            let context = FitContext::new(Seed::new(1), None, &observer, &cancel).checkpointing_to(kept);
            let estimate = estimator().fit(&envelope(40), &context).unwrap();
            (estimate, observer.2.into_inner())
        };
        let (whole, told) = fit(&Kept::default(), u64::MAX);
        for stop_at in [0, 1, 7, 150, 299, 300] {
            let kept = Kept::default();
            let (stopped, mut steps) = fit(&kept, stop_at);
            assert_eq!((stopped.stop.reached, stopped.uncertainty), (Reached::Interrupted, None));
            let from = kept.step().unwrap();
            assert_eq!(from, stop_at);
            let (resumed, after) = fit(&kept, u64::MAX);
            assert_eq!(resumed, whole, "stopped at {stop_at}");
            steps.retain(|step| step.step < from);
            steps.extend(after);
            assert_eq!(steps, told);
        }
    }

    #[test]
    fn every_end_is_told_with_what_to_do() {
        let plain = estimator();
        let one_look = Training { most_looks: 1, ..plain.training.clone() };
        let wild = Training { learning_rate: 1e300, ..plain.training.clone() };
        for (training, steps, reached, because) in [
            (
                plain.training.clone(),
                Some(4),
                Reached::BudgetSpent,
                "after 4 of 300 steps; raise fit.max_steps",
            ),
            (one_look, None, Reached::BudgetSpent, "look 1 still moved λ by"),
            (wild, None, Reached::Diverged, "lower estimator.learning_rate"),
        ] {
            let stop = fit(&Amortized { training, ..plain.clone() }, 40, steps).unwrap().stop;
            assert_eq!(stop.reached, reached, "{}", stop.because);
            assert!(stop.because.contains(because), "{}", stop.because);
        }
        let broken = Amortized { network: Pupil { scale: f64::INFINITY }, ..plain.clone() };
        assert!(matches!(fit(&broken, 40, None), Err(FitError::NotFinite { .. })));
        let prior = Prior { peaks: [30, 30], ..plain.prior.clone() };
        assert!(fit(&Amortized { prior, ..plain }, 29, None).unwrap().uncertainty.is_none());
    }

    /// Regression test: swapped limits used to end the program when a number was drawn between them.
    #[test]
    fn fewest_peaks_come_before_most() {
        let keys = [
            fields::LONGEST_SEQUENCE,
            fields::MOST_LOOKS,
            fields::MAX_STEPS,
            fields::BATCH,
            fields::LEARNING_RATE,
            fields::CALIBRATION,
            fields::PEAKS,
            fields::DECAY,
            fields::SCATTER,
            fields::UNEVENNESS,
            fields::MISSING,
            fields::BENT,
            fields::BEND,
        ];
        let new = |peaks: &str| {
            let document = Document::parse("a.toml", &format!("[estimator]\npeaks = {peaks}\n")).unwrap();
            let resolved = Resolved::new(&document, &[Section { name: "estimator", fields: &keys }]).unwrap();
            Amortized::new(Pupil { scale: 0.2 }, &resolved)
        };
        assert_eq!(new("[30, 30]").unwrap().prior.peaks, [30, 30]);
        let refused = new("[400, 10]").unwrap_err();
        assert!(matches!(refused, SettingsError::BadValue { .. }));
        assert_eq!(
            refused.to_string(),
            "a.toml:2:1: `estimator.peaks` is [400, 10]; expected the fewest peaks first, then the most"
        );
    }

    #[test]
    fn the_weights_are_all_in_the_file() {
        let estimate = fit(&estimator(), 20, Some(2)).unwrap();
        let weights = from_safetensors(&estimate.model.unwrap().bytes).unwrap();
        let count: usize = weights.iter().map(|tensor| tensor.values.len()).sum();
        assert_eq!((count, estimate.parameters), (8, 8));
    }
}
