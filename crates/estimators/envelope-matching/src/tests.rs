//! Tests of the whole method.

use crate::{ENTRY, EnvelopeMatchingConfig};
use envelope::Envelope;
use estimator::{Cancel, Estimate, Estimator, FitContext, FitError, Observer, Reached, Silent, Step};
use rand::RngExt;
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;

fn config() -> EnvelopeMatchingConfig {
    let sections = [Section { name: "estimator", fields: ENTRY.fields }];
    let resolved = Resolved::new(&Document::default(), &sections).unwrap();
    resolved.section("estimator").unwrap()
}

/// Returns an envelope that is no exponential, at uneven times: it bends and scatters.
fn envelope() -> Envelope {
    let scatter = |i: usize| (i * 7919 % 101) as f64 / 101.0 - 0.5;
    let times: Vec<f64> = (0..69).map(|i| 0.288 * i as f64 + 0.1 * scatter(i + 31)).collect();
    let logs =
        times.iter().enumerate().map(|(i, t)| -0.6 - 0.25 * t + 0.004 * t * t + 0.05 * scatter(i)).collect();
    Envelope::new(times, logs, 21.8).unwrap()
}

/// Returns minus the slope of the least-squares line, its height at time 0 and the standard error, by the
/// textbook formulas.
fn line(envelope: &Envelope) -> (f64, f64, f64) {
    let (t, y) = (envelope.times_s(), envelope.log_amplitudes());
    let n = t.len() as f64;
    let (mt, my) = (t.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = t.iter().map(|t| (t - mt).powi(2)).sum();
    let sxy: f64 = t.iter().zip(y).map(|(t, y)| (t - mt) * (y - my)).sum();
    let slope = sxy / sxx;
    let rss: f64 = t.iter().zip(y).map(|(t, y)| (y - my - slope * (t - mt)).powi(2)).sum();
    (-slope, my - slope * mt, (rss / (n - 2.0) / sxx).sqrt())
}

fn try_fit(envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Result<Estimate, FitError> {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child("envelope-matching"), max_steps, &Silent, &cancel);
    config().fit(envelope, &context)
}

fn fit(envelope: &Envelope, seed: u64) -> Estimate {
    try_fit(envelope, seed, None).unwrap()
}

/// Returns the envelope with its times and logarithms changed.
fn changed(times: impl Fn(f64) -> f64, logs: impl Fn(f64, f64) -> f64) -> Envelope {
    let (envelope, omega) = (envelope(), 21.8);
    let new_logs = envelope.times_s().iter().zip(envelope.log_amplitudes()).map(|(&t, &y)| logs(t, y));
    let new_logs = new_logs.collect();
    Envelope::new(envelope.times_s().iter().map(|&t| times(t)).collect(), new_logs, omega).unwrap()
}

#[test]
fn matched_it_agrees_with_the_line_and_its_error() {
    let (rate, height, std_error) = line(&envelope());
    for seed in 0..10 {
        let estimate = fit(&envelope(), seed);
        assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
        assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-12, "{:e}", estimate.decay_rate / rate - 1.0);
        assert!((estimate.log_amplitude / height - 1.0).abs() < 1e-11);
        assert!((estimate.uncertainty.unwrap().std_error / std_error - 1.0).abs() < 1e-10);
        assert_eq!(estimate.fitted_log_amplitudes[0], estimate.log_amplitude);
        assert!(estimate.steps <= 12, "{}", estimate.steps);
    }
}

