//! Tests of the whole estimator.

use crate::model::{Model, Prior, Statistics};
use crate::sampler::Sample;
use crate::{BayesianConfig, ENTRY, Method};
use envelope::Envelope;
use estimator::{Cancel, Estimate, Estimator, FitContext, FitError, Observer, Reached, Silent, Step};
use nalgebra::Vector3;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Gamma, StandardNormal};
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;

fn config(method: Method) -> BayesianConfig {
    let sections = [Section { name: "estimator", fields: ENTRY.fields }];
    let resolved = Resolved::new(&Document::default(), &sections).unwrap();
    BayesianConfig { method, ..resolved.section("estimator").unwrap() }
}

/// Returns an envelope that is no exponential: it bends and scatters.
fn envelope() -> Envelope {
    conformance::bent().unwrap()
}

/// Returns a line with normal scatter.
fn simulated(peaks: usize, rate: f64, sigma: f64, generator: &mut impl Rng) -> Envelope {
    let times: Vec<f64> = (0..peaks).map(|i| 0.288 * i as f64).collect();
    let logs =
        times.iter().map(|t| -0.6 - rate * t + sigma * generator.sample::<f64, _>(StandardNormal)).collect();
    Envelope::new(times, logs, 21.8).unwrap()
}

/// Returns minus the slope of the least-squares line, and its standard error, by the textbook formulas.
fn line(envelope: &Envelope) -> (f64, f64) {
    let (t, y) = (envelope.times_s(), envelope.log_amplitudes());
    let n = t.len() as f64;
    let (mt, my) = (t.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = t.iter().map(|t| (t - mt).powi(2)).sum();
    let slope = t.iter().zip(y).map(|(t, y)| (t - mt) * (y - my)).sum::<f64>() / sxx;
    let rss: f64 = t.iter().zip(y).map(|(t, y)| (y - my - slope * (t - mt)).powi(2)).sum();
    (-slope, (rss / (n - 2.0) / sxx).sqrt())
}

fn try_fit(config: &BayesianConfig, envelope: &Envelope, seed: u64) -> Result<Estimate, FitError> {
    let cancel = Cancel::new();
    config.fit(envelope, &FitContext::new(Seed::new(seed), None, &Silent, &cancel))
}

fn fit(method: Method, envelope: &Envelope, seed: u64) -> Estimate {
    try_fit(&config(method), envelope, seed).unwrap()
}

#[test]
fn the_closed_form_agrees_with_the_line_and_the_sampler_with_it() {
    let (rate, std_error) = line(&envelope());
    for seed in 0..5 {
        let estimate = fit(Method::Conjugate, &envelope(), seed);
        assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-10);
        let stated = estimate.uncertainty.unwrap().std_error;
        assert!((stated / std_error - 1.0).abs() < 1e-6, "{stated} {std_error}");
        assert!(estimate.stop.because.contains("the sampler agrees"), "{}", estimate.stop.because);
        assert!(estimate.stop.because.contains("R-hat 1.00"), "{}", estimate.stop.because);
    }
}

#[test]
fn the_sampler_alone_agrees_with_the_line_on_every_seed() {
    let (rate, std_error) = line(&envelope());
    for seed in 0..10 {
        let estimate = fit(Method::Nuts, &envelope(), seed);
        assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
        assert_eq!(estimate.steps, 1500);
        assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-4, "seed {seed}: {}", estimate.decay_rate);
        // The standard deviation of a Student's t of 67 degrees of freedom is 1.5 % above its scale.
        let stated = estimate.uncertainty.unwrap().std_error;
        assert!((stated / std_error - 1.015).abs() < 0.06, "{stated} {std_error}");
    }
}

