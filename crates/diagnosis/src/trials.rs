//! Trials on simulated records.

use crate::{Diagnosis, Observations, Settings, Status, diagnose};
use dynamics::chain::{Chain, Observed};
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Active, Coordinate, Nominal, Start, System};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use record::{Clock, ClockChoice, Quantity, Record};
use seed::Seed;

fn answer(observations: &[Observations], nominal: &Nominal) -> Diagnosis {
    let clock = std::time::Instant::now();
    diagnose(observations, nominal, &Settings::default(), &|| clock.elapsed().as_secs_f64()).unwrap()
}

const OMEGA: f64 = 7.0 * std::f64::consts::PI;

fn nominal() -> Nominal {
    Nominal::new(1.0, 2.0 * 0.006 * OMEGA, OMEGA * OMEGA, 0.0).unwrap()
}

/// Simulates a record of a system: the sensor's own map, then white noise, then a quantizer if `step` is
/// positive.
fn record(
    system: &System,
    seconds: f64,
    noise: f64,
    step: f64,
    seed: u64,
    sensor: &dyn Fn(f64, f64) -> f64,
) -> Observations {
    let times: Vec<f64> = (0..(seconds * 260.0) as usize).map(|i| i as f64 / 260.0).collect();
    let motion = simulate(system, Start::release(0.7), None, &times, &Tolerance::default()).unwrap();
    let mut generator = Seed::new(seed).child("sensor").generator();
    let values: Vec<f64> = motion
        .position
        .iter()
        .zip(&times)
        .map(|(x, t)| {
            let white: f64 = StandardNormal.sample(&mut generator);
            let value = sensor(*x, *t) + noise * white;
            if step > 0.0 { (value / step).round() * step } else { value }
        })
        .collect();
    let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
    let clock = Clock::new(&record, ClockChoice::Host).unwrap();
    Observations::new(&record, &clock)
}

fn plain(x: f64, _: f64) -> f64 {
    x
}

fn system(effects: &[(&str, &[f64])]) -> System {
    let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
    System::new(nominal(), active).unwrap()
}

/// Effects of the system, at strengths that move the record by several times the noise of 1 mrad.
const CASES: &[(&str, &[f64])] = &[
    ("coulomb_friction", &[0.4]),
    ("stribeck_friction", &[0.3, 1.2, 1.5]),
    ("quadratic_drag", &[0.02]),
    ("cubic_stiffness", &[-20.0]),
    ("asymmetric_stiffness", &[10.0]),
    ("backlash", &[0.004]),
    ("hysteresis", &[1.0, 0.05]),
    ("end_stop", &[0.55, 400.0, 0.0]),
    ("stiffness_drift", &[0.001]),
    ("damping_drift", &[0.03]),
    ("periodic_forcing", &[1.0, 31.0, 0.3]),
    ("gravity", &[150.0, 1.2]),
    ("flexible_coupling", &[0.1, 180.0, 0.2]),
];

