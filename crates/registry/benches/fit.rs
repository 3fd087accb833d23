//! Benchmark of the time of a fit: 69 peaks of a bent, scattered envelope, for every estimator of the
//! registry.
//!
//!     cargo bench -p registry
//!     cargo bench -p registry -- pinn

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "a benchmark")]

use divan::{Bencher, black_box};
use envelope::Envelope;
use estimator::{Cancel, Entry, Estimate, Estimator, FitContext, Reached, Silent, Tag};
use registry::ESTIMATORS;
use seed::Seed;
use settings::{Document, Resolved, Section};
use std::fmt;

fn main() {
    divan::main();
}

/// Number of seeds for an estimator that draws random numbers.
const SEEDS: u64 = 4;

/// Settings besides the defaults that use another algorithm.
const OTHERS: &[(&str, &str)] = &[
    ("bayesian", "estimator.check_by_sampling = false"),
    ("bayesian", "estimator.method = \"nuts\""),
    ("gaussian-process", "estimator.kernel = \"rbf\""),
    ("gaussian-process", "estimator.kernel = \"matern-3/2\""),
    ("gaussian-process", "estimator.kernel = \"matern-5/2\""),
];

struct Case {
    entry: &'static Entry,
    settings: &'static str,
    seed: u64,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} seed {}", self.entry.id, self.settings, self.seed)
    }
}

fn cases() -> Vec<Case> {
    let all = ESTIMATORS.iter().flat_map(|entry| {
        let others = OTHERS.iter().filter(|(id, _)| *id == entry.id).map(|(_, settings)| (*settings, 1));
        let seeds = if entry.has(Tag::Seeded) { SEEDS } else { 1 };
        let settings = std::iter::once(("", seeds)).chain(others);
        settings.flat_map(move |(settings, seeds)| (0..seeds).map(move |seed| Case { entry, settings, seed }))
    });
    all.collect()
}

fn estimator(case: &Case) -> Box<dyn Estimator> {
    let section = [Section { name: "estimator", fields: case.entry.fields }];
    let document = Document::parse("benchmark", case.settings).unwrap();
    let Ok(estimator) = (case.entry.build)(&Resolved::new(&document, &section).unwrap()) else {
        panic!("{case}: the settings do not build")
    };
    estimator
}

fn fit(estimator: &dyn Estimator, envelope: &Envelope, seed: u64) -> Estimate {
    let cancel = Cancel::new();
    estimator.fit(envelope, &FitContext::new(Seed::new(seed), None, &Silent, &cancel)).unwrap()
}

#[divan::bench(args = cases())]
fn warm(bencher: Bencher<'_, '_>, case: &Case) {
    let (envelope, estimator) = (conformance::bent().unwrap(), estimator(case));
    assert_eq!(fit(estimator.as_ref(), &envelope, case.seed).stop.reached, Reached::Converged, "{case}");
    bencher.bench(|| fit(estimator.as_ref(), black_box(&envelope), case.seed));
}