#[test]
fn the_sampler_untrained_is_wrong_on_every_seed() {
    let (rate, _) = line(&envelope());
    for seed in 0..20 {
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(seed), Some(0), &Silent, &cancel);
        let estimate = config(Method::Nuts).fit(&envelope(), &context).unwrap();
        assert!((estimate.decay_rate / rate - 1.0).abs() > 0.01, "seed {seed}");
        assert_eq!((estimate.stop.reached, estimate.steps), (Reached::BudgetSpent, 0));
        assert!(estimate.stop.because.contains("raise fit.max_steps"), "{}", estimate.stop.because);
        assert!(estimate.uncertainty.is_none());
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_another_way() {
    for method in [Method::Conjugate, Method::Nuts] {
        let [one, same, other] = [1, 1, 2].map(|seed| fit(method, &envelope(), seed));
        assert_eq!(one, same);
        assert_ne!(one, other);
    }
}

#[test]
fn every_transition_is_told_once_and_a_request_to_stop_is_heard() {
    struct Steps(RefCell<Vec<u64>>);
    impl Observer for Steps {
        fn observe(&self, step: &Step) {
            self.0.borrow_mut().push(step.step);
        }
    }
    let (steps, cancel) = (Steps(RefCell::default()), Cancel::new());
    let context = FitContext::new(Seed::new(0), Some(200), &steps, &cancel);
    config(Method::Nuts).fit(&envelope(), &context).unwrap();
    assert_eq!(*steps.0.borrow(), (0..=200).collect::<Vec<_>>());
    cancel.request();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
    let stopped = config(Method::Nuts).fit(&envelope(), &context).unwrap();
    assert_eq!((stopped.stop.reached, stopped.steps), (Reached::Interrupted, 0));
    let closed = config(Method::Conjugate).fit(&envelope(), &context).unwrap();
    assert!(closed.stop.because.contains("interrupted"), "{}", closed.stop.because);
}

#[test]
fn it_follows_a_change_of_unit_and_an_added_decay() {
    let base = envelope();
    let changed = |time: f64, constant: f64, decay: f64| {
        let times = base.times_s().iter().map(|t| t * time).collect();
        let logs = base.times_s().iter().zip(base.log_amplitudes()).map(|(t, y)| y + constant - decay * t);
        Envelope::new(times, logs.collect(), 21.8).unwrap()
    };
    for (method, exact) in [(Method::Conjugate, 1e-10), (Method::Nuts, 1e-4)] {
        let rate = fit(method, &base, 0).decay_rate;
        let off =
            |envelope: &Envelope, expected: f64| (fit(method, envelope, 0).decay_rate / expected - 1.0).abs();
        assert!(off(&changed(1.0, 4.0, 0.0), rate) < exact);
        assert!(off(&changed(8.0, 0.0, 0.0), rate / 8.0) < exact);
        assert!(off(&changed(1.0, 0.0, 0.3), rate + 0.3) < exact);
        assert!(off(&changed(1.0, 0.0, -1.0), rate - 1.0) < exact);
    }
}

#[test]
fn an_exponential_without_scatter_is_recovered() {
    for peaks in [3, 6, 7, 20, 1000] {
        let envelope = simulated(peaks, 0.2, 0.0, &mut Seed::new(0).generator());
        let estimate = fit(Method::Conjugate, &envelope, 0);
        assert!((estimate.decay_rate / 0.2 - 1.0).abs() < 1e-9, "{peaks}: {}", estimate.decay_rate);
        let [low, high] = estimate.uncertainty.unwrap().interval_95;
        assert!(low < 0.2 && 0.2 < high, "{peaks}: {low} {high}");
        if peaks >= 7 {
            let estimate = fit(Method::Nuts, &envelope, 0);
            assert!((estimate.decay_rate / 0.2 - 1.0).abs() < 1e-4, "{peaks}: {:?}", estimate.stop);
        }
    }
}

#[test]
fn odd_envelopes_get_an_estimate_or_a_typed_error() {
    let odd: Vec<(Vec<f64>, Vec<f64>)> = vec![
        (vec![0.0, 1.0, 2.0], vec![1.0, 3.0, 2.0]),
        (vec![0.0, 1e-13, 1.0, 2.0], vec![1.0, -3.0, 2.0, 0.0]),
        ((0..7).map(|i| 1e-300 * f64::from(i)).collect(), (0..7).map(f64::from).collect()),
        ((0..7).map(|i| 1e300 * f64::from(i)).collect(), (0..7).map(f64::from).collect()),
        ((0..9).map(f64::from).collect(), (0..9).map(|i| 1e200 * f64::from(i * i)).collect()),
        ((0..9).map(f64::from).collect(), (0..9).map(|i| f64::from(i % 2)).collect()),
        ((0..9).map(f64::from).collect(), (0..9).map(|i| f64::from(u8::from(i == 4))).collect()),
        ((0..100_000).map(f64::from).collect(), (0..100_000).map(|i| (f64::from(i) * 0.7).sin()).collect()),
    ];
    for (times, logs) in odd {
        let Ok(envelope) = Envelope::new(times, logs, 6.0) else { continue };
        for method in [Method::Conjugate, Method::Nuts] {
            let Ok(estimate) = try_fit(&config(method), &envelope, 0) else { continue };
            let interval = estimate.uncertainty.map_or([0.0; 2], |stated| stated.interval_95);
            let numbers = [estimate.decay_rate, estimate.log_amplitude, interval[0], interval[1]];
            assert!(numbers.iter().all(|number| number.is_finite()), "{estimate:?}");
        }
    }
}

#[test]
fn a_constant_envelope_and_too_few_peaks_are_refused() {
    let flat = Envelope::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.3; 4], 6.0).unwrap();
    assert!(matches!(try_fit(&config(Method::Conjugate), &flat, 0), Err(FitError::NoSpread { .. })));
    let few = Envelope::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.3, 0.1, 0.0, 0.0], 6.0).unwrap();
    let error = try_fit(&config(Method::Nuts), &few, 0).unwrap_err();
    assert_eq!(error.to_string(), "bayesian needs at least 7 peaks; the envelope has 4");
    assert!(fit(Method::Conjugate, &few, 0).stop.because.contains("takes 7 peaks"));
}

