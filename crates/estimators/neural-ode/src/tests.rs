//! Tests of whole fits.

use crate::{ENTRY, NeuralOdeConfig};
use envelope::Envelope;
use estimator::{Cancel, Estimate, Estimator, FitContext, FitError, Observer, Reached, Silent, Step};
use neural::from_safetensors;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;

const OMEGA: f64 = 21.8;

fn config() -> NeuralOdeConfig {
    let sections = [Section { name: "estimator", fields: ENTRY.fields }];
    let resolved = Resolved::new(&Document::default(), &sections).unwrap();
    resolved.section("estimator").unwrap()
}

fn times(peaks: usize) -> Vec<f64> {
    (0..peaks).map(|i| 0.288 * i as f64).collect()
}

/// Returns ln A of an envelope that is no exponential.
fn bent(t: f64) -> f64 {
    -0.6 - 0.25 * t + 0.004 * t * t
}

/// Returns a function of time with Gaussian scatter.
fn scattered(peaks: usize, of: impl Fn(f64) -> f64, scatter: f64, seed: u64) -> Envelope {
    let mut generator = Seed::new(seed).child("scatter").generator();
    let mut normal = || -> f64 { StandardNormal.sample(&mut generator) };
    let logs = times(peaks).iter().map(|&t| of(t) + scatter * normal()).collect();
    Envelope::new(times(peaks), logs, OMEGA).unwrap()
}

fn envelope() -> Envelope {
    scattered(69, bent, 0.05, 0)
}

/// Returns the slope of the least-squares line, and its value at the mean time, by the textbook formulas.
fn line(t: &[f64], y: &[f64]) -> (f64, f64, f64) {
    let n = t.len() as f64;
    let (mt, my) = (t.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = t.iter().map(|t| (t - mt).powi(2)).sum();
    let sxy: f64 = t.iter().zip(y).map(|(t, y)| (t - mt) * (y - my)).sum();
    (-sxy / sxx, mt, my)
}

fn rate(envelope: &Envelope) -> f64 {
    line(envelope.times_s(), envelope.log_amplitudes()).0
}

fn try_fit(
    envelope: &Envelope,
    seed: u64,
    max_steps: Option<u64>,
    observer: &dyn Observer,
) -> Result<Estimate, FitError> {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child("neural-ode"), max_steps, observer, &cancel);
    config().fit(envelope, &context)
}

fn fit(envelope: &Envelope, seed: u64) -> Estimate {
    try_fit(envelope, seed, None, &Silent).unwrap()
}

