//! Tests of whole fits, shared by all methods that discover laws: their test modules include this file.
//!
//! The tests take the method from `crate::ENTRY` and its tolerances from the module that includes them:
//! `AGREEMENT`, the relative difference allowed between λ and the line's on a bent envelope; `ADDED`, the
//! relative error allowed for an added decay; and `odd_bar`, the difference from the line's λ allowed on each
//! of the odd envelopes.

use super::{ADDED, AGREEMENT, odd_bar};
use crate::ENTRY;
use envelope::Envelope;
use estimator::{
    Cancel, Estimate, Estimator, FitContext, FitError, Observer, Prediction, Reached, Silent, Step,
};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::cell::RefCell;

pub(super) fn resolved(overrides: &[&str]) -> Resolved {
    let mut document = Document::default();
    for argument in overrides {
        document.apply_override(argument).unwrap();
    }
    Resolved::new(&document, &[Section { name: "estimator", fields: ENTRY.fields }]).unwrap()
}

/// Returns the method with the given overrides of its settings.
pub(super) fn estimator(overrides: &[&str]) -> Box<dyn Estimator> {
    (ENTRY.build)(&resolved(overrides)).unwrap()
}

/// Returns an envelope that is no exponential: it bends and scatters.
fn bent() -> Envelope {
    conformance::bent().unwrap()
}

/// Returns a noise-free exponential, with peaks one second apart.
fn exponential(peaks: usize, rate: f64, start: f64) -> Envelope {
    changed(&conformance::exponential(peaks, start, 0.0).unwrap(), |t, y| (t / 0.288, y - rate * t / 0.288))
}

/// Returns peaks of dA/dt = −viscous·A − dry − drag·A², A(0) = 0.5, by small Runge-Kutta steps.
pub(super) fn damped(
    peaks: usize,
    span: f64,
    [viscous, dry, drag]: [f64; 3],
    scatter: f64,
    seed: u64,
) -> Envelope {
    let rate = |amplitude: f64| -viscous * amplitude - dry - drag * amplitude * amplitude;
    let mut generator = Seed::new(seed).child("scatter").generator();
    let step = span / (peaks - 1) as f64 / 64.0;
    let mut amplitude = 0.5_f64;
    let mut logs = Vec::new();
    for _ in 0..peaks {
        let draw: f64 = StandardNormal.sample(&mut generator);
        logs.push(amplitude.ln() + scatter * draw);
        for _ in 0..64 {
            let one = rate(amplitude);
            let two = rate(amplitude + step / 2.0 * one);
            let three = rate(amplitude + step / 2.0 * two);
            let four = rate(amplitude + step * three);
            amplitude += step / 6.0 * (one + 2.0 * two + 2.0 * three + four);
        }
    }
    let times = (0..peaks).map(|i| span * i as f64 / (peaks - 1) as f64).collect();
    Envelope::new(times, logs, 21.8).unwrap()
}

/// Returns minus the slope of the least-squares line, and its standard error, by the textbook formulas.
pub(super) fn line(envelope: &Envelope) -> (f64, f64) {
    let (t, y) = (envelope.times_s(), envelope.log_amplitudes());
    let n = t.len() as f64;
    let (mt, my) = (t.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = t.iter().map(|t| (t - mt).powi(2)).sum();
    let sxy: f64 = t.iter().zip(y).map(|(t, y)| (t - mt) * (y - my)).sum();
    let slope = sxy / sxx;
    let rss: f64 = t.iter().zip(y).map(|(t, y)| (y - my - slope * (t - mt)).powi(2)).sum();
    (-slope, (rss / (n - 2.0) / sxx).sqrt())
}

/// Fits with the default settings and asks for predictions at some times.
fn fit_at(envelope: &Envelope, times: &[f64]) -> Estimate {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).predicting_at(times);
    estimator(&[]).fit(envelope, &context).unwrap()
}

fn fit_with(envelope: &Envelope, seed: u64, max_steps: Option<u64>, observer: &dyn Observer) -> Estimate {
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed).child(ENTRY.id), max_steps, observer, &cancel);
    estimator(&[]).fit(envelope, &context).unwrap()
}

