//! Coverage of the posterior's intervals, counted on many simulated records. This takes minutes, so it is run
//! by name:
//!
//!     cargo test -p learn coverage -- --ignored --nocapture

use crate::data::{DataSet, Trajectory};
use crate::testing::{NEVER, learner, making, record};
use crate::{Context, LearnError};
use dynamics::{Active, Nominal, NominalSimulator, System};
use rand::RngExt;
use rand_distr::{Distribution, Normal};
use seed::Seed;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of records of each of the two laws.
const RECORDS: usize = 100;

/// Draws a law whose coefficients lie within a factor of two, separately for each record. Returns the system
/// and the weights of its terms.
fn drawn(number: usize, driven: bool) -> (System, Vec<(&'static str, f64)>) {
    let mut generator = Seed::new(number as u64).child("coverage").generator();
    let mut around = |value: f64| value * 2.0_f64.powf(generator.random_range(-0.5..0.5));
    let (first, second) = if driven { (around(0.2), around(30.0)) } else { (around(0.15), around(24.0)) };
    let (damping, stiffness) =
        if driven { (around(0.3), around(40.0)) } else { (around(0.12), around(16.0)) };
    let (effects, mut terms) = if driven {
        let effects = [("quadratic_drag", vec![first]), ("cubic_stiffness", vec![second])];
        (effects, vec![("theta_dot*|theta_dot|", -first), ("theta^3", -second), ("u", 1.0)])
    } else {
        let effects = [("coulomb_friction", vec![first]), ("gravity", vec![second, 0.0])];
        (effects, vec![("sign(theta_dot)", -first), ("sin(theta)", -second)])
    };
    terms.extend([("theta", -stiffness), ("theta_dot", -damping)]);
    let effects = effects.map(|(id, values)| Active::new(id, &values).unwrap()).to_vec();
    let nominal = Nominal::new(1.0, damping, stiffness, 0.0).unwrap();
    (System::new(nominal, effects).unwrap(), terms)
}

/// Returns the standardized errors of the coefficients learned from one record, with their names.
fn errors(number: usize, driven: bool) -> Result<Vec<(&'static str, f64)>, LearnError> {
    let (system, terms) = drawn(number, driven);
    let clean = record(&system, number % 6, driven, 0.0);
    let noise = Normal::new(0.0, 2e-3).unwrap();
    // One record trains; one chooses the length of the pieces; the third is unused.
    let noisy = |part: &str| {
        let mut generator = Seed::new(number as u64).child("coverage").child(part).generator();
        let values = clean.values().iter().map(|value| value + noise.sample(&mut generator)).collect();
        Trajectory::new(part, clean.times_s().to_vec(), values, clean.input().map(<[f64]>::to_vec))
    };
    let records = [noisy("training")?, noisy("validation")?, noisy("test")?];
    let mut making = making(Some(NominalSimulator::from(system.nominal())));
    making.split.test_records = 1;
    let data = DataSet::new(&records, making)?;
    let names: Vec<String> = terms.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    let law = format!("library=[{}]", names.join(","));
    let seed = Seed::new(number as u64);
    let context = Context { seed, max_steps: None, cancel: &NEVER, observe: &|_| (), checkpoints: None };
    let fitted = learner("bayesian", &[&law]).fit(&data, &context)?;
    let error = |(name, truth): (&'static str, f64)| {
        let own = fitted.model.coefficients().iter().find(|own| own.name == name).unwrap();
        (name, (own.value - truth) / own.std_error.unwrap())
    };
    Ok(terms.into_iter().map(error).collect())
}

/// Two hundred records of two laws, each with its own coefficients, initial state and noise. The interval of
/// the coverage counts records and not coefficients, because the errors of one record are correlated.
#[test]
#[ignore = "takes minutes"]
fn ninety_five_percent_intervals_hold_the_truth_in_ninety_five_percent() {
    let jobs: Vec<(usize, bool)> =
        [false, true].into_iter().flat_map(|driven| (0..RECORDS).map(move |n| (n, driven))).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut found = Vec::new();
        while let Some(&(number, driven)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let own = errors(number, driven);
            found.push((number, driven, own.unwrap_or_else(|error| panic!("{number} {driven}: {error}"))));
        }
        found
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let mut all: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    all.sort_by_key(|(number, driven, _)| (*driven, *number));
    let mut by_name: std::collections::BTreeMap<String, (usize, usize, f64)> =
        std::collections::BTreeMap::new();
    for (_, driven, own) in &all {
        for (name, error) in own {
            let slot =
                by_name.entry(format!("{} {name}", if *driven { "driven" } else { "free" })).or_default();
            slot.0 += usize::from(error.abs() <= 1.96);
            slot.1 += 1;
            slot.2 += error * error;
        }
    }
    for (name, (held, count, squares)) in &by_name {
        println!(
            "{name}: {held} of {count}, root mean square error {:.3} standard errors",
            (squares / *count as f64).sqrt()
        );
    }
    let shares: Vec<f64> = all
        .iter()
        .map(|(_, _, own)| {
            own.iter().filter(|(_, error)| error.abs() <= 1.96).count() as f64 / own.len() as f64
        })
        .collect();
    let count = shares.len() as f64;
    let mean = shares.iter().sum::<f64>() / count;
    let deviation = (shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    let half = 1.96 * deviation / count.sqrt();
    println!(
        "the 95 % intervals hold the truth in {:.1} % (95 % interval {:.1} to {:.1} %) over {count} records",
        100.0 * mean,
        100.0 * (mean - half),
        100.0 * (mean + half)
    );
    assert!((0.93..=0.97).contains(&mean), "{mean}");
}
