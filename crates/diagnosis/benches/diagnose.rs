//! Benchmark of a diagnosis: 25 s of a swing, 260 samples a second, on one thread and on one for each core.
//!
//!     cargo bench -p diagnosis

#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark")]

use diagnosis::{Diagnosis, Observations, Settings, diagnose};
use divan::{Bencher, black_box};
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Nominal, System};
use record::{Clock, ClockChoice};

#[path = "../src/fixtures.rs"]
mod fixtures;

/// Name of a case, the effects that the simulator lacks, and the step of the encoder in rad, 0 for none.
type Case = (&'static str, &'static [(&'static str, &'static [f64])], f64);

const CASES: [Case; 4] = [
    ("nothing", &[], 0.0),
    ("drag", &[("quadratic_drag", &[0.02])], 0.0),
    ("drag and a softening spring", &[("quadratic_drag", &[0.02]), ("cubic_stiffness", &[-8.0])], 0.0),
    ("dry friction, coarse encoder", &[("coulomb_friction", &[0.4])], 1.5e-3),
];

fn main() {
    divan::main();
}

fn nominal() -> Nominal {
    Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap()
}

fn observed((_, effects, step): &Case) -> Observations {
    let active = |(id, values): &(&str, &[f64])| Active::new(id, values).unwrap();
    let system = System::new(nominal(), effects.iter().map(active).collect()).unwrap();
    let encoder = (*step > 0.0).then(|| Active::new("sensor_quantization", &[*step]).unwrap());
    let chain = Chain::new(Observed::Position, 3e-4, encoder.into_iter().collect()).unwrap();
    let record = fixtures::record(&system, 0.7, 6500, &chain, 0);
    Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap())
}

fn answer(bencher: Bencher<'_, '_>, name: &str, threads: usize) {
    let case = CASES.iter().find(|case| case.0 == name).unwrap();
    let records = [observed(case)];
    let nominal = nominal();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let of = || -> Diagnosis {
        pool.install(|| diagnose(black_box(&records), &nominal, &Settings::default(), &|| 0.0).unwrap())
    };
    let named = of().verdict.effects;
    assert!(case.1.iter().all(|(id, _)| named.contains(id)), "{name}: {named:?}");
    bencher.bench(of);
}

#[divan::bench(args = CASES.iter().map(|case| case.0), sample_count = 5, sample_size = 1)]
fn one_thread(bencher: Bencher<'_, '_>, name: &str) {
    answer(bencher, name, 1);
}

#[divan::bench(args = CASES.iter().map(|case| case.0), sample_count = 5, sample_size = 1)]
fn all_cores(bencher: Bencher<'_, '_>, name: &str) {
    answer(bencher, name, 0);
}
