//! How long a user waits for a fit: 69 peaks of a bent, scattered envelope, default settings.
//!
//!     cargo bench -p estimator-weak-sindy

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "a benchmark")]

use divan::{Bencher, black_box};
use envelope::Envelope;
use estimator::{Cancel, Estimate, FitContext, Reached, Silent};
use estimator_weak_sindy::ENTRY;
use seed::Seed;
use settings::{Document, Resolved, Section};

fn main() {
    divan::main();
}

fn envelope() -> Envelope {
    let times: Vec<f64> = (0..69).map(|i| 0.288 * f64::from(i)).collect();
    let scatter = |i: usize| ((i * 7919 % 101) as f64 / 101.0 - 0.5) * 0.05;
    let logs = times.iter().enumerate().map(|(i, t)| -0.6 - 0.25 * t + 0.004 * t * t + scatter(i)).collect();
    Envelope::new(times, logs, 21.8).unwrap()
}

fn fit(envelope: &Envelope, seed: u64) -> Estimate {
    let section = [Section { name: "estimator", fields: ENTRY.fields }];
    let resolved = Resolved::new(&Document::default(), &section).unwrap();
    let Ok(estimator) = (ENTRY.build)(&resolved) else { panic!("the defaults do not build") };
    let cancel = Cancel::new();
    let context = FitContext::new(Seed::new(seed), None, &Silent, &cancel);
    estimator.fit(envelope, &context).unwrap()
}

#[divan::bench(args = 0..4)]
fn warm(bencher: Bencher<'_, '_>, seed: u64) {
    let envelope = envelope();
    assert_eq!(fit(&envelope, seed).stop.reached, Reached::Converged);
    bencher.bench(|| fit(black_box(&envelope), seed));
}
