//! Tests of whole fits that every network trained on one envelope must pass. The module that includes this
//! file defines `Config`, the settings, and `WEIGHT`, the name of one of the weights.

use super::{Config, WEIGHT};
use crate::ENTRY;
use conformance::{Line, least_squares};
use envelope::Envelope;
use estimator::{Cancel, Estimate, Estimator, FitContext, FitError, Observer, Reached, Silent, Step};
use neural::from_safetensors;
use rand::RngExt;
use rand_distr::StandardNormal;
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;

fn config() -> Config {
    let sections = [Section { name: "estimator", fields: ENTRY.fields }];
    let resolved = Resolved::new(&Document::default(), &sections).unwrap();
    resolved.section("estimator").unwrap()
}

fn scatter(at: usize) -> f64 {
    (at * 7919 % 101) as f64 / 101.0 - 0.5
}

/// Returns slightly uneven times.
fn times(count: usize) -> Vec<f64> {
    (0..count).map(|at| 0.288 * at as f64 + 0.02 * (scatter(at) - scatter(0))).collect()
}

fn envelope_of(log_amplitude: impl Fn(usize, f64) -> f64) -> Envelope {
    let times = times(69);
    let logs = times.iter().enumerate().map(|(at, &t)| log_amplitude(at, t)).collect();
    Envelope::new(times, logs, 21.8).unwrap()
}

/// Returns an envelope that is not exponential: it bends and scatters.
fn envelope() -> Envelope {
    conformance::bent().unwrap()
}

fn try_fit(envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Result<Estimate, FitError> {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child(ENTRY.id), max_steps, &Silent, &cancel);
    config().fit(envelope, &context)
}