#[test]
fn the_posterior_file_states_the_damping_ratio_and_its_interval() {
    let estimate = fit(Method::Conjugate, &envelope(), 0);
    let file = estimate.model.unwrap();
    let document = Document::parse(&file.name, std::str::from_utf8(&file.bytes).unwrap()).unwrap();
    let stated = document.get("damping_ratio").unwrap().value.as_float().unwrap();
    assert!((stated - estimate.decay_rate / 21.8).abs() < 1e-15);
    let interval = document.get("damping_ratio_interval_95").unwrap().value.as_array().unwrap();
    let high = interval[1].as_float().unwrap();
    assert!((high - estimate.uncertainty.unwrap().interval_95[1] / 21.8).abs() < 1e-15);
}

#[test]
fn the_intervals_cover_as_often_as_they_say() {
    let quick = BayesianConfig { check_by_sampling: false, ..config(Method::Conjugate) };
    for peaks in [5, 20, 100] {
        let mut generator = Seed::new(7).generator();
        let replicates = 4000;
        let covered = (0..replicates)
            .filter(|_| {
                let envelope = simulated(peaks, 0.2, 0.1, &mut generator);
                let [low, high] = try_fit(&quick, &envelope, 0).unwrap().uncertainty.unwrap().interval_95;
                low <= 0.2 && 0.2 <= high
            })
            .count();
        let share = covered as f64 / f64::from(replicates);
        // The bound is three standard errors of a share of 4000.
        assert!((share - 0.95).abs() < 0.0104, "{peaks}: {share}");
    }
}

/// Simulation-based calibration: truths are drawn from the prior, and data from the truths. The rank of the
/// truth among the draws is uniform if and only if the sampler draws from the posterior.
///
/// Reference: Talts, Betancourt, Simpson, Vehtari, Gelman, arXiv:1804.06788 (2018).
fn calibration(replicates: usize) {
    let prior = Prior { width: 2.0, noise_shape: 3.0, noise_rate: 0.5 };
    let tuning = BayesianConfig { draws: 250, warm_up: 200, ..config(Method::Nuts) };
    let times: Vec<f64> = (0..12).map(|i| f64::from(i) / 11.0).collect();
    let mut generator = Seed::new(11).generator();
    let mut ranks = vec![Vec::new(); 3];
    for replicate in 0..replicates {
        let precision = Gamma::new(prior.noise_shape, 1.0 / prior.noise_rate).unwrap().sample(&mut generator);
        let sigma = precision.powf(-0.5);
        let mut normal = || generator.sample::<f64, _>(StandardNormal);
        let (u, r) = (prior.width * sigma * normal(), prior.width * sigma * normal());
        let values: Vec<f64> = times.iter().map(|t| u - r * t + sigma * normal()).collect();
        let model = Model { prior, statistics: Statistics::new(&times, &values) };
        let cancel = Cancel::new();
        let seed = Seed::new(replicate as u64).child("calibration");
        let sample =
            Sample::draw(&tuning, &model, &FitContext::new(seed, None, &Silent, &cancel), |_, _, _| {});
        for (axis, truth) in [u, r, sigma.ln()].into_iter().enumerate() {
            let weights = Vector3::from_fn(|row, _| f64::from(u8::from(row == axis)));
            let below = sample.share_below(&weights, truth);
            ranks[axis].push(below);
        }
    }
    // The bound is Kolmogorov's distance from uniform, exceeded by chance once in a thousand for each of the
    // three.
    let bound = 1.95 / (replicates as f64).sqrt();
    for (axis, mut shares) in ranks.into_iter().enumerate() {
        shares.sort_by(f64::total_cmp);
        let distance = shares
            .iter()
            .enumerate()
            .map(|(place, share)| ((place as f64 + 0.5) / replicates as f64 - share).abs())
            .fold(0.0, f64::max);
        assert!(distance < bound, "quantity {axis}: {distance} of {bound}");
    }
}

