//! Coverage test on simulated exponential decays: two standard errors of the damping ratio hold the truth.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use envelope::RecommendedPipeline;
use oracle::decay_rate;
use rand::{Rng, RngExt};
use record::{Clock, ClockChoice, Quantity, Record};
use seed::Seed;
use std::f64::consts::TAU;

/// Default of the configuration.
const RECOMMENDED: RecommendedPipeline = RecommendedPipeline::DEFAULT;

/// Free decay of a linear oscillator, with its observation.
#[derive(Debug)]
struct Case {
    zeta: f64,
    /// Undamped natural frequency, in rad/s.
    omega: f64,
    rate_hz: f64,
    seconds: f64,
    /// Standard deviation, as a share of the first amplitude.
    noise: f64,
    /// Step of the sensor, as a share of the first amplitude; 0 for none.
    quantum: f64,
    phase: f64,
    offset: f64,
}

fn between(generator: &mut impl Rng, low: f64, high: f64) -> f64 {
    (low.ln() + (high / low).ln() * generator.random::<f64>()).exp()
}

fn normal(generator: &mut impl Rng) -> f64 {
    let (one, other): (f64, f64) = (generator.random(), generator.random());
    (-2.0 * (1.0 - one).ln()).sqrt() * (TAU * other).cos()
}

fn draw(generator: &mut impl Rng) -> Case {
    let omega = between(generator, 2.0, 200.0);
    let zeta = between(generator, 0.002, 0.1);
    let noise = between(generator, 3e-4, 2e-2);
    // One to five e-foldings.
    let seconds = (1.0 + 4.0 * generator.random::<f64>()) / (zeta * omega);
    Case {
        zeta,
        omega,
        noise,
        // About 12 to 200 samples per period.
        rate_hz: omega / TAU * between(generator, 12.0, 200.0),
        // Never shorter than five periods.
        seconds: seconds.max(5.0 * TAU / omega),
        quantum: if generator.random::<f64>() < 0.3 { noise * between(generator, 0.1, 5.0) } else { 0.0 },
        phase: TAU * generator.random::<f64>(),
        offset: generator.random::<f64>() - 0.5,
    }
}

fn record(case: &Case, generator: &mut impl Rng) -> Record {
    let decay = case.zeta * case.omega;
    let damped = case.omega * (1.0 - case.zeta * case.zeta).sqrt();
    let times: Vec<f64> =
        (0..(case.seconds * case.rate_hz) as usize).map(|i| i as f64 / case.rate_hz).collect();
    let value = |&time: &f64| {
        let swing = (-decay * time).exp() * (damped * time + case.phase).cos();
        let seen = case.offset + swing + case.noise * normal(generator);
        if case.quantum > 0.0 { (seen / case.quantum).round() * case.quantum } else { seen }
    };
    let values = times.iter().map(value).collect();
    Record::new(times, values, None, Quantity::Position, "rad").unwrap()
}

/// Returns the deviation of ζ from the truth in standard errors; `None` if the record has no envelope.
fn deviation(case: &Case, generator: &mut impl Rng) -> Option<f64> {
    let record = record(case, generator);
    let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
    let envelope = RECOMMENDED.extract(&record, &clock).ok()?.envelope;
    let fit = decay_rate(&envelope).unwrap();
    Some((fit.zeta - case.zeta) / fit.zeta_std_error)
}

/// Returns the deviations of a number of cases.
fn deviations(cases: usize) -> Vec<f64> {
    let root = Seed::new(0).child("exponentials");
    let one = |number: usize| {
        let mut generator = root.child(&number.to_string()).generator();
        deviation(&draw(&mut generator), &mut generator)
    };
    let found: Vec<f64> = (0..cases).filter_map(one).collect();
    assert_eq!(found.len(), cases, "every record has an envelope");
    found
}

fn held(deviations: &[f64]) -> usize {
    deviations.iter().filter(|deviation| deviation.abs() <= 2.0).count()
}

#[test]
fn two_standard_errors_hold_the_truth_of_simulated_exponentials() {
    let found = deviations(200);
    assert!(held(&found) >= 186, "{} of 200", held(&found));
}

/// Two standard errors of a normal number hold the truth in 95.4 % of the cases.
#[test]
#[ignore = "2000 records take half a minute"]
fn standard_errors_are_neither_too_small_nor_too_large() {
    let found = deviations(2000);
    let spread = (found.iter().map(|deviation| deviation * deviation).sum::<f64>() / 2000.0).sqrt();
    let mean = found.iter().sum::<f64>() / 2000.0;
    assert!((1860..=1960).contains(&held(&found)), "{} of 2000", held(&found));
    assert!((0.85..1.15).contains(&spread) && mean.abs() < 0.3, "mean {mean:.3}, spread {spread:.3}");
}
