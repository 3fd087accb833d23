//! A record of a system with the new effect, from the law to the answer.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests")]

use diagnosis::{Observations, Settings, Status, diagnose};
use dynamics::chain::{Chain, Observed};
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Active, Coordinate, Nominal, Start, System};
use record::{Clock, ClockChoice, Quantity, Record};
use seed::Seed;

#[test]
fn a_record_with_sine_drag_is_diagnosed_as_it() {
    let nominal = Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap();
    let own = vec![Active::new("sine_drag", &[1.2]).unwrap()];
    let system = System::new(nominal, own).unwrap();
    let times: Vec<f64> = (0..2600).map(|i| f64::from(i) / 130.0).collect();
    let motion = simulate(&system, Start::release(0.8), None, &times, &Tolerance::default()).unwrap();
    let chain = Chain::new(Observed::Position, 2e-4, Vec::new()).unwrap();
    let draws = |id: &str| Seed::new(5).child(id).generator();
    let samples = chain.observe(&motion.sampled(&times), Coordinate::Angle, draws).unwrap();
    let record = Record::new(samples.stamps_s, samples.values, None, Quantity::Position, "rad").unwrap();

    let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
    let observed = [Observations::new(&record, &clock)];
    let answer = diagnose(&observed, &nominal, &Settings::default(), &|| 0.0).unwrap();

    assert_eq!(answer.verdict.status, Status::Effect);
    assert_eq!(answer.verdict.effects, ["sine_drag"]);
    let row = answer.effects.iter().find(|row| row.id == "sine_drag").unwrap();
    let found = &row.parameters[0].estimate;
    assert!((found.value / 1.2 - 1.0).abs() < 0.05, "{found:?}");
    assert!(row.probability > 0.5 && row.gap_share.unwrap().value > 0.5, "{row:?}");
    assert_eq!(diagnosis::evidence_class("sine_drag"), Some("damping"));
    // The repaired simulator has it too.
    assert!(answer.repaired.effects.iter().any(|active| active.id() == "sine_drag"));
}
