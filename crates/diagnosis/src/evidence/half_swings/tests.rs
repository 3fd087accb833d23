//! Half swings of simulated systems with known laws, and a table of measured ones.

use super::{HalfSwings, half_swings};
use crate::data::observations::Observations;
use crate::fixtures;
use crate::measurement::signatures;
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Nominal, System};
use record::{Clock, ClockChoice, CsvColumns, Format, ReadOptions, read_file};
use std::path::{Path, PathBuf};

/// Effects by their ids, with their parameters.
type Effects = &'static [(&'static str, &'static [f64])];

const OMEGA: f64 = 7.0 * std::f64::consts::PI;

/// Returns the half swings of a system released at 0.7 rad, 25 s at 260 Hz, observed with white noise and
/// effects of the measurement chain.
fn witnessed(
    damping_ratio: f64,
    effects: &[(&str, &[f64])],
    noise: f64,
    chain: &[(&str, &[f64])],
    seed: u64,
) -> HalfSwings {
    released(0.7, damping_ratio, effects, noise, chain, seed)
}

fn released(
    release: f64,
    damping_ratio: f64,
    effects: &[(&str, &[f64])],
    noise: f64,
    chain: &[(&str, &[f64])],
    seed: u64,
) -> HalfSwings {
    let active =
        |list: &[(&str, &[f64])]| list.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
    let nominal = Nominal::new(1.0, 2.0 * damping_ratio * OMEGA, OMEGA * OMEGA, 0.0).unwrap();
    let system = System::new(nominal, active(effects)).unwrap();
    let chain = Chain::new(Observed::Position, noise, active(chain)).unwrap();
    let record = fixtures::record(&system, release, 6500, &chain, seed);
    let observations = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
    let kept = signatures::kept(&observations);
    // The hint is off by a sixth.
    half_swings(&[observations], &[kept], 1.17 * OMEGA).unwrap()
}

fn line(name: &str, found: &HalfSwings) -> String {
    let w = &found.witness;
    let nats = |value: Option<f64>| value.map_or("    -".to_owned(), |value| format!("{value:5.0}"));
    let (first, last) = (found.swings.first().unwrap(), found.swings.last().unwrap());
    format!(
        "{name:12} {:4} {:5.0} {:8.3e}..{:8.3e} ±{:7.1e} | friction {} viscous {} drag {} | even {} time {} play {} presliding {} | asymmetric {} time {} | dry {:.4}±{:.4} viscous {:.5}±{:.5} quadratic {:.5}±{:.5} softening {:+.5}±{:.5}",
        w.count,
        w.effective,
        first.amplitude.value,
        last.amplitude.value,
        first.amplitude.error,
        nats(w.friction),
        nats(w.viscous),
        nats(w.drag),
        nats(w.even_stiffness),
        nats(w.period_drift),
        nats(w.play),
        nats(w.presliding),
        nats(w.asymmetric),
        nats(w.center_drift),
        w.dry_loss.value / first.amplitude.value,
        w.dry_loss.error / first.amplitude.value,
        w.viscous_loss.value,
        w.viscous_loss.error,
        w.quadratic_loss.value * first.amplitude.value,
        w.quadratic_loss.error * first.amplitude.value,
        w.softening.value,
        w.softening.error,
    )
}

fn shared(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name)
}

/// `cargo test -p diagnosis half_swings::tests::measured -- --ignored --nocapture`
#[test]
#[ignore = "a table to read"]
fn measured() {
    let csv = |value: Option<&str>| ReadOptions {
        columns: CsvColumns { value: value.map(str::to_owned), ..CsvColumns::default() },
        ..ReadOptions::default()
    };
    let log = ReadOptions { format: Format::HostLog, ..ReadOptions::default() };
    let (angle, plain, meters) = (csv(Some("angle_rad")), csv(Some("angle")), csv(Some("displacement_m")));
    for (record, nominal, options) in [
        ("horizontal-pendulum/80P.txt", "nominal", &log),
        ("horizontal-pendulum/60.txt", "nominal", &log),
        ("horizontal-pendulum/100.txt", "nominal", &log),
        ("encoder-pendulum/record-a.csv", "nominal", &plain),
        ("servo-pendulum/swing-a.csv", "nominal-a", &angle),
        ("servo-pendulum/swing-b.csv", "nominal-b", &angle),
        ("disc-oscillator/free-a.csv", "nominal", &angle),
        ("disc-oscillator/free-b.csv", "nominal", &angle),
        ("disc-oscillator/brake-a.csv", "nominal", &angle),
        ("disc-oscillator/brake-b.csv", "nominal", &angle),
        ("air-disc/release-a.csv", "nominal", &meters),
        ("air-disc/release-b.csv", "nominal", &meters),
        ("net-oscillator/record.csv", "nominal", &meters),
    ] {
        let path = shared(record);
        if !path.exists() {
            println!("skipped: {record} is not here");
            continue;
        }
        let (measured, _) = read_file(&path, options).unwrap();
        let observations = Observations::new(&measured, &Clock::new(&measured, ClockChoice::Auto).unwrap());
        let text = std::fs::read_to_string(path.with_file_name(format!("{nominal}.toml"))).unwrap();
        let nominal: Nominal = toml::from_str(&text).unwrap();
        let kept = signatures::kept(&observations);
        let omega = (nominal.stiffness() / nominal.inertia()).sqrt();
        match half_swings(&[observations], &[kept], omega) {
            Some(found) => println!("{}", line(record.split('/').next_back().unwrap(), &found)),
            None => println!("{record}: no half swings"),
        }
    }
}