#[test]
fn the_sampler_is_calibrated() {
    calibration(150);
}

#[test]
#[ignore = "ten seconds: the long form of the test above"]
fn the_sampler_is_calibrated_over_two_thousand_replicates() {
    calibration(2000);
}

fn fit_at(method: Method, envelope: &Envelope, times: &[f64]) -> Estimate {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).predicting_at(times);
    config(method).fit(envelope, &context).unwrap()
}

#[test]
fn at_the_peaks_predictions_are_the_fitted_function() {
    let envelope = envelope();
    for method in [Method::Conjugate, Method::Nuts] {
        let estimate = fit_at(method, &envelope, envelope.times_s());
        assert_eq!(estimate.predictions.len(), envelope.len());
        for (prediction, fitted) in estimate.predictions.iter().zip(&estimate.fitted_log_amplitudes) {
            assert!((prediction.log_amplitude - fitted).abs() < 1e-12);
        }
        // Asking for predictions changes nothing else.
        assert_eq!(Estimate { predictions: Vec::new(), ..estimate }, fit(method, &envelope, 0));
    }
}

#[test]
fn the_draws_predict_as_the_closed_form_does() {
    let times = [-3.0, 0.0, 9.0, 19.0, 60.0];
    let [closed, drawn] = [Method::Conjugate, Method::Nuts].map(|method| fit_at(method, &envelope(), &times));
    for (closed, drawn) in closed.predictions.iter().zip(&drawn.predictions) {
        let (stated, sampled) = (closed.std_error.unwrap(), drawn.std_error.unwrap());
        assert!((closed.log_amplitude - drawn.log_amplitude).abs() < 1e-3 * stated, "{closed:?} {drawn:?}");
        assert!((sampled / stated - 1.0).abs() < 0.03, "{closed:?} {drawn:?}");
    }
}

#[test]
fn an_exponential_without_scatter_is_extrapolated() {
    let envelope = simulated(69, 0.2, 0.0, &mut Seed::new(0).generator());
    let times = [-5.0, 40.0, 200.0];
    let predictions = fit_at(Method::Conjugate, &envelope, &times).predictions;
    for (time, prediction) in times.iter().zip(predictions) {
        let off = (prediction.log_amplitude + 0.6 + 0.2 * time).abs();
        // The prior shifts the rate by a share of 2e-11.
        assert!(off < 1e-9 * (1.0 + time.abs()) && off < prediction.std_error.unwrap(), "{time}: {off:e}");
    }
}

#[test]
fn predictive_intervals_hold_fresh_peaks() {
    let quick = BayesianConfig { check_by_sampling: false, ..config(Method::Conjugate) };
    let mut generator = Seed::new(21).generator();
    let replicates = 4000;
    let held = (0..replicates)
        .filter(|&replicate| {
            let envelope = simulated(20, 0.2, 0.1, &mut generator);
            // Times from the first peak to one record length beyond the last.
            let times = [11.0 * f64::from(replicate) / f64::from(replicates)];
            let cancel = Cancel::new();
            let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).predicting_at(&times);
            let prediction = quick.fit(&envelope, &context).unwrap().predictions[0];
            let fresh = -0.6 - 0.2 * times[0] + 0.1 * generator.sample::<f64, _>(StandardNormal);
            // Student's t with 18 degrees of freedom has a standard deviation of √(18/16) times its scale.
            let scale = prediction.std_error.unwrap() * (16.0_f64 / 18.0).sqrt();
            (fresh - prediction.log_amplitude).abs() <= 2.1009 * scale
        })
        .count();
    let share = held as f64 / f64::from(replicates);
    // The bounds are four standard deviations of such a share.
    assert!((share - 0.95).abs() < 4.0 * (0.95 * 0.05 / f64::from(replicates)).sqrt(), "{share}");
}
