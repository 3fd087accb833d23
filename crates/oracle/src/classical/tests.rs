//! Tests of the eleven routes on envelopes.

use super::{CLASSICAL, ClassicalFit, ClassicalRoute, Reached};
use crate::decay_rate;
use envelope::Envelope;
use rand::RngExt;
use seed::Seed;

fn route(id: &str) -> &'static ClassicalRoute {
    CLASSICAL.iter().find(|route| route.id == id).unwrap()
}

fn fit(route: &ClassicalRoute, envelope: &Envelope) -> ClassicalFit {
    (route.fit)(envelope, &Seed::new(0)).unwrap_or_else(|error| panic!("{}: {error}", route.id))
}

fn envelope(times: &[f64], log_amplitude: impl Fn(f64) -> f64) -> Envelope {
    let logs = times.iter().map(|&t| log_amplitude(t)).collect();
    Envelope::new(times.to_vec(), logs, 21.8).unwrap()
}

fn even(count: u32, step: f64) -> Vec<f64> {
    (0..count).map(|i| f64::from(i) * step).collect()
}

/// Returns an envelope with the paper's number of peaks, and with its scatter and bend.
fn like_the_paper() -> Envelope {
    envelope(&even(69, 0.288), |t| -0.5 - 0.19 * t + 0.15 * (5.0 * t).sin() - 0.002 * (t - 10.0).powi(2))
}

/// Returns envelopes with a decay that the routes should agree on.
fn envelopes() -> Vec<(&'static str, Envelope)> {
    let mut generator = Seed::new(4).generator();
    let uneven: Vec<f64> = (0..200)
        .scan(0.0, |t, _| {
            *t += generator.random_range(0.01..2.0);
            Some(*t)
        })
        .collect();
    vec![
        ("like the paper", like_the_paper()),
        ("no scatter", envelope(&even(40, 0.5), |t| 1.0 - 0.25 * t)),
        ("three peaks", envelope(&[0.0, 1.0, 2.5], |t| 0.1 - t + 0.2 * t * t)),
        ("growing", envelope(&even(30, 0.3), |t| -2.0 + 0.4 * t + 0.1 * (9.0 * t).cos())),
        ("uneven", envelope(&uneven, |t| 3.0 - 0.01 * t + 0.05 * (31.0 * t).sin())),
        ("a far last peak", envelope(&[0.0, 0.1, 0.2, 0.35, 50.0], |t| -0.1 * t + 0.01 * (7.0 * t).sin())),
        ("microseconds", envelope(&even(50, 3e-6), |t| -1.0 - 2e3 * t + 0.01 * (2e6 * t).sin())),
        ("days", envelope(&even(50, 5e4), |t| -1.0 - 3e-6 * t + 0.1 * (t / 7e4).sin())),
        ("a large constant", envelope(&even(50, 0.3), |t| 1e3 - 0.2 * t + 0.1 * (7.0 * t).sin())),
        ("many peaks", envelope(&even(20_000, 0.01), |t| 0.3 - 0.02 * t + 0.4 * (t * t).sin())),
    ]
}

/// Returns the relative error of the decay rate allowed for a route.
fn tolerance(route: &ClassicalRoute) -> f64 {
    match route.paper_number {
        1..=5 | 11 => 1e-12,
        7 | 9 | 10 => 1e-10,
        8 => 1e-8,
        _ => f64::INFINITY,
    }
}

#[test]
fn the_table_is_the_paper_s() {
    assert_eq!(CLASSICAL.len(), 11);
    for (number, route) in (1..).zip(CLASSICAL) {
        assert_eq!(route.paper_number, number, "{}", route.id);
        assert!(!route.title.is_empty() && !route.summary.is_empty() && !route.citations.is_empty());
        assert_eq!(CLASSICAL.iter().filter(|other| other.id == route.id).count(), 1);
    }
}

#[test]
fn all_but_gradient_descent_agree_with_the_certified_route() {
    for (name, envelope) in envelopes() {
        let certified = decay_rate(&envelope).unwrap();
        for route in CLASSICAL.iter().filter(|route| route.id != "gradient-descent") {
            let fit = fit(route, &envelope);
            let error = (fit.decay_rate / certified.decay_rate - 1.0).abs();
            // A constant of 10³ costs three of the digits of the scatter.
            let room = if name == "a large constant" { 100.0 } else { 1.0 };
            assert!(error <= room * tolerance(route), "{} on {name}: {error:e} {fit:?}", route.id);
            let shift = (fit.log_amplitude - certified.log_amplitude).abs();
            let scale = certified.log_amplitude.abs().max(certified.std_error.max(1e-9));
            assert!(shift <= 1e-8 * scale, "{} on {name}: {shift:e} {fit:?}", route.id);
            assert_eq!(fit.reached, Reached::Converged, "{} on {name}: {fit:?}", route.id);
            assert!(fit.steps > 0 && !fit.because.is_empty());
        }
    }
}

