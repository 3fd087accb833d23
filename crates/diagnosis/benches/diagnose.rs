//! How long an answer takes: 25 s of a swing, 260 samples a second, on one thread and on one for each core.
//!
//!     cargo bench -p diagnosis

#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark")]

use diagnosis::{Diagnosis, Observations, Settings, diagnose};
use divan::{Bencher, black_box};
use dynamics::chain::{Chain, Observed, SampledMotion};
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Active, Coordinate, Nominal, Start, System};
use record::{Clock, ClockChoice, Quantity, Record};
use seed::Seed;

/// What is missing in the simulator, and the step of the encoder in rad, 0 for none.
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
    let times: Vec<f64> = (0..6500).map(|i| f64::from(i) / 260.0).collect();
    let motion = simulate(&system, Start::release(0.7), None, &times, &Tolerance::default()).unwrap();
    let sampled = SampledMotion {
        times_s: &times,
        position: &motion.position,
        velocity: &motion.velocity,
        acceleration: &motion.acceleration,
    };
    let encoder = (*step > 0.0).then(|| Active::new("sensor_quantization", &[*step]).unwrap());
    let chain = Chain::new(Observed::Position, 3e-4, encoder.into_iter().collect()).unwrap();
    let seed = Seed::new(0);
    let samples = chain.observe(&sampled, Coordinate::Angle, |id| seed.child(id).generator()).unwrap();
    let record = Record::new(samples.stamps_s, samples.values, None, Quantity::Position, "rad").unwrap();
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