/// `cargo test --release -p diagnosis trials::every_effect_is_found -- --ignored`
#[test]
#[ignore = "a minute in a release build"]
fn every_effect_is_found() {
    let mut missed = Vec::new();
    for (number, case) in CASES.iter().enumerate() {
        let observations = record(&system(&[*case]), 25.0, 1e-3, 0.0, number as u64, &plain);
        let answer = answer(&[observations], &nominal());
        if answer.verdict.effects.first() != Some(&case.0) {
            missed.push(case.0);
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// As [`every_effect_is_found`].
#[test]
#[ignore = "a minute in a release build"]
fn clean_records_lack_nothing() {
    let off = nominal();
    let other = Nominal::new(1.0, 1.2 * off.damping(), 0.8 * off.stiffness(), 0.0).unwrap();
    for seed in 0..10 {
        let observations = record(&system(&[]), 25.0, 1e-3, 0.0, 100 + seed, &plain);
        let clean = answer(std::slice::from_ref(&observations), &off);
        assert_eq!(clean.verdict.status, Status::None);
        let shifted = answer(&[observations], &other);
        assert_eq!(shifted.verdict.status, Status::Calibration);
    }
}

/// Effects of the measurement chain, each several times the noise of 1 mrad.
const CHAINS: &[(&str, &[f64])] = &[
    ("sensor_quantization", &[0.02]),
    ("sensor_saturation", &[0.55]),
    ("sensor_nonlinearity", &[0.02, 0.5]),
    ("sensor_drift", &[4e-4]),
    ("timestamp_batching", &[0.062, 0.002]),
    ("timestamp_jitter", &[1e-3]),
    ("clock_drift", &[0.0, 1e-4]),
    ("dropouts", &[0.05, 6.0]),
    ("outliers", &[0.01, 0.1]),
];

/// Simulates a record through a measurement chain, with the values rounded as in a file.
fn through(system: &System, release: f64, chain: &Chain, seed: u64) -> Observations {
    let times: Vec<f64> = (0..6500).map(|i| f64::from(i) / 260.0).collect();
    let motion = simulate(system, Start::release(release), None, &times, &Tolerance::default()).unwrap();
    let seed = Seed::new(seed);
    let samples =
        chain.observe(&motion.sampled(&times), Coordinate::Angle, |id| seed.child(id).generator()).unwrap();
    let round = |value: f64| (value * 1e6).round() / 1e6;
    let stamps = samples.stamps_s.iter().map(|stamp| round(*stamp)).collect();
    let values = samples.values.iter().map(|value| round(*value)).collect();
    let record = Record::new(stamps, values, None, Quantity::Position, "rad").unwrap();
    let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
    Observations::new(&record, &clock)
}

/// Hidden effect of a case, the answer, and whether it is right.
struct Outcome {
    hidden: &'static str,
    found: String,
    right: bool,
}

/// Diagnoses ten records of each effect, with sizes over a factor of four, releases over a factor of two, and
/// nominal simulators off by up to 10 % in half of them, and a hundred records without any effect.
fn bank(only: Option<&str>) -> Vec<Outcome> {
    let cases: Vec<(&'static str, &[f64])> = CASES.iter().chain(CHAINS).copied().collect();
    let wanted = |id: &str| only.is_none_or(|only| only == id);
    let mut jobs: Vec<(&'static str, &[f64], u64)> = Vec::new();
    for (id, values) in cases.into_iter().filter(|case| wanted(case.0)) {
        jobs.extend((0..10).map(|seed| (id, values, seed)));
    }
    if wanted("none") {
        jobs.extend((0..100).map(|seed| ("none", &[][..], seed)));
    }
    jobs.par_iter()
        .map(|&(hidden, values, number)| {
            let mut generator = Seed::new(7).child(hidden).child(&number.to_string()).generator();
            let mut draw = |low: f64, high: f64| -> f64 { generator.random_range(low..high) };
            let size = libm::pow(2.0_f64, draw(-1.0, 1.0));
            let release = draw(0.45, 0.9);
            let is_chain = CHAINS.iter().any(|case| case.0 == hidden);
            let mut values = values.to_vec();
            // The first parameter is the size, except for effects whose first parameter is a place or a time.
            let sized = !matches!(hidden, "end_stop" | "sensor_saturation" | "timestamp_batching" | "clock_drift");
            if let (Some(first), true) = (values.first_mut(), sized) {
                *first *= size;
            }
            match (hidden, values.as_mut_slice()) {
                ("stribeck_friction", [_, second, _]) | ("clock_drift", [_, second]) => *second *= size,
                ("end_stop" | "sensor_saturation", [place, ..]) => *place = release * draw(0.7, 0.9),
                _ => {}
            }
            let off = if number % 2 == 0 { [1.0, 1.0] } else { [draw(0.9, 1.1), draw(0.9, 1.1)] };
            let truth = nominal();
            let believed =
                Nominal::new(1.0, off[0] * truth.damping(), off[1] * truth.stiffness(), 0.0).unwrap();
            let active = || vec![Active::new(hidden, &values).unwrap()];
            let none = hidden == "none";
            let own = if is_chain || none { vec![] } else { active() };
            let distortion = if is_chain { active() } else { vec![] };
            let system = System::new(truth, own).unwrap();
            let chain = Chain::new(Observed::Position, 1e-3, distortion).unwrap();
            let observations = through(&system, release, &chain, number);
            let clock = std::time::Instant::now();
            let seconds = || clock.elapsed().as_secs_f64();
            let answer = match diagnose(&[observations], &believed, &Settings::default(), &seconds) {
                Ok(answer) => answer,
                Err(error) => return Outcome { hidden, found: format!("{number} {values:?} {error}"), right: false },
            };
            let effects = &answer.verdict.effects;
            let named = |id: &str| effects.contains(&id) || answer.verdict.equivalent.iter().any(|c| c.contains(&id));
            let right = match hidden {
                "none" => matches!(answer.verdict.status, Status::None | Status::Calibration),
                id => effects.first() == Some(&id) || effects.len() == 1 && named(id),
            };
            let seconds: f64 = answer.stages.iter().map(|stage| stage.seconds).sum();
            let found = format!(
                "{number} {values:.4?} release {release:.2} -> {:?} {:?} {:.2} ratio {:.2} recalibrated {:.1e} {seconds:.1} s \
                 eq {:?}",
                answer.verdict.status,
                effects,
                answer.verdict.confidence,
                answer.gap.ratio_to_floor,
                answer.gap.recalibrated,
                answer.verdict.equivalent
            );
            println!("{} {hidden} {found}", if right { "right" } else { "WRONG" });
            Outcome { hidden, found, right }
        })
        .collect()
}

/// `cargo test --release -p diagnosis trials::a_bank_of_hidden_effects -- --ignored --nocapture`
#[test]
#[ignore = "minutes in a release build"]
fn a_bank_of_hidden_effects() {
    let outcomes = bank(option_env!("HIDDEN"));
    let mut ids: Vec<&str> = outcomes.iter().map(|outcome| outcome.hidden).collect();
    ids.dedup();
    let mut short = Vec::new();
    for id in ids {
        let own: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.hidden == id).collect();
        let right = own.iter().filter(|outcome| outcome.right).count();
        println!("== {id} {right} of {}", own.len());
        for outcome in own.iter().filter(|outcome| !outcome.right) {
            println!("   {}", outcome.found);
        }
        let needed = if id == "none" { 98 } else { 9 };
        if right < needed {
            short.push(format!("{id}: {right} of {}", own.len()));
        }
    }
    assert!(short.is_empty(), "{short:?}");
}