#[test]
fn promised_digits_are_kept() {
    for (name, envelope) in envelopes() {
        let certified = decay_rate(&envelope).unwrap();
        for route in CLASSICAL {
            let fit = fit(route, &envelope);
            assert_eq!(
                fit.promised_digits.is_some(),
                matches!(route.paper_number, 1..=5 | 11),
                "{}",
                route.id
            );
            let Some(promised) = fit.promised_digits else { continue };
            for (found, expected) in
                [(fit.decay_rate, certified.decay_rate), (fit.log_amplitude, certified.log_amplitude)]
            {
                let error = (found / expected - 1.0).abs();
                assert!(
                    error == 0.0 || -error.log10() >= promised,
                    "{} on {name}: {error:e} {promised}",
                    route.id
                );
            }
        }
    }
}

#[test]
fn standard_errors_are_the_certified_ones() {
    let envelope = like_the_paper();
    let certified = decay_rate(&envelope).unwrap().std_error;
    for route in CLASSICAL {
        let error = fit(route, &envelope).std_error;
        assert_eq!(error.is_none(), matches!(route.paper_number, 6..=8), "{}", route.id);
        assert!((error.unwrap_or(certified) / certified - 1.0).abs() < 1e-9, "{}: {error:?}", route.id);
    }
}

/// The paper's gradient descent has an error of 0.046 %; here it is smaller, and every other route has to be
/// ten times better.
#[test]
fn gradient_descent_beats_the_paper_s_and_is_the_worst() {
    let envelope = like_the_paper();
    let certified = decay_rate(&envelope).unwrap().decay_rate;
    let error = |id: &str| (fit(route(id), &envelope).decay_rate / certified - 1.0).abs();
    let descent = error("gradient-descent");
    assert!(descent < 1e-7 && descent > 1e-11, "{descent:e}");
    assert!(CLASSICAL.iter().all(|route| route.id == "gradient-descent" || error(route.id) < descent / 10.0));
    assert_eq!(fit(route("gradient-descent"), &envelope).reached, Reached::BudgetSpent);
}

#[test]
fn ten_seeds_of_differential_evolution() {
    let envelope = like_the_paper();
    let certified = decay_rate(&envelope).unwrap().decay_rate;
    let evolved = |seed: u64| (route("differential-evolution").fit)(&envelope, &Seed::new(seed)).unwrap();
    for seed in 0..10 {
        let fit = evolved(seed);
        assert!((fit.decay_rate / certified - 1.0).abs() < 1e-11, "{seed}: {fit:?}");
        assert_eq!(fit.reached, Reached::Converged, "{seed}: {fit:?}");
        assert_eq!(fit, evolved(seed));
    }
    assert_ne!(evolved(0), evolved(1));
}

#[test]
fn shifting_scaling_and_tilting_do_what_they_should() {
    let original = like_the_paper();
    let changed = |time: f64, tilt: f64, shift: f64| {
        let times: Vec<f64> = original.times_s().iter().map(|t| t * time).collect();
        let logs = original.times_s().iter().zip(original.log_amplitudes());
        let logs = logs.map(|(t, y)| y - tilt * t + shift).collect();
        Envelope::new(times, logs, 21.8).unwrap()
    };
    for route in CLASSICAL {
        // Plain gradient descent depends on the unit of time; in the same unit it is linear.
        let (time, close) = if route.paper_number == 6 { (1.0, 1e-7) } else { (60.0, 1e-10) };
        let rate = fit(route, &original).decay_rate;
        let expect = |fit: ClassicalFit, expected: f64| {
            assert!((fit.decay_rate / expected - 1.0).abs() < close, "{}: {fit:?} {expected}", route.id);
        };
        expect(fit(route, &changed(1.0, 0.0, 5.0)), rate);
        expect(fit(route, &changed(1.0, 0.7, 0.0)), rate + 0.7);
        expect(fit(route, &changed(time, 0.0, 0.0)), rate / time);
    }
}

#[test]
fn no_envelope_makes_a_panic_or_a_number_that_is_none() {
    let hard = [
        envelope(&even(10, 0.3), |_| 0.0),
        envelope(&even(10, 0.3), |_| 0.7),
        envelope(&even(10, 0.3), |_| -1e9),
        envelope(&even(3, 1e-300), |t| t),
        envelope(&even(3, 1e100), |t| -t),
        envelope(&even(3, 1e160), |t| -t),
        envelope(&[0.0, 1e-12, 1.0], |t| (1e12 * t).sin()),
        envelope(&[0.0, 1.0, 1e12], |t| (t + 1.0).ln()),
        envelope(&even(5, 1.0), |t| 1e300 * t.cos()),
        envelope(&even(60, 0.3), |t| if t < 3.0 { 700.0 } else { -700.0 }),
    ];
    for (number, envelope) in hard.iter().enumerate() {
        for route in CLASSICAL {
            if let Ok(fit) = (route.fit)(envelope, &Seed::new(0)) {
                let finite = fit.decay_rate.is_finite()
                    && fit.log_amplitude.is_finite()
                    && fit.std_error.is_none_or(f64::is_finite);
                assert!(finite, "{} on {number}: {fit:?}", route.id);
            }
        }
    }
    // A constant envelope has no decay.
    for route in CLASSICAL {
        let rate = fit(route, &hard[0]).decay_rate;
        assert!(rate.abs() < 1e-12, "{}: {rate}", route.id);
    }
}