/// Prints the evidence of each case below the folder `RIGS` (set at compile time), one line of JSON per case.
#[test]
#[ignore = "a bank to score elsewhere"]
fn rigs() {
    let Some(folder) = option_env!("RIGS") else {
        println!("skipped: no RIGS when this was compiled");
        return;
    };
    let mut cases: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    cases.sort();
    for case in cases.iter().filter(|case| case.join("nominal.toml").exists()) {
        let nominal: Nominal =
            toml::from_str(&std::fs::read_to_string(case.join("nominal.toml")).unwrap()).unwrap();
        let mut records = Vec::new();
        let mut files: Vec<PathBuf> =
            std::fs::read_dir(case).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        for file in files.iter().filter(|file| file.extension().is_some_and(|end| end == "csv")) {
            let text = std::fs::read_to_string(file).unwrap();
            let mut names = text.lines().find(|line| !line.starts_with('#')).unwrap().split(',').skip(1);
            let columns = CsvColumns {
                value: names.next().map(str::to_owned),
                input: names.next().map(str::to_owned),
                ..CsvColumns::default()
            };
            let Ok((record, _)) = read_file(file, &ReadOptions { columns, ..ReadOptions::default() }) else {
                continue;
            };
            records.push(Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap()));
        }
        let kept: Vec<Vec<bool>> = records.iter().map(signatures::kept).collect();
        let omega = (nominal.stiffness() / nominal.inertia()).sqrt();
        let name = case.file_name().unwrap().to_string_lossy();
        let driven = records.iter().all(|record| record.input.is_some());
        let Some(found) = half_swings(&records, &kept, omega) else {
            println!("RIG {{\"id\": \"{name}\", \"count\": 0, \"driven\": {driven}}}");
            continue;
        };
        let w = found.witness;
        let number = |value: Option<f64>| value.map_or("null".to_owned(), |value| format!("{value:.3}"));
        println!(
            "RIG {{\"id\": \"{name}\", \"driven\": {driven}, \"count\": {}, \"effective\": {:.2}, \"friction\": {}, \"drag\": {}, \"viscous\": {}, \"even\": {}, \"drift\": {}, \"play\": {}, \"presliding\": {}, \"asymmetric\": {}, \"center_drift\": {}}}",
            w.count,
            w.effective,
            number(w.friction),
            number(w.drag),
            number(w.viscous),
            number(w.even_stiffness),
            number(w.period_drift),
            number(w.play),
            number(w.presliding),
            number(w.asymmetric),
            number(w.center_drift),
        );
    }
}

/// Like [`measured`], for records of known systems, with and without defects of the measurement chain.
#[test]
#[ignore = "a table to read"]
fn simulated() {
    let laws: [(&str, f64, Effects); 12] = [
        ("viscous", 0.006, &[]),
        ("dry", 0.0, &[("coulomb_friction", &[1.0])]),
        ("quadratic", 0.0, &[("quadratic_drag", &[0.05])]),
        ("dry, visc", 0.003, &[("coulomb_friction", &[0.4])]),
        ("visc, quad", 0.003, &[("quadratic_drag", &[0.02])]),
        ("dry, quad", 0.0, &[("coulomb_friction", &[0.4]), ("quadratic_drag", &[0.02])]),
        ("cubic", 0.006, &[("cubic_stiffness", &[-20.0])]),
        ("gravity", 0.006, &[("gravity", &[150.0, 0.0])]),
        ("gravity 1.2", 0.006, &[("gravity", &[150.0, 1.2])]),
        ("asymmetric", 0.006, &[("asymmetric_stiffness", &[10.0])]),
        ("drift", 0.006, &[("stiffness_drift", &[0.001])]),
        ("backlash", 0.006, &[("backlash", &[0.004])]),
    ];
    let chains: [(&str, Effects); 3] = [
        ("plain", &[]),
        ("steps", &[("sensor_quantization", &[0.05])]),
        ("drift", &[("sensor_drift", &[0.0004])]),
    ];
    for (kind, chain) in chains {
        println!("{kind}");
        for (name, ratio, effects) in laws {
            println!("{}", line(name, &witnessed(ratio, effects, 1e-3, chain, 3)));
        }
    }
}

/// Evidence in nats above which a law counts as found.
const FOUND: f64 = 10.0;

