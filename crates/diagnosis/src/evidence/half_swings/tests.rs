//! Half swings of simulated systems with known laws.

use super::{Witness, half_swings};
use crate::data::observations::Observations;
use crate::fixtures;
use crate::measurement::signatures;
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Nominal, System};
use record::{Clock, ClockChoice};

const OMEGA: f64 = 7.0 * std::f64::consts::PI;

/// Returns the half swings of a system released at 0.7 rad, 25 s at 260 Hz, observed with white noise and
/// effects of the measurement chain.
fn witnessed(
    damping_ratio: f64,
    effects: &[(&str, &[f64])],
    noise: f64,
    chain: &[(&str, &[f64])],
    seed: u64,
) -> Option<Witness> {
    released(0.7, damping_ratio, effects, noise, chain, seed)
}

fn released(
    release: f64,
    damping_ratio: f64,
    effects: &[(&str, &[f64])],
    noise: f64,
    chain: &[(&str, &[f64])],
    seed: u64,
) -> Option<Witness> {
    let active =
        |list: &[(&str, &[f64])]| list.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
    let nominal = Nominal::new(1.0, 2.0 * damping_ratio * OMEGA, OMEGA * OMEGA, 0.0).unwrap();
    let system = System::new(nominal, active(effects)).unwrap();
    let chain = Chain::new(Observed::Position, noise, active(chain)).unwrap();
    let record = fixtures::record(&system, release, 6500, &chain, seed);
    let observations = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
    let kept = signatures::kept(&observations);
    // The hint is off by a sixth.
    half_swings(&[observations], &[kept], 1.17 * OMEGA)
}

/// Evidence in nats above which a law counts as found.
const FOUND: f64 = 10.0;

/// Returns the laws of loss that half swings find: dry, quadratic.
fn laws_found(found: Option<Witness>) -> [bool; 2] {
    let found = found.unwrap();
    [found.friction, found.drag].map(|nats| nats.unwrap() > 0.0)
}

#[test]
fn each_law_of_loss_is_found_alone_and_in_pairs_and_none_is_invented() {
    let dry: (&str, &[f64]) = ("coulomb_friction", &[0.4]);
    let quadratic: (&str, &[f64]) = ("quadratic_drag", &[0.02]);
    for (ratio, effects, expected) in [
        (0.006, vec![], [false, false]),
        (0.0, vec![dry], [true, false]),
        (0.0, vec![quadratic], [false, true]),
        (0.003, vec![dry], [true, false]),
        (0.003, vec![quadratic], [false, true]),
        (0.0, vec![dry, quadratic], [true, true]),
    ] {
        let found = witnessed(ratio, &effects, 1e-3, &[], 3);
        assert_eq!(laws_found(found), expected, "{ratio} {effects:?}");
    }
}

#[test]
fn wrong_readings_and_steps_take_no_law_away() {
    let effects: &[(&str, &[f64])] = &[("coulomb_friction", &[1.0])];
    for chain in
        [("outliers", &[0.01, 0.35][..]), ("sensor_quantization", &[0.05]), ("timestamp_jitter", &[0.001])]
    {
        let found = witnessed(0.0, effects, 1e-3, &[chain], 3).unwrap();
        assert!(found.friction.unwrap() > FOUND, "{chain:?} {found:?}");
        assert!(found.drag.unwrap() < 0.0, "{chain:?} {found:?}");
    }
}

#[test]
fn a_few_swings_say_nothing_of_laws_and_a_driven_record_has_none() {
    assert_eq!(released(0.7, 0.4, &[], 1e-3, &[], 3), None);
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
    let decay = times.iter().map(|t| (-0.1 * t).exp() * (10.0 * t).cos()).collect();
    assert!(of(decay, None).is_some());
}