pub(super) fn fit(envelope: &Envelope) -> Estimate {
    fit_with(envelope, 0, None, &Silent)
}

fn changed(envelope: &Envelope, change: impl Fn(f64, f64) -> (f64, f64)) -> Envelope {
    let pairs = envelope.times_s().iter().zip(envelope.log_amplitudes());
    let (times, logs) = pairs.map(|(&time, &log)| change(time, log)).unzip();
    Envelope::new(times, logs, envelope.omega_rad_s()).unwrap()
}

/// Returns the equation of a fit and its coefficients, in the order written.
fn law(estimate: &Estimate) -> (String, Vec<f64>) {
    let text = String::from_utf8(estimate.model.clone().unwrap().bytes).unwrap();
    let equation = text.lines().next().unwrap().to_owned();
    assert_eq!(estimate.equation.as_ref(), Some(&equation));
    let right = equation.split_once('=').unwrap().1.replace("- ", "-").replace("+ ", "");
    let numbers =
        right.split_whitespace().filter_map(|word| word.split('/').next().unwrap().parse().ok()).collect();
    (equation, numbers)
}

#[test]
fn it_agrees_with_the_line_on_a_bent_envelope() {
    let estimate = fit(&bent());
    let (rate, _) = line(&bent());
    assert_eq!(estimate.stop.reached, Reached::Converged, "{:?}", estimate.stop);
    assert!(estimate.stop.because.contains("below that of an exponential"), "{}", estimate.stop.because);
    let off = (estimate.decay_rate / rate - 1.0).abs();
    assert!(off < AGREEMENT, "{off:e}");
}

#[test]
fn a_pure_exponential_needs_no_other_term() {
    for (peaks, rate) in [(3, 0.2), (12, 1.5), (69, 0.191), (200, -0.01)] {
        let estimate = fit(&exponential(peaks, rate, -0.6));
        let (equation, numbers) = law(&estimate);
        assert_eq!(numbers.len(), 1, "{equation}");
        assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-9, "{equation}");
    }
}

#[test]
fn the_law_is_recovered_without_scatter() {
    for [viscous, dry, drag] in [[0.13, 0.0035, 0.0], [0.1, 0.0, 0.3], [0.05, 0.0035, 0.3], [0.0, 0.01, 0.0]]
    {
        let estimate = fit(&damped(69, 20.0, [viscous, dry, drag], 0.0, 0));
        let (equation, numbers) = law(&estimate);
        let expected: Vec<f64> = [viscous, dry, drag]
            .into_iter()
            .enumerate()
            .filter(|(at, c)| *at == 0 || *c > 0.0)
            .map(|(_, c)| -c)
            .collect();
        assert_eq!(numbers.len(), expected.len(), "{equation}");
        for (found, expected) in numbers.iter().zip(&expected) {
            assert!((found - expected).abs() < 2e-5, "{equation} for {expected}");
        }
    }
}

#[test]
fn the_law_is_found_in_scatter() {
    let mut found = [0; 3];
    for seed in 0..40 {
        let laws = [[0.2, 0.0, 0.0], [0.13, 0.0035, 0.0], [0.1, 0.0, 0.3]];
        for ((damping, ending), found) in laws.into_iter().zip(["", "/A", " A"]).zip(&mut found) {
            let (equation, numbers) = law(&fit(&damped(69, 20.0, damping, 0.05, seed)));
            let right = numbers.len() == if ending.is_empty() { 1 } else { 2 } && equation.ends_with(ending);
            *found += i32::from(right);
        }
    }
    assert!(found.iter().all(|found| *found >= 36), "{found:?}");
}

#[test]
fn intervals_cover() {
    let rate = 0.2;
    for peaks in [20, 60] {
        let draws = 1500;
        let covered = (0..draws)
            .filter(|&seed| {
                let known = fit(&damped(peaks, 20.0, [rate, 0.0, 0.0], 0.1, seed)).uncertainty.unwrap();
                (known.interval_95[0]..=known.interval_95[1]).contains(&rate)
            })
            .count();
        let share = covered as f64 / draws as f64;
        // The bounds allow for the scatter of a share of 1500 draws.
        assert!((0.935..=0.965).contains(&share), "{peaks} peaks: {share}");
    }
}