#[test]
fn unmatched_it_is_wrong_on_every_seed() {
    let (rate, ..) = line(&envelope());
    for seed in 0..100 {
        let estimate = try_fit(&envelope(), seed, Some(0)).unwrap();
        assert!((estimate.decay_rate / rate - 1.0).abs() > 0.5, "seed {seed}");
        assert_eq!((estimate.stop.reached, estimate.steps), (Reached::BudgetSpent, 0));
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_another_way() {
    let [one, same, other] = [1, 1, 2].map(|seed| try_fit(&envelope(), seed, Some(2)).unwrap());
    assert_eq!(one, same);
    assert_ne!(one.decay_rate.to_bits(), other.decay_rate.to_bits());
}

#[test]
fn shifts_stretches_and_added_decays_go_through() {
    let rate = fit(&envelope(), 3).decay_rate;
    let near = |found: Envelope, expected: f64| {
        let found = fit(&found, 3).decay_rate;
        assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
    };
    near(changed(|t| t, |_, y| y + 7.0), rate);
    near(changed(|t| 1e3 * t, |_, y| y), rate / 1e3);
    near(changed(|t| 1e-3 * t, |_, y| y), rate * 1e3);
    near(changed(|t| t, |t, y| y - 0.7 * t), rate + 0.7);
    near(changed(|t| t, |t, y| y + 0.7 * t), rate - 0.7);
    near(changed(|t| t, |_, y| 1e3 * y), rate * 1e3);
}

#[test]
fn an_exponential_is_recovered() {
    for (rate, peaks) in [(0.19, 69), (0.19, 3), (-0.05, 40), (8.0, 200), (1e-9, 50)] {
        let times: Vec<f64> = (0..peaks).map(|i| 0.288 * f64::from(i)).collect();
        let logs = times.iter().map(|t| 0.3 - rate * t).collect();
        let estimate = fit(&Envelope::new(times, logs, 21.8).unwrap(), 0);
        // The simulation's rounding, 1e-13 in ln A, limits the accuracy for a decay that hardly changes ln A.
        let tolerance = 1e-12 + 1e-12 / (0.288 * f64::from(peaks) * rate.abs());
        assert!((estimate.decay_rate / rate - 1.0).abs() < tolerance, "{rate} {estimate:?}");
        assert_eq!(estimate.stop.reached, Reached::Converged, "{rate} {:?}", estimate.stop);
    }
}

#[test]
fn no_envelope_is_too_odd() {
    let two_pi = std::f64::consts::TAU;
    let odd = [
        (vec![0.0, 1e-9, 1e9], vec![1.0, -1.0, 5.0], 1.0),
        (vec![0.0, 1.0, 2.0], vec![0.0, 1e3, -1e3], two_pi),
        (vec![0.0, 1.0, 2.0], vec![0.0, 1e-6, -1e-6], 1e-6),
        (vec![0.0, 1.0, 2.0, 3.0], vec![1e9, 1e9 + 1.0, 1e9, 1e9 - 1.0], 1e6),
        (vec![0.0, 1e-200, 2e-200], vec![0.0, 1.0, 0.0], 1.0),
    ];
    for (times, logs, omega) in odd {
        let envelope = Envelope::new(times, logs, omega).unwrap();
        for max_steps in [Some(0), None] {
            let estimate = try_fit(&envelope, 0, max_steps).unwrap();
            assert!(estimate.decay_rate.is_finite() && estimate.log_amplitude.is_finite(), "{estimate:?}");
            assert!(estimate.fitted_log_amplitudes.iter().all(|log| log.is_finite()), "{estimate:?}");
            assert_eq!(estimate.fitted_log_amplitudes.len(), envelope.len());
        }
        let (rate, ..) = line(&envelope);
        let estimate = fit(&envelope, 0);
        let scale = rate.abs() + estimate.uncertainty.unwrap().std_error;
        // Times of 1e-200 s are too short for the textbook formulas.
        assert!(rate.is_nan() || (estimate.decay_rate - rate).abs() < 1e-6 * scale, "{rate} {estimate:?}");
    }
}

#[test]
fn a_constant_envelope_is_refused() {
    let flat = Envelope::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.3; 4], 6.0).unwrap();
    assert!(matches!(try_fit(&flat, 0, None), Err(FitError::NoSpread { .. })));
}

#[test]
fn a_long_record_is_matched() {
    let times: Vec<f64> = (0..3000).map(|i| 0.288 * f64::from(i)).collect();
    let logs = times.iter().enumerate().map(|(i, t)| -2.0 * t + (i * 7919 % 101) as f64 / 50.0).collect();
    let envelope = Envelope::new(times, logs, 21.8).unwrap();
    let (rate, ..) = line(&envelope);
    assert!((fit(&envelope, 0).decay_rate / rate - 1.0).abs() < 1e-11);
    // With fewer simulated periods than the record has, a slower oscillator has the same envelope.
    let slow = EnvelopeMatchingConfig { most_periods: 1000, ..config() };
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
    assert!((slow.fit(&envelope, &context).unwrap().decay_rate / rate - 1.0).abs() < 1e-11);
}

#[test]
fn the_interval_covers_as_often_as_it_says() {
    let mut generator = Seed::new(5).generator();
    let covered = (0..500)
        .filter(|&trial| {
            let peaks = 20 + trial % 30;
            let times: Vec<f64> = (0..peaks).map(|i| 0.288 * i as f64).collect();
            // A sum of twelve uniform numbers is close enough to a Gaussian.
            let logs = times
                .iter()
                .map(|t| {
                    let sum: f64 = (0..12).map(|_| generator.random::<f64>()).sum();
                    -0.6 - 0.19 * t + 0.1 * (sum - 6.0)
                })
                .collect();
            let envelope = Envelope::new(times, logs, 21.8).unwrap();
            let [low, high] = fit(&envelope, trial).uncertainty.unwrap().interval_95;
            (low..=high).contains(&0.19)
        })
        .count();
    // 475 are expected, with a standard deviation of 4.9.
    assert!((460..=490).contains(&covered), "{covered}");
}

