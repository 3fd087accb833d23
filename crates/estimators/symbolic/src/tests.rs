//! Tests of the whole method.

use crate::{ENTRY, SymbolicConfig};
use envelope::Envelope;
use estimator::{Cancel, Estimate, Estimator, FitContext, FitError, Observer, Reached, Silent, Step};
use rand::RngExt;
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;

fn config() -> SymbolicConfig {
    let sections = [Section { name: "estimator", fields: ENTRY.fields }];
    let resolved = Resolved::new(&Document::default(), &sections).unwrap();
    resolved.section("estimator").unwrap()
}

fn scatter(i: usize) -> f64 {
    (i * 7919 % 101) as f64 / 101.0 - 0.5
}

/// Returns an envelope of 69 peaks at uneven times around a curve.
fn around(curve: impl Fn(f64) -> f64, width: f64) -> Envelope {
    let times: Vec<f64> = (0..69).map(|i| 0.288 * i as f64 + 0.1 * scatter(i + 31)).collect();
    let logs = times.iter().enumerate().map(|(i, &t)| curve(t) + width * scatter(i)).collect();
    Envelope::new(times, logs, 21.8).unwrap()
}

/// Returns an envelope that is no exponential: it bends and scatters.
fn envelope() -> Envelope {
    around(|t| -0.6 - 0.25 * t + 0.004 * t * t, 0.2)
}

/// Returns minus the slope of the least-squares line and its standard error, by the textbook formulas.
fn line(envelope: &Envelope) -> (f64, f64) {
    let (t, y) = (envelope.times_s(), envelope.log_amplitudes());
    let n = t.len() as f64;
    let (mt, my) = (t.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = t.iter().map(|t| (t - mt).powi(2)).sum();
    let sxy: f64 = t.iter().zip(y).map(|(t, y)| (t - mt) * (y - my)).sum();
    let slope = sxy / sxx;
    let rss: f64 = t.iter().zip(y).map(|(t, y)| (y - my - slope * (t - mt)).powi(2)).sum();
    (-slope, (rss / (n - 2.0) / sxx).sqrt())
}

fn try_fit(envelope: &Envelope, seed: u64, max_steps: Option<u64>) -> Result<Estimate, FitError> {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child("symbolic"), max_steps, &Silent, &cancel);
    config().fit(envelope, &context)
}

fn fit(envelope: &Envelope, seed: u64) -> Estimate {
    try_fit(envelope, seed, None).unwrap()
}

fn fit_at(envelope: &Envelope, seed: u64, times: &[f64]) -> Estimate {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child("symbolic"), None, &Silent, &cancel);
    config().fit(envelope, &context.predicting_at(times)).unwrap()
}

fn rms(estimate: &Estimate, envelope: &Envelope) -> f64 {
    let pairs = estimate.fitted_log_amplitudes.iter().zip(envelope.log_amplitudes());
    (pairs.map(|(one, other)| (one - other).powi(2)).sum::<f64>() / envelope.len() as f64).sqrt()
}

#[test]
fn evolved_it_agrees_with_the_line() {
    let (rate, _) = line(&envelope());
    for seed in 0..10 {
        let estimate = fit(&envelope(), seed);
        assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
        assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-10, "{:e}", estimate.decay_rate / rate - 1.0);
    }
}