#[test]
fn on_an_exponential_the_interval_is_that_of_the_line() {
    let envelope = damped(69, 20.0, [0.2, 0.0, 0.0], 0.1, 3);
    let (rate, std_error) = line(&envelope);
    let estimate = fit(&envelope);
    assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-12);
    assert!((estimate.uncertainty.unwrap().std_error / std_error - 1.0).abs() < 1e-9);
}

#[test]
fn without_a_step_it_is_wrong() {
    let estimate = fit_with(&bent(), 0, Some(0), &Silent);
    assert_eq!((estimate.stop.reached, estimate.steps), (Reached::BudgetSpent, 0));
    assert!(estimate.decay_rate.abs() < 1e-15 && estimate.uncertainty.is_none());
}

#[test]
fn a_short_budget_gives_the_best_so_far() {
    let whole = fit(&bent());
    for budget in 1..whole.steps {
        let estimate = fit_with(&bent(), 0, Some(budget), &Silent);
        assert_eq!((estimate.stop.reached, estimate.steps), (Reached::BudgetSpent, budget));
        assert!((estimate.decay_rate / whole.decay_rate - 1.0).abs() < 0.1, "{}", estimate.decay_rate);
    }
}

#[test]
fn every_seed_gives_the_same_bits() {
    assert_eq!(fit_with(&bent(), 1, None, &Silent), fit_with(&bent(), 2, None, &Silent));
}

#[test]
fn it_is_equivariant() {
    for envelope in [bent(), damped(40, 20.0, [0.13, 0.0035, 0.0], 0.03, 5)] {
        let rate = fit(&envelope).decay_rate;
        let close = |found: f64, expected: f64, bar: f64| {
            assert!((found / expected - 1.0).abs() < bar, "{found} for {expected}");
        };
        close(fit(&changed(&envelope, |t, y| (t, y + 2.5))).decay_rate, rate, 1e-10);
        close(fit(&changed(&envelope, |t, y| (3.0 * t, y))).decay_rate, rate / 3.0, 1e-10);
        close(fit(&changed(&envelope, |t, y| (t, y - 0.1 * t))).decay_rate, rate + 0.1, ADDED);
    }
}

#[test]
fn every_step_is_told_once() {
    struct Steps(RefCell<Vec<u64>>);
    impl Observer for Steps {
        fn observe(&self, step: &Step) {
            self.0.borrow_mut().push(step.step);
        }
    }
    let steps = Steps(RefCell::default());
    let estimate = fit_with(&bent(), 0, None, &steps);
    assert_eq!(*steps.0.borrow(), (0..=estimate.steps).collect::<Vec<_>>());
}

#[test]
fn a_request_to_stop_is_heard() {
    let cancel = Cancel::new();
    cancel.request();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
    let estimate = estimator(&[]).fit(&bent(), &context).unwrap();
    assert_eq!((estimate.stop.reached, estimate.steps), (Reached::Interrupted, 0));
}

#[test]
fn a_constant_envelope_is_refused() {
    let flat = Envelope::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.3; 4], 6.0).unwrap();
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
    assert!(matches!(estimator(&[]).fit(&flat, &context), Err(FitError::NoSpread { .. })));
}