#[test]
fn every_step_is_told_once_and_a_request_to_stop_is_heard() {
    struct Steps(RefCell<Vec<u64>>);
    impl Observer for Steps {
        fn observe(&self, step: &Step) {
            self.0.borrow_mut().push(step.step);
        }
    }
    let (steps, cancel) = (Steps(RefCell::default()), Cancel::new());
    let estimate = config().fit(&envelope(), &FitContext::new(Seed::new(0), None, &steps, &cancel)).unwrap();
    assert_eq!(*steps.0.borrow(), (0..=estimate.steps).collect::<Vec<_>>());
    cancel.request();
    let stopped = config().fit(&envelope(), &FitContext::new(Seed::new(0), None, &steps, &cancel)).unwrap();
    assert_eq!((stopped.stop.reached, stopped.steps), (Reached::Interrupted, 0));
}

fn fit_at(envelope: &Envelope, seed: u64, times: &[f64]) -> Estimate {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child("envelope-matching"), None, &Silent, &cancel);
    config().fit(envelope, &context.predicting_at(times)).unwrap()
}

#[test]
fn at_the_peaks_predictions_are_the_fitted_function() {
    // Backward, since the order of the times does not matter.
    let times: Vec<f64> = envelope().times_s().iter().rev().copied().collect();
    let estimate = fit_at(&envelope(), 0, &times);
    assert_eq!(estimate.predictions.len(), times.len());
    for (prediction, fitted) in estimate.predictions.iter().rev().zip(&estimate.fitted_log_amplitudes) {
        assert!((prediction.log_amplitude - fitted).abs() < 1e-14);
    }
    // Asking for predictions changes nothing else.
    assert_eq!(Estimate { predictions: Vec::new(), ..estimate }, fit(&envelope(), 0));
}

#[test]
fn the_oscillator_is_followed_both_ways_with_the_textbook_s_error() {
    let (rate, height, std_error) = line(&envelope());
    let times = [60.0, -4.0, 0.0, 8.0, 400.0];
    let estimate = fit_at(&envelope(), 0, &times);
    let t = envelope().times_s().to_vec();
    let mean = t.iter().sum::<f64>() / 69.0;
    let spread: f64 = t.iter().map(|t| (t - mean).powi(2)).sum();
    for (time, prediction) in times.iter().zip(&estimate.predictions) {
        let off = prediction.log_amplitude - (height - rate * time);
        assert!(off.abs() < 1e-10, "{time}: {off:e}");
        let variance = std_error.powi(2) * (spread * (1.0 + 1.0 / 69.0) + (time - mean).powi(2));
        assert!((prediction.std_error.unwrap() / variance.sqrt() - 1.0).abs() < 1e-9, "{time}");
    }
}

#[test]
fn what_the_simulation_does_not_reach_is_not_predicted() {
    let times = [1e9, 5.0, -1e9];
    let estimate = fit_at(&envelope(), 0, &times);
    let finite: Vec<bool> =
        estimate.predictions.iter().map(|found| found.log_amplitude.is_finite()).collect();
    assert_eq!(finite, [false, true, false]);
    assert_eq!(estimate.first_without_prediction(&times), Some(-1e9));
}

#[test]
fn predictive_intervals_hold_fresh_peaks() {
    let mut generator = Seed::new(6).generator();
    let mut scatter = || 0.1 * ((0..12).map(|_| generator.random::<f64>()).sum::<f64>() - 6.0);
    let trials: u32 = 500;
    let held = (0..trials)
        .filter(|&trial| {
            let times: Vec<f64> = (0..30).map(|i| 0.288 * f64::from(i)).collect();
            let logs = times.iter().map(|t| -0.6 - 0.19 * t + scatter()).collect();
            let envelope = Envelope::new(times, logs, 21.8).unwrap();
            // Times from the first peak to one record length beyond the last.
            let time = 16.0 * f64::from(trial) / f64::from(trials);
            let found = fit_at(&envelope, u64::from(trial), &[time]).predictions[0];
            // Quantile of Student's t with 28 degrees of freedom.
            (scatter() - 0.6 - 0.19 * time - found.log_amplitude).abs() <= 2.0484 * found.std_error.unwrap()
        })
        .count();
    let share = held as f64 / f64::from(trials);
    // The bounds are four standard deviations of such a share.
    assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt(), "{share}");
}