/// Returns the laws of loss that a record's half swings find: dry, viscous, quadratic.
fn laws_found(found: &HalfSwings) -> [bool; 3] {
    let w = &found.witness;
    [w.friction, w.viscous, w.drag].map(|nats| nats.unwrap() > 0.0)
}

#[test]
fn each_law_of_loss_is_found_alone_and_in_pairs_and_none_is_invented() {
    let dry: (&str, &[f64]) = ("coulomb_friction", &[0.4]);
    let quadratic: (&str, &[f64]) = ("quadratic_drag", &[0.02]);
    for (ratio, effects, expected) in [
        (0.006, vec![], [false, true, false]),
        (0.0, vec![dry], [true, false, false]),
        (0.0, vec![quadratic], [false, false, true]),
        (0.003, vec![dry], [true, true, false]),
        (0.003, vec![quadratic], [false, true, true]),
        (0.0, vec![dry, quadratic], [true, false, true]),
    ] {
        let found = witnessed(ratio, &effects, 1e-3, &[], 3);
        assert_eq!(laws_found(&found), expected, "{}", line("", &found));
    }
}

/// Dry friction takes 2·τ/k from the amplitude in each half swing, viscous damping takes the share π·ζ.
#[test]
fn losses_have_their_sizes() {
    let found = witnessed(0.003, &[("coulomb_friction", &[0.4])], 1e-3, &[], 3).witness;
    let (dry, viscous) = (2.0 * 0.4 / (OMEGA * OMEGA), 0.003 * std::f64::consts::PI);
    assert!((found.dry_loss.value / dry - 1.0).abs() < 0.02, "{:?} {dry}", found.dry_loss);
    assert!((found.viscous_loss.value / viscous - 1.0).abs() < 0.02, "{:?} {viscous}", found.viscous_loss);
}

#[test]
fn wrong_readings_and_steps_take_no_law_away() {
    let effects: &[(&str, &[f64])] = &[("coulomb_friction", &[1.0])];
    for chain in
        [("outliers", &[0.01, 0.35][..]), ("sensor_quantization", &[0.05]), ("timestamp_jitter", &[0.001])]
    {
        let found = witnessed(0.0, effects, 1e-3, &[chain], 3);
        assert!(found.witness.friction.unwrap() > FOUND, "{chain:?} {}", line("", &found));
        assert!(found.witness.drag.unwrap() < 0.0, "{chain:?} {}", line("", &found));
    }
}

#[test]
fn a_bend_a_lean_and_a_drift_are_told_apart() {
    let told = |effects: &[(&str, &[f64])], chain: &[(&str, &[f64])]| {
        let w = witnessed(0.006, effects, 1e-3, chain, 3).witness;
        [w.even_stiffness, w.period_drift, w.asymmetric, w.center_drift].map(|nats| nats.unwrap() > 0.0)
    };
    assert_eq!(told(&[("cubic_stiffness", &[-20.0])], &[]), [true, false, false, false]);
    assert_eq!(told(&[("stiffness_drift", &[0.001])], &[]), [false, true, false, false]);
    assert_eq!(told(&[("asymmetric_stiffness", &[10.0])], &[]), [false, false, true, false]);
    assert_eq!(told(&[], &[("sensor_drift", &[0.0004])]), [false, false, false, true]);
    assert_eq!(told(&[], &[]), [false; 4]);
}

#[test]
fn the_period_of_a_pendulum_grows_as_theory_has_it() {
    let found = released(1.2, 0.002, &[("gravity", &[OMEGA * OMEGA, 0.0])], 1e-3, &[], 3);
    let swing = found.swings.first().unwrap();
    // Half of the restoring torque is the spring's: T/T₀ = 1 + A²/32 in first order.
    let expected = swing.amplitude.value.powi(2) / 32.0;
    let softening = found.witness.softening.value;
    assert!((softening / expected - 1.0).abs() < 0.1, "{softening} {expected}");
    assert!(found.witness.even_stiffness.unwrap() > FOUND);
}

#[test]
fn a_few_swings_say_nothing_of_laws_and_a_driven_record_has_none() {
    let found = released(0.7, 0.4, &[], 1e-3, &[], 3);
    assert!(found.witness.count < super::FEWEST && found.witness.friction.is_none());
    let still: Vec<f64> = vec![0.0; 500];
    let times: Vec<f64> = (0..500).map(|i| f64::from(i) / 100.0).collect();
    let of = |values: Vec<f64>, input: Option<Vec<f64>>| {
        let record =
            record::Record::new(times.clone(), values, input, record::Quantity::Position, "rad").unwrap();
        let observations = Observations::new(&record, &Clock::new(&record, ClockChoice::Host).unwrap());
        half_swings(&[observations], &[vec![true; 500]], 6.0)
    };
    assert_eq!(of(times.iter().map(|t| (6.0 * t).cos()).collect(), Some(still.clone())), None);
    assert_eq!(of(still, None), None);
    assert!(of(times.iter().map(|t| (6.0 * t).cos()).collect(), None).is_some());
}