#[test]
fn odd_envelopes_give_numbers() {
    let noise = changed(&damped(40, 20.0, [0.2, 0.0, 0.0], 1.0, 9), |t, y| (t, y + 0.2 * t));
    let crowded =
        Envelope::new(vec![0.0, 1e-9, 2e-9, 3e-9, 1.0], vec![0.0, 0.1, -0.1, 0.0, -1.0], 1.0).unwrap();
    // Dry friction that almost stops the motion within the record.
    let stopping = damped(60, 20.0, [0.0, 0.0249, 0.0], 0.3, 1);
    let envelopes = [
        exponential(3, 0.2, 0.0),
        exponential(4, 0.2, 0.0),
        exponential(30, 50.0, 0.0),
        exponential(50, 1e-9, 0.0),
        exponential(50, 0.2, 600.0),
        exponential(50, 0.2, -600.0),
        exponential(50, -40.0, 0.0),
        exponential(100_000, 1e-4, 0.0),
        noise,
        crowded,
        stopping,
    ];
    for (at, envelope) in envelopes.iter().enumerate() {
        let end = envelope.times_s().last().unwrap();
        let estimate = fit_at(envelope, &[-end, 0.3 * end, 3.0 * end]);
        assert_eq!(estimate.predictions.len(), 3);
        assert!(estimate.predictions[1].log_amplitude.is_finite(), "{at}: {:?}", estimate.predictions);
        assert!(estimate.predictions.iter().all(|found| !found.log_amplitude.is_nan()), "{at}");
        let finite = estimate.fitted_log_amplitudes.iter().all(|log| log.is_finite());
        assert!(finite && estimate.decay_rate.is_finite() && estimate.log_amplitude.is_finite(), "{at}");
        assert!(estimate.uncertainty.unwrap().std_error.is_finite(), "{at}");
        assert_eq!(estimate.stop.reached, Reached::Converged, "{at}: {:?}", estimate.stop);
        let off = (estimate.decay_rate - line(envelope).0).abs();
        assert!(off < odd_bar(at, estimate.decay_rate), "{at}: off by {off:e}");
    }
}

#[test]
fn every_term_can_be_asked_for() {
    let library = r#"estimator.library=["1","1/A","A","A^2","ln A","(ln A)^2","t"]"#;
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
    let estimate = estimator(&[library]).fit(&bent(), &context).unwrap();
    let (rate, _) = line(&bent());
    assert!((estimate.decay_rate / rate - 1.0).abs() < 1e-9, "{}", estimate.decay_rate);
}

#[test]
fn an_unknown_term_names_those_known() {
    let settings = resolved(&["estimator.library=[\"1\",\"A^3\"]"]);
    let error = (ENTRY.build)(&settings).err().unwrap();
    assert_eq!(
        error.to_string(),
        "command line: `estimator.library=[\"1\",\"A^3\"]`: unknown library term \"A^3\"; did you mean `A^2`?"
    );
}

#[test]
fn at_the_peaks_predictions_are_the_fitted_function() {
    for envelope in [bent(), damped(69, 20.0, [0.13, 0.0035, 0.0], 0.05, 2), exponential(12, 0.2, 0.1)] {
        let estimate = fit_at(&envelope, envelope.times_s());
        assert_eq!(estimate.predictions.len(), envelope.len());
        for (prediction, fitted) in estimate.predictions.iter().zip(&estimate.fitted_log_amplitudes) {
            assert!((prediction.log_amplitude - fitted).abs() < 1e-12, "{prediction:?} {fitted}");
            assert!(prediction.std_error.is_some(), "{prediction:?}");
        }
        // Asking for predictions changes nothing else.
        assert_eq!(Estimate { predictions: Vec::new(), ..estimate }, fit_with(&envelope, 0, None, &Silent));
    }
}

#[test]
fn an_exponential_is_extrapolated() {
    let times = [-4.0, 0.0, 7.3, 68.0, 100.0, 5000.0];
    let estimate = fit_at(&exponential(69, 0.191, -0.6), &times);
    for (time, prediction) in times.iter().zip(&estimate.predictions) {
        let expected = -0.6 - 0.191 * time;
        assert!((prediction.log_amplitude - expected).abs() < 1e-9 * (1.0 + time.abs()), "{prediction:?}");
        assert!(prediction.std_error.unwrap() < 1e-9 * (1.0 + time.abs()));
    }
}