fn fit(envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Estimate {
    try_fit(envelope, seed, max_steps).unwrap()
}

#[test]
fn trained_it_agrees_with_the_line_and_its_error() {
    let envelope = envelope();
    let Line { decay_rate: rate, std_error } = least_squares(&envelope);
    for seed in 0..10 {
        let estimate = fit(&envelope, seed, None);
        let off = (estimate.decay_rate / rate - 1.0).abs();
        assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
        assert!(off < 5e-13, "seed {seed}: {off:e}");
        let stated = estimate.uncertainty.unwrap().std_error;
        assert!((stated / std_error - 1.0).abs() < 1e-9, "{stated} {std_error}");
        assert!(estimate.steps < 40, "{}", estimate.steps);
    }
}

#[test]
fn untrained_it_is_wrong_on_every_seed() {
    let envelope = envelope();
    let rate = least_squares(&envelope).decay_rate;
    for seed in 0..100 {
        let estimate = fit(&envelope, seed, Some(0));
        assert!((estimate.decay_rate / rate - 1.0).abs() > 0.01, "seed {seed}");
        assert_eq!(estimate.stop.reached, Reached::BudgetSpent);
        assert_eq!(estimate.uncertainty, None);
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_another_way() {
    let envelope = envelope();
    let [one, same, other] = [1, 1, 2].map(|seed| fit(&envelope, seed, Some(3)));
    assert_eq!(one, same);
    assert_ne!(one.decay_rate.to_bits(), other.decay_rate.to_bits());
    // Other threads working at the same time change nothing.
    std::thread::scope(|scope| {
        for thread in [0, 1].map(|_| scope.spawn(|| fit(&envelope, 1, Some(3)))) {
            assert_eq!(thread.join().unwrap(), one);
        }
    });
}

#[test]
fn an_exact_exponential_is_recovered() {
    for rate in [0.2, 3e-6, -0.7] {
        let envelope = envelope_of(|_, t| 1.5 - rate * t);
        let estimate = fit(&envelope, 0, None);
        assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-9, "{estimate:?}");
        assert!((estimate.log_amplitude - 1.5).abs() < 1e-11, "{}", estimate.log_amplitude);
        assert_eq!(estimate.stop.reached, Reached::Converged);
    }
}

#[test]
fn it_follows_the_units() {
    let changed = |change: &dyn Fn(f64, f64) -> (f64, f64)| {
        let plain = envelope();
        let pairs = plain.times_s().iter().zip(plain.log_amplitudes());
        let (times, logs) = pairs.map(|(&time, &log)| change(time, log)).unzip();
        fit(&Envelope::new(times, logs, 21.8).unwrap(), 5, None)
    };
    let plain = fit(&envelope(), 5, None);
    let louder = changed(&|time, log| (time, log + 7.0));
    let slower = changed(&|time, log| (60.0 * time, log));
    let steeper = changed(&|time, log| (time, log - 0.4 * time));
    let rate = plain.decay_rate;
    for (found, expected) in [
        (louder.decay_rate, rate),
        (louder.log_amplitude, plain.log_amplitude + 7.0),
        (slower.decay_rate, rate / 60.0),
        (steeper.decay_rate, rate + 0.4),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// s²·(1 + 1/n + (t − t̄)²/Σ(t − t̄)²), the textbook variance of a new observation.
#[test]
fn it_predicts_a_peak_as_the_line_does() {
    let (envelope, cancel) = (envelope(), Cancel::new());
    let asked = [3.3, 0.0, 40.0];
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).predicting_at(&asked);
    let estimate = config().fit(&envelope, &context).unwrap();
    let times = envelope.times_s();
    let n = times.len() as f64;
    let middle = times.iter().sum::<f64>() / n;
    let square: f64 = times.iter().map(|t| (t - middle).powi(2)).sum();
    let variance = least_squares(&envelope).std_error.powi(2) * square;
    assert_eq!(estimate.predictions.len(), 3);
    for (prediction, t) in estimate.predictions.iter().zip(asked) {
        let expected = estimate.log_amplitude - estimate.decay_rate * t;
        assert!((prediction.log_amplitude - expected).abs() < 1e-12);
        let expected = (variance * (1.0 + 1.0 / n + (t - middle).powi(2) / square)).sqrt();
        assert!((prediction.std_error.unwrap() / expected - 1.0).abs() < 1e-9);
    }
    let untrained = FitContext::new(Seed::new(0), Some(0), &Silent, &cancel).predicting_at(&asked);
    let estimate = config().fit(&envelope, &untrained).unwrap();
    assert!(estimate.predictions.iter().all(|prediction| prediction.std_error.is_none()));
}

#[test]
fn an_envelope_longer_than_the_sequence_is_fitted_at_all_its_peaks() {
    let times: Vec<f64> = (0..3000).map(|at| 0.1 * at as f64).collect();
    let logs: Vec<f64> =
        times.iter().enumerate().map(|(at, t)| -0.02 * t + 1e-5 * t * t + scatter(at)).collect();
    let envelope = Envelope::new(times, logs, 60.0).unwrap();
    let estimate = fit(&envelope, 0, None);
    assert!((estimate.decay_rate / least_squares(&envelope).decay_rate - 1.0).abs() < 1e-11, "{estimate:?}");
    assert_eq!(estimate.fitted_log_amplitudes.len(), 3000);
}

#[test]
fn the_interval_covers_the_truth_as_often_as_it_says() {
    let mut generator = Seed::new(0).child("scatter").generator();
    let covered = (0..100).filter(|_| {
        let times: Vec<f64> = (0..20).map(|at| 0.3 * f64::from(at)).collect();
        let scattered = |t: &f64| -0.5 - 0.2 * t + 0.3 * generator.sample::<f64, _>(StandardNormal);
        let logs = times.iter().map(scattered).collect();
        let estimate = fit(&Envelope::new(times, logs, 21.0).unwrap(), 0, None);
        let [low, high] = estimate.uncertainty.unwrap().interval_95;
        (low..=high).contains(&0.2)
    });
    // Of 100, 95 ± 2.2; the bounds are four standard deviations away.
    let covered = covered.count();
    assert!((86..=100).contains(&covered), "{covered}");
}

#[test]
fn three_peaks_are_enough() {
    let envelope = Envelope::new(vec![0.0, 1.0, 2.5], vec![0.3, 0.1, -0.4], 6.0).unwrap();
    let estimate = fit(&envelope, 0, None);
    assert!((estimate.decay_rate / least_squares(&envelope).decay_rate - 1.0).abs() < 1e-12);
}

#[test]
fn envelopes_without_a_rate_are_refused() {
    for (times, logs) in [
        (vec![0.0, 1.0, 2.0, 3.0], vec![0.3; 4]),
        (vec![0.0, 1.0, 2.0], vec![1e200, 2e200, 0.0]),
        (vec![0.0, 1e-310, 2e-310], vec![2.0, 1.0, 0.0]),
    ] {
        let envelope = Envelope::new(times, logs, 6.0).unwrap();
        assert!(matches!(try_fit(&envelope, 0, None), Err(FitError::NoSpread { .. })));
    }
}

#[test]
fn every_step_is_told_once_and_a_request_to_stop_is_heard() {
    struct Steps(RefCell<Vec<u64>>);
    impl Observer for Steps {
        fn observe(&self, step: &Step) {
            assert!(step.decay_rate.is_finite() && step.loss.is_finite());
            self.0.borrow_mut().push(step.step);
        }
    }
    let (steps, cancel) = (Steps(RefCell::default()), Cancel::new());
    let fit = || {
        let context = FitContext::new(Seed::new(0), None, &steps, &cancel);
        config().fit(&envelope(), &context).unwrap()
    };
    let estimate = fit();
    assert_eq!(*steps.0.borrow(), (0..=estimate.steps).collect::<Vec<_>>());
    cancel.request();
    let estimate = fit();
    assert_eq!((estimate.stop.reached, estimate.steps), (Reached::Interrupted, 0));
}

#[test]
fn the_weights_are_all_in_the_file() {
    let estimate = fit(&envelope(), 0, Some(2));
    let weights = from_safetensors(&estimate.model.unwrap().bytes).unwrap();
    assert!(weights.iter().any(|tensor| tensor.name == WEIGHT), "{weights:?}");
    let count: usize = weights.iter().map(|tensor| tensor.values.len()).sum();
    assert_eq!(count, estimate.parameters);
}