#[test]
fn not_evolved_it_is_wrong_on_every_seed() {
    for envelope in [envelope(), around(|t| 0.3 - 0.19 * t, 1.0), around(|t| 0.05 * t, 0.1)] {
        let (rate, _) = line(&envelope);
        for seed in 0..100 {
            let estimate = try_fit(&envelope, seed, Some(0)).unwrap();
            assert!((estimate.decay_rate / rate - 1.0).abs() > 0.5, "seed {seed}");
            assert_eq!((estimate.stop.reached, estimate.steps), (Reached::BudgetSpent, 0));
            assert_eq!((estimate.uncertainty, estimate.model), (None, None));
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_another_way() {
    let [one, same, other] = [1, 1, 2].map(|seed| try_fit(&envelope(), seed, Some(3)).unwrap());
    assert_eq!(one, same);
    assert_ne!(one, other);
}

#[test]
fn shifts_stretches_and_added_decays_go_through() {
    let original = envelope();
    let rate = fit(&original, 3).decay_rate;
    let changed = |times: &dyn Fn(f64) -> f64, logs: &dyn Fn(f64, f64) -> f64, expected: f64| {
        let new_logs = original.times_s().iter().zip(original.log_amplitudes()).map(|(&t, &y)| logs(t, y));
        let new_logs = new_logs.collect();
        let new_times = original.times_s().iter().map(|&t| times(t)).collect();
        let found = fit(&Envelope::new(new_times, new_logs, 21.8).unwrap(), 3).decay_rate;
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    };
    changed(&|t| t, &|_, y| y + 7.0, rate);
    changed(&|t| 1e3 * t, &|_, y| y, rate / 1e3);
    changed(&|t| 0.0078125 * t, &|_, y| y, rate * 128.0);
    changed(&|t| t, &|t, y| y - 0.7 * t, rate + 0.7);
    changed(&|t| t, &|t, y| y + 0.7 * t, rate - 0.7);
    changed(&|t| t, &|_, y| -3.0 * y, rate * -3.0);
}

#[test]
fn an_exponential_is_recovered_as_a_line() {
    for (rate, peaks) in [(0.19, 69), (0.19, 3), (0.19, 4), (-0.05, 40), (8.0, 200), (0.19, 3000)] {
        let times: Vec<f64> = (0..peaks).map(|i| 0.288 * f64::from(i)).collect();
        let logs = times.iter().map(|t| 0.3 - rate * t).collect();
        let estimate = fit(&Envelope::new(times, logs, 21.8).unwrap(), 0);
        assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-12, "{rate} {peaks} {estimate:?}");
        assert_eq!(estimate.stop.reached, Reached::Converged, "{rate} {:?}", estimate.stop);
        let text = String::from_utf8(estimate.model.unwrap().bytes).unwrap();
        let sign = if rate > 0.0 { '-' } else { '+' };
        let expected = format!("ln A = 0.3 {sign} {}*t", rate.abs());
        assert_eq!(text.lines().next(), Some(expected.as_str()));
        assert!(estimate.stop.because.ends_with(&expected), "{:?}", estimate.stop);
    }
}

#[test]
fn a_bend_is_discovered() {
    // Viscous damping with dry friction: the amplitude also falls by a constant rate.
    let dry = |t: f64| (1.2 * (-0.1 * t).exp() - 0.1).ln();
    let bent = around(dry, 0.02);
    let straight: f64 = {
        let (rate, _) = line(&bent);
        let logs = bent.times_s().iter().zip(bent.log_amplitudes());
        let rest: Vec<f64> = logs.map(|(t, y)| y + rate * t).collect();
        let mean = rest.iter().sum::<f64>() / 69.0;
        (rest.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / 69.0).sqrt()
    };
    for seed in 0..3 {
        let estimate = fit(&bent, seed);
        // The scatter is 0.02/√12 = 0.006.
        let left = rms(&estimate, &bent);
        assert!(left < 0.012 && left < straight / 4.0, "{left} {straight} {:?}", estimate.stop);
    }
}

#[test]
fn no_envelope_is_too_odd() {
    let odd = [
        (vec![0.0, 1e-9, 1e9], vec![1.0, -1.0, 5.0]),
        (vec![0.0, 1.0, 2.0], vec![0.0, 1e5, -1e5]),
        (vec![0.0, 1.0, 2.0], vec![0.0, 1e-9, -1e-9]),
        (vec![0.0, 1.0, 2.0, 3.0], vec![1e9, 1e9 + 1.0, 1e9, 1e9 - 1.0]),
        (vec![0.0, 1e-200, 2e-200], vec![0.0, 1.0, 0.0]),
        (vec![0.0, 1.0, 2.0, 3.0, 4.0], vec![0.0, 0.0, 0.0, 0.0, 1e150]),
    ];
    for (times, logs) in odd {
        let envelope = Envelope::new(times, logs, 6.0).unwrap();
        for max_steps in [Some(0), Some(1), None] {
            let estimate = try_fit(&envelope, 0, max_steps).unwrap();
            assert!(estimate.decay_rate.is_finite() && estimate.log_amplitude.is_finite(), "{estimate:?}");
            assert!(estimate.fitted_log_amplitudes.iter().all(|log| log.is_finite()), "{estimate:?}");
            assert_eq!(estimate.fitted_log_amplitudes.len(), envelope.len());
        }
    }
}

#[test]
fn a_constant_envelope_is_refused() {
    let flat = Envelope::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.3; 4], 6.0).unwrap();
    assert!(matches!(try_fit(&flat, 0, None), Err(FitError::NoSpread { .. })));
}

#[test]
fn the_interval_covers_as_often_as_it_says() {
    let mut generator = Seed::new(5).generator();
    let trials: usize = 200;
    let covered = (0..trials)
        .filter(|&trial| {
            let times: Vec<f64> = (0..20 + trial % 60).map(|i| 0.288 * i as f64).collect();
            // A sum of twelve uniform numbers is close enough to a Gaussian.
            let mut scatter = || (0..12).map(|_| generator.random::<f64>()).sum::<f64>() - 6.0;
            let logs = times.iter().map(|t| -0.6 - 0.19 * t + 0.2 * scatter()).collect();
            let envelope = Envelope::new(times, logs, 21.8).unwrap();
            let [low, high] = fit(&envelope, trial as u64).uncertainty.unwrap().interval_95;
            (low..=high).contains(&0.19)
        })
        .count();
    // 190 are expected, with a standard deviation of 3.1.
    assert!((180..=199).contains(&covered), "{covered}");
}