/// dA/dt = −v·A − d has A = (A(0) + d/v)·exp(−v·t) − d/v, at rest from t = ln(1 + A(0)·v/d)/v on.
#[test]
fn dry_friction_is_followed_to_its_rest() {
    let (viscous, dry) = (0.13, 0.0035);
    let amplitude = |time: f64| (0.5 + dry / viscous) * (-viscous * time).exp() - dry / viscous;
    let end = (1.0_f64 + 0.5 * viscous / dry).ln() / viscous;
    assert!((20.0..30.0).contains(&end), "{end}");
    let times = [25.0, 3.1, 0.0, 12.34, 22.0, 40.0, 1e4];
    let estimate = fit_at(&damped(69, 20.0, [viscous, dry, 0.0], 0.0, 0), &times);
    for (time, prediction) in times.iter().zip(&estimate.predictions) {
        if *time < end {
            // The remaining error comes from the quadrature between the peaks and the rounding of the law.
            let off = prediction.log_amplitude.exp() - amplitude(*time);
            assert!(off.abs() < 1e-6, "{time}: {off:e} {prediction:?}");
        } else {
            assert_eq!(*prediction, Prediction::new(f64::NEG_INFINITY, None));
        }
    }
    assert_eq!(estimate.first_without_prediction(&times), Some(25.0));
}

#[test]
fn predictive_intervals_hold_fresh_peaks() {
    let mut generator = Seed::new(12).generator();
    // The exponential is tested up to half a record beyond its end; the bent law only within the record,
    // where the choice of its terms matters little.
    for (damping, reach) in [([0.2, 0.0, 0.0], 1.5), ([0.13, 0.0035, 0.0], 1.0)] {
        let trials: u32 = 300;
        let held = (0..trials)
            .filter(|&trial| {
                let seed = u64::from(trial);
                let time = 20.0 * reach * generator.random::<f64>();
                // The truth at that time is the last of nine peaks that end there.
                let truth = damped(9, time, damping, 0.0, 0).log_amplitudes()[8];
                let draw: f64 = StandardNormal.sample(&mut generator);
                let prediction = fit_at(&damped(69, 20.0, damping, 0.05, seed), &[time]).predictions[0];
                // Quantile of Student's t with about 66 degrees of freedom.
                (truth + 0.05 * draw - prediction.log_amplitude).abs()
                    <= 1.9966 * prediction.std_error.unwrap()
            })
            .count();
        let share = held as f64 / f64::from(trials);
        // The bounds are four standard deviations of such a share.
        assert!(
            (share - 0.95).abs() < 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt(),
            "{damping:?}: {share}"
        );
    }
}

/// The stated variance of the function is σ²·Σ(∂f/∂yᵢ)². The derivatives by every measured ln A are taken
/// from fits with that one value moved, for a law with known terms.
#[test]
fn the_error_of_a_prediction_is_what_the_scatter_of_the_peaks_makes_of_it() {
    let times = [-2.0, 0.0, 11.0, 19.9, 22.0];
    let envelope = damped(69, 20.0, [0.05, 0.005, 0.0], 0.03, 4);
    let fit = |envelope: &Envelope| {
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).predicting_at(&times);
        estimator(&[r#"estimator.library=["1","1/A"]"#]).fit(envelope, &context).unwrap()
    };
    let moved = |peak: usize, by: f64| {
        let mut logs = envelope.log_amplitudes().to_vec();
        logs[peak] += by;
        fit(&Envelope::new(envelope.times_s().to_vec(), logs, 21.8).unwrap()).predictions
    };
    let estimate = fit(&envelope);
    assert_eq!(estimate.parameters, 3, "{:?}", estimate.equation);
    let fitted = estimate.fitted_log_amplitudes.iter().zip(envelope.log_amplitudes());
    let variance = fitted.map(|(fitted, log)| (fitted - log).powi(2)).sum::<f64>() / 66.0;
    let step = 1e-4;
    let mut sums = [0.0; 5];
    for peak in 0..69 {
        for (sum, (up, down)) in sums.iter_mut().zip(moved(peak, step).iter().zip(moved(peak, -step))) {
            *sum += ((up.log_amplitude - down.log_amplitude) / (2.0 * step)).powi(2);
        }
    }
    for (prediction, sum) in estimate.predictions.iter().zip(sums) {
        let stated = prediction.std_error.unwrap().powi(2) / variance - 1.0;
        // The stated error neglects that the terms along the trajectory move with it, which matters where
        // residuals are not 0.
        assert!((stated / sum - 1.0).abs() < 0.02, "{stated} {sum}");
    }
}
