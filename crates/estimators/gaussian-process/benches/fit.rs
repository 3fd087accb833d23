//! How long a user waits for a fit: 69 peaks of a bent, scattered envelope, each covariance function.
//!
//!     cargo bench -p estimator-gaussian-process

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "a benchmark")]

use divan::{Bencher, black_box};
use envelope::Envelope;
use estimator::{Cancel, Estimate, Estimator, FitContext, Reached, Silent};
use estimator_gaussian_process::ENTRY;
use seed::Seed;
use settings::{Document, Resolved, Section};

fn main() {
    divan::main();
}

/// The same for every method.
fn envelope() -> Envelope {
    conformance::bent().unwrap()
}

fn estimator(kernel: &str) -> Box<dyn Estimator> {
    let section = [Section { name: "estimator", fields: ENTRY.fields }];
    let document = Document::parse("benchmark", &format!("estimator.kernel = \"{kernel}\"")).unwrap();
    let Ok(estimator) = (ENTRY.build)(&Resolved::new(&document, &section).unwrap()) else {
        panic!("the settings do not build")
    };
    estimator
}

fn fit(estimator: &dyn Estimator, envelope: &Envelope) -> Estimate {
    let cancel = Cancel::new();
    estimator.fit(envelope, &FitContext::new(Seed::new(0), None, &Silent, &cancel)).unwrap()
}

#[divan::bench(args = ["rbf", "matern-3/2", "matern-5/2"])]
fn warm(bencher: Bencher<'_, '_>, kernel: &str) {
    let (envelope, estimator) = (envelope(), estimator(kernel));
    assert_eq!(fit(estimator.as_ref(), &envelope).stop.reached, Reached::Converged);
    bencher.bench(|| fit(estimator.as_ref(), black_box(&envelope)));
}