fn rms(differences: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = differences.map(|difference| difference * difference).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn trained_it_agrees_with_the_line() {
    for seed in 0..5 {
        let envelope = envelope();
        let estimate = fit(&envelope, seed);
        let off = (estimate.decay_rate / rate(&envelope) - 1.0).abs();
        assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
        assert!(off < 1e-8, "{off:e}");
    }
}

/// λ is a property of the fitted function: minus the slope of the line through its values at the peaks.
#[test]
fn the_rate_is_the_projection_of_the_trajectory() {
    for max_steps in [None, Some(3)] {
        let envelope = envelope();
        let estimate = try_fit(&envelope, 1, max_steps, &Silent).unwrap();
        let (projected, ..) = line(envelope.times_s(), &estimate.fitted_log_amplitudes);
        assert!((estimate.decay_rate / projected - 1.0).abs() < 1e-13);
        assert_eq!(estimate.log_amplitude, estimate.fitted_log_amplitudes[0]);
    }
}

#[test]
fn the_trajectory_follows_the_bend_and_not_the_scatter() {
    let mut share = 0.0;
    for seed in 0..10 {
        let envelope = scattered(69, bent, 0.05, seed);
        let (t, y) = (envelope.times_s(), envelope.log_amplitudes());
        let fitted = fit(&envelope, 0).fitted_log_amplitudes;
        let off = rms(fitted.iter().zip(t).map(|(fit, &t)| fit - bent(t)));
        let (slope, mt, my) = line(t, y);
        let of_the_line = rms(t.iter().map(|&t| my - slope * (t - mt) - bent(t)));
        assert!(off < 0.4 * of_the_line, "{off} {of_the_line}");
        share += off / 0.05 / 10.0;
    }
    // Five of 69 degrees of freedom pass √(5/69) = 0.27 of the scatter; some of the bend is missed.
    assert!(share < 0.45, "{share}");
}

#[test]
fn untrained_it_is_wrong_on_every_seed() {
    let envelope = envelope();
    for seed in 0..100 {
        let estimate = try_fit(&envelope, seed, Some(0), &Silent).unwrap();
        assert!((estimate.decay_rate / rate(&envelope) - 1.0).abs() > 0.01, "seed {seed}");
        assert_eq!((estimate.stop.reached, estimate.steps), (Reached::BudgetSpent, 0));
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_another_way() {
    let envelope = envelope();
    let [one, same, other] = [1, 1, 2].map(|seed| try_fit(&envelope, seed, Some(5), &Silent).unwrap());
    assert_eq!(one, same);
    assert_ne!(one.decay_rate.to_bits(), other.decay_rate.to_bits());
}

#[test]
fn it_moves_with_the_units() {
    let original = envelope();
    let expected = fit(&original, 0);
    let moved = |time: f64, shift: f64, tilt: f64| {
        let t = original.times_s();
        let y = original.log_amplitudes().iter().zip(t).map(|(y, t)| y + shift - tilt * t).collect();
        let moved = Envelope::new(t.iter().map(|t| t * time).collect(), y, OMEGA).unwrap();
        fit(&moved, 0)
    };
    let close = |found: f64, expected: f64, tolerance: f64| {
        assert!((found / expected - 1.0).abs() < tolerance, "{found} {expected}");
    };
    let error = |estimate: &Estimate| estimate.uncertainty.unwrap().std_error;
    // A power of two changes no digit.
    assert_eq!(moved(4.0, 0.0, 0.0).decay_rate, expected.decay_rate / 4.0);
    for (time, shift, tilt) in [(1e-3, 0.0, 0.0), (3e5, 0.0, 0.0), (1.0, 3.7, 0.0), (1.0, 0.0, 0.6)] {
        let found = moved(time, shift, tilt);
        close(found.decay_rate, (expected.decay_rate + tilt) / time, 1e-8);
        // A tilt changes the scale of ln A, and so the flexibility of the trajectory.
        close(error(&found), error(&expected) / time, if tilt == 0.0 { 1e-6 } else { 0.05 });
    }
}

#[test]
fn an_exponential_without_scatter_is_recovered() {
    for (peaks, decay) in [(3, 0.2), (4, -0.1), (69, 0.19), (69, -0.02), (300, 1e-3)] {
        let envelope = scattered(peaks, |t| 1.3 - decay * t, 0.0, 0);
        let estimate = fit(&envelope, 0);
        let off = (estimate.decay_rate / decay - 1.0).abs();
        assert!(off < 1e-7, "{peaks} {decay} {off:e} {:?}", estimate.stop);
        assert!((estimate.log_amplitude - 1.3).abs() < 1e-6);
    }
}

#[test]
fn any_envelope_gives_numbers_or_a_reason() {
    let wild = |peaks| scattered(peaks, |_| 0.0, 1.0, 3);
    let gap: Vec<f64> = (0..30).map(|i| if i < 29 { 1e-6 * f64::from(i) } else { 50.0 }).collect();
    let outlier = |i: i32| if i == 7 { 40.0 } else { -0.1 * f64::from(i) };
    let envelopes = [
        wild(3),
        wild(4),
        wild(5),
        wild(2000),
        Envelope::new(gap.clone(), gap.iter().map(|t| -0.3 * t + 1e-3 * (9e5 * t).sin()).collect(), 1.0)
            .unwrap(),
        Envelope::new(times(30), (0..30).map(outlier).collect(), 1.0).unwrap(),
        Envelope::new(times(30), (0..30).map(|i| 1e100 * f64::from(i)).collect(), 1.0).unwrap(),
    ];
    for envelope in &envelopes {
        let estimate = fit(envelope, 0);
        assert!(estimate.decay_rate.is_finite() && estimate.log_amplitude.is_finite());
        assert!(estimate.fitted_log_amplitudes.iter().all(|fitted| fitted.is_finite()));
        assert_eq!(estimate.fitted_log_amplitudes.len(), envelope.len());
        let scale = rms(envelope.log_amplitudes().iter().copied());
        let span = envelope.times_s().last().unwrap();
        let off = (estimate.decay_rate - rate(envelope)).abs() * span / scale;
        assert!(off < 1e-6, "{off:e} {} peaks {:?}", envelope.len(), estimate.stop);
    }
}

#[test]
fn an_envelope_without_spread_is_refused() {
    let flat = Envelope::new(times(4), vec![0.3; 4], OMEGA).unwrap();
    assert!(matches!(try_fit(&flat, 0, None, &Silent), Err(FitError::NoSpread { .. })));
    let brief: Vec<f64> = (0..4).map(|i| 1e-310 * f64::from(i)).collect();
    let brief = Envelope::new(brief, vec![3.0, 2.0, 1.0, 0.0], OMEGA).unwrap();
    assert!(matches!(try_fit(&brief, 0, None, &Silent), Err(FitError::NoSpread { .. })));
}

#[test]
fn every_step_is_told_once() {
    struct Steps(RefCell<Vec<Step>>);
    impl Observer for Steps {
        fn observe(&self, step: &Step) {
            self.0.borrow_mut().push(step.clone());
        }
    }
    let steps = Steps(RefCell::default());
    let estimate = try_fit(&envelope(), 0, None, &steps).unwrap();
    let told = steps.0.into_inner();
    let numbers: Vec<u64> = told.iter().map(|step| step.step).collect();
    assert_eq!(numbers, (0..=estimate.steps).collect::<Vec<_>>());
    assert_eq!(told.last().unwrap().decay_rate, estimate.decay_rate);
}

#[test]
fn a_request_to_stop_is_heard() {
    let cancel = Cancel::new();
    cancel.request();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
    let estimate = config().fit(&envelope(), &context).unwrap();
    assert_eq!((estimate.stop.reached, estimate.steps), (Reached::Interrupted, 0));
}

#[test]
fn the_file_holds_every_parameter() {
    let estimate = fit(&envelope(), 0);
    let tensors = from_safetensors(&estimate.model.unwrap().bytes).unwrap();
    let held: usize = tensors.iter().map(|tensor| tensor.values.len()).sum();
    assert_eq!((held, estimate.parameters), (26, 26));
    assert!(tensors.iter().any(|tensor| tensor.name == "initial_state"));
}

/// Returns the share of 95 % intervals that hold the truth, over envelopes of 20 to 100 peaks.
fn coverage(replicates: usize) -> f64 {
    let holds = |&replicate: &usize| {
        let peaks = 20 + replicate * 80 / replicates;
        let scatter = if replicate % 2 == 0 { 0.2 } else { 0.01 };
        let envelope = scattered(peaks, |t| -0.6 - 0.19 * t, scatter, replicate as u64);
        let [low, high] = fit(&envelope, replicate as u64).uncertainty.unwrap().interval_95;
        (low..=high).contains(&0.19)
    };
    (0..replicates).filter(holds).count() as f64 / replicates as f64
}

/// The share of forty intervals has a standard deviation of 3.4 % about 95 %.
#[test]
fn the_interval_holds_the_truth_as_often_as_it_says() {
    let share = coverage(40);
    assert!((share - 0.95).abs() < 0.055, "{share}");
}

/// The share of five hundred has 1.0 %: `cargo test -p estimator-neural-ode of_five_hundred -- --ignored`
#[test]
#[ignore = "takes minutes"]
fn of_five_hundred_intervals_as_many_hold_the_truth_as_they_say() {
    let share = coverage(500);
    assert!((share - 0.95).abs() < 0.025, "{share}");
}

fn fit_at(envelope: &Envelope, seed: u64, times: &[f64]) -> Estimate {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child("neural-ode"), None, &Silent, &cancel);
    config().fit(envelope, &context.predicting_at(times)).unwrap()
}

#[test]
fn at_the_peaks_predictions_are_the_fitted_function() {
    let envelope = envelope();
    // Times beyond the record are included, which leave the trajectory within it unchanged.
    let times: Vec<f64> = envelope.times_s().iter().copied().chain([30.0, -4.0]).collect();
    let estimate = fit_at(&envelope, 0, &times);
    assert_eq!(estimate.predictions.len(), times.len());
    for (prediction, fitted) in estimate.predictions.iter().zip(&estimate.fitted_log_amplitudes) {
        assert!((prediction.log_amplitude - fitted).abs() < 1e-12);
    }
    // Asking for predictions changes nothing else.
    assert_eq!(Estimate { predictions: Vec::new(), ..estimate }, fit(&envelope, 0));
}

#[test]
fn an_exponential_is_extrapolated() {
    let envelope = scattered(69, |t| 1.3 - 0.2 * t, 0.0, 0);
    let times = [-5.0, 3.3, 25.0, 40.0];
    for (time, found) in times.iter().zip(fit_at(&envelope, 0, &times).predictions) {
        let off = (found.log_amplitude - 1.3 + 0.2 * time).abs();
        assert!(off < 1e-6, "{time}: {off:e} {found:?}");
    }
    let times = [1e5, -1e300, 2.0];
    let estimate = fit_at(&envelope, 0, &times);
    assert!(estimate.predictions[0].log_amplitude.is_nan() && estimate.predictions[1].std_error.is_none());
    assert_eq!(estimate.first_without_prediction(&times), Some(-1e300));
}

#[test]
fn predictive_intervals_hold_fresh_peaks() {
    let (mut held, replicates) = (0, 15);
    // Times from the first peak to a sixth of the record beyond the last.
    let times: Vec<f64> = (0..20).map(|i| 0.5 * f64::from(i)).collect();
    for replicate in 0..replicates {
        let envelope = scattered(30, |t| -0.6 - 0.19 * t, 0.1, replicate);
        let fresh = scattered(20, |_| 0.0, 0.1, 1000 + replicate);
        let found = fit_at(&envelope, replicate, &times).predictions;
        held += found
            .iter()
            .zip(times.iter().zip(fresh.log_amplitudes()))
            .filter(|(found, (time, fresh))| {
                let off = *fresh - 0.6 - 0.19 * *time - found.log_amplitude;
                // Quantile of Student's t with about 26 degrees of freedom.
                off.abs() <= 2.0555 * found.std_error.unwrap()
            })
            .count();
    }
    let count = (20 * replicates) as f64;
    let share = held as f64 / count;
    // The bounds are four standard deviations of such a share.
    assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / count).sqrt(), "{share}");
}