#[test]
fn around_an_exponential_the_line_is_chosen_with_its_error() {
    let scattered = around(|t| 0.3 - 0.19 * t, 0.3);
    let (rate, std_error) = line(&scattered);
    let estimate = fit(&scattered, 0);
    assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-12);
    assert!((estimate.uncertainty.unwrap().std_error / std_error - 1.0).abs() < 1e-10);
    assert!(estimate.stop.because.ends_with("*t"), "{:?}", estimate.stop);
}

#[test]
fn every_step_is_told_once_and_a_request_to_stop_is_heard() {
    struct Steps(RefCell<Vec<u64>>);
    impl Observer for Steps {
        fn observe(&self, step: &Step) {
            assert!(step.loss.is_finite() && step.decay_rate.is_finite(), "{step:?}");
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

#[test]
fn at_the_peaks_predictions_are_the_fitted_function() {
    let envelope = envelope();
    let estimate = fit_at(&envelope, 3, envelope.times_s());
    assert_eq!(estimate.predictions.len(), envelope.len());
    for (prediction, fitted) in estimate.predictions.iter().zip(&estimate.fitted_log_amplitudes) {
        assert!((prediction.log_amplitude - fitted).abs() < 1e-12);
    }
    // Asking for predictions changes nothing else.
    assert_eq!(Estimate { predictions: Vec::new(), ..estimate }, fit(&envelope, 3));
}

#[test]
fn a_line_is_extrapolated_with_the_textbook_s_error() {
    let envelope = around(|t| 0.3 - 0.19 * t, 0.3);
    let times = [-5.0, 0.0, 8.0, 60.0];
    let estimate = fit_at(&envelope, 0, &times);
    let (rate, std_error) = line(&envelope);
    let t = envelope.times_s();
    let mean = t.iter().sum::<f64>() / 69.0;
    let level = envelope.log_amplitudes().iter().sum::<f64>() / 69.0;
    let spread: f64 = t.iter().map(|t| (t - mean).powi(2)).sum();
    for (time, prediction) in times.iter().zip(&estimate.predictions) {
        assert!((prediction.log_amplitude - level + rate * (time - mean)).abs() < 1e-10, "{time}");
        let variance = std_error.powi(2) * (spread * (1.0 + 1.0 / 69.0) + (time - mean).powi(2));
        assert!((prediction.std_error.unwrap() / variance.sqrt() - 1.0).abs() < 1e-9, "{time}");
    }
    assert!(estimate.equation.unwrap().ends_with("*t"));
}

#[test]
fn not_evolved_it_predicts_without_an_error() {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), Some(0), &Silent, &cancel).predicting_at(&[3.0, 0.0]);
    let estimate = config().fit(&envelope(), &context).unwrap();
    assert_eq!(estimate.predictions.len(), 2);
    assert!(estimate.predictions.iter().all(|found| found.std_error.is_none()));
    assert_eq!(estimate.predictions[1].log_amplitude, estimate.log_amplitude);
    assert!(estimate.equation.unwrap().starts_with("ln A = "));
}

#[test]
fn predictive_intervals_hold_fresh_peaks() {
    let mut generator = Seed::new(6).generator();
    let mut scatter = || 0.2 * ((0..12).map(|_| generator.random::<f64>()).sum::<f64>() - 6.0);
    let truth = |time: f64| -0.6 - 0.19 * time;
    let trials: u32 = 120;
    let held = (0..trials)
        .filter(|&trial| {
            let times: Vec<f64> = (0..60).map(|i| 0.3 * f64::from(i)).collect();
            let logs = times.iter().map(|&t| truth(t) + scatter()).collect();
            // Times from the first peak to a quarter of the record beyond the last.
            let asked = 22.0 * f64::from(trial) / f64::from(trials);
            let envelope = Envelope::new(times, logs, 21.8).unwrap();
            let prediction = fit_at(&envelope, u64::from(trial), &[asked]).predictions[0];
            let off = truth(asked) + scatter() - prediction.log_amplitude;
            // Quantile of Student's t with 58 degrees of freedom.
            off.abs() <= 2.0017 * prediction.std_error.unwrap()
        })
        .count();
    let share = held as f64 / f64::from(trials);
    // The bounds are four standard deviations of such a share.
    assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt(), "{share}");
}
