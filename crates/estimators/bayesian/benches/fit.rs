//! How long a user waits for a fit: 69 peaks of a bent, scattered envelope; the closed form alone, the
//! closed form checked by sampling (the default), and the sampler alone.
//!
//!     cargo bench -p estimator-bayesian

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "a benchmark")]

use divan::{Bencher, black_box};
use envelope::Envelope;
use estimator::{Cancel, Estimate, Estimator, FitContext, Reached, Silent};
use estimator_bayesian::ENTRY;
use seed::Seed;
use settings::{Document, Resolved, Section};

fn main() {
    divan::main();
}

/// The same for every method.
fn envelope() -> Envelope {
    conformance::bent().unwrap()
}

fn estimator(settings: &str) -> Box<dyn Estimator> {
    let section = [Section { name: "estimator", fields: ENTRY.fields }];
    let document = Document::parse("benchmark", settings).unwrap();
    let Ok(estimator) = (ENTRY.build)(&Resolved::new(&document, &section).unwrap()) else {
        panic!("the settings do not build")
    };
    estimator
}

fn fit(estimator: &dyn Estimator, envelope: &Envelope) -> Estimate {
    let cancel = Cancel::new();
    estimator.fit(envelope, &FitContext::new(Seed::new(0), None, &Silent, &cancel)).unwrap()
}

fn bench(bencher: Bencher<'_, '_>, settings: &str) {
    let (envelope, estimator) = (envelope(), estimator(settings));
    assert_eq!(fit(estimator.as_ref(), &envelope).stop.reached, Reached::Converged);
    bencher.bench(|| fit(estimator.as_ref(), black_box(&envelope)));
}

#[divan::bench]
fn closed_form(bencher: Bencher<'_, '_>) {
    bench(bencher, "estimator.check_by_sampling = false");
}

#[divan::bench]
fn closed_form_checked(bencher: Bencher<'_, '_>) {
    bench(bencher, "");
}

#[divan::bench]
fn sampled(bencher: Bencher<'_, '_>) {
    bench(bencher, "estimator.method = \"nuts\"");
}
