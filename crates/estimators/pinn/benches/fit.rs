//! How long a user waits for a fit: 69 peaks of a bent, scattered envelope, default settings.
//!
//!     cargo bench -p estimator-pinn

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "a benchmark")]

use divan::{Bencher, black_box};
use envelope::Envelope;
use estimator::{Cancel, Estimate, FitContext, Reached, Silent};
use estimator_pinn::ENTRY;
use seed::Seed;
use settings::{Document, Resolved, Section};

fn main() {
    divan::main();
}

/// The same for every method.
fn envelope() -> Envelope {
    conformance::bent().unwrap()
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
