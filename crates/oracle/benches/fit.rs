//! Benchmark of the eleven classical methods: 69 peaks of a bent, scattered envelope, the same as in the
//! benchmark of the learned methods.
//!
//!     cargo bench -p oracle

#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark")]

use divan::{Bencher, black_box};
use envelope::Envelope;
use oracle::classical::{CLASSICAL, ClassicalFit, ClassicalRoute};
use oracle::decay_rate;
use seed::Seed;

fn main() {
    divan::main();
}

/// Envelope of `conformance::bent`; the oracle must not depend on that crate.
fn envelope() -> Envelope {
    let times: Vec<f64> = (0..69).map(|i| 0.288 * f64::from(i)).collect();
    let scatter = |time: f64| 0.03 * (37.0 * time).sin() + 0.02 * (91.0 * time + 1.0).cos();
    let logs = times.iter().map(|time| -0.6 - 0.15 * time - 0.003 * time * time + scatter(*time)).collect();
    Envelope::new(times, logs, 21.8).unwrap()
}

fn fit(route: &ClassicalRoute, envelope: &Envelope) -> ClassicalFit {
    (route.fit)(envelope, &Seed::new(0)).unwrap()
}

#[divan::bench(args = CLASSICAL.iter().map(|route| route.id))]
fn warm(bencher: Bencher<'_, '_>, id: &str) {
    let envelope = envelope();
    let route = CLASSICAL.iter().find(|route| route.id == id).unwrap();
    let certified = decay_rate(&envelope).unwrap().decay_rate;
    // Gradient descent is the least accurate of them, at 1e-9.
    assert!((fit(route, &envelope).decay_rate / certified - 1.0).abs() < 1e-7, "{id}");
    bencher.bench(|| fit(route, black_box(&envelope)));
}
