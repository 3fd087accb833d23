//! Tests of composite cases: those drawn here and those of a folder.

use super::banks::{RigTruth, hidden};
use super::integrator::{Moment, TorqueLaw};
use super::laws::SecondBody;
use super::plan::TrialPlan;
use crate::{Bank, Case};
use record::{ReadOptions, read_text};
use settings::Document;

fn plan(text: &str) -> TrialPlan {
    TrialPlan::resolve(&Document::parse("test.toml", text).unwrap()).unwrap()
}

#[test]
fn composite_cases_hide_effects_over_two_decades_beside_small_nameless_laws() {
    let plan = plan("[trials]\ncomposite = 12\n[record]\nseconds = 10.0");
    let (mut least, mut most, mut rates) = (f64::INFINITY, 0.0_f64, Vec::new());
    for index in 0..plan.len() {
        let Case { hidden, records, .. } = plan.case(index).unwrap();
        let sizes: Vec<f64> = hidden.effects.iter().map(|effect| effect.floors.unwrap()).collect();
        assert!((2..=6).contains(&sizes.len()) && sizes.is_sorted_by(|one, next| one >= next), "{sizes:?}");
        assert!((29.0..=152.0).contains(&sizes[0]), "{sizes:?}");
        let nameless: Vec<f64> = hidden.unlisted.iter().map(|law| law.floors).collect();
        assert!(!nameless.is_empty() && nameless.iter().all(|size| (0.29..=3.1).contains(size)));
        most = most.max(sizes[0]);
        least = least.min(sizes[sizes.len() - 1]);
        let (record, _) = read_text("record", records[0].as_bytes(), &ReadOptions::default()).unwrap();
        rates.push(record.len() as f64 / record.stamps_s().last().unwrap());
    }
    assert!(most / least > 20.0, "{least} to {most}");
    rates.sort_by(f64::total_cmp);
    assert!(rates[rates.len() - 1] > 5.0 * rates[0], "{rates:?}");
}

/// Two bodies without damping, the first held in place: the second swings about it at its own frequency.
#[test]
fn a_second_body_beside_one_that_is_held_swings_at_its_own_frequency() {
    let law = SecondBody { inertia: 2.0, frequency: 3.0, damping_ratio: 0.1 };
    let held = Moment { time: 0.0, deflection: 0.5, velocity: 0.0, hidden: [0.7, 0.0] };
    let [mut position, mut velocity] = held.hidden;
    let (duration, steps) = (0.8, 200_000);
    let step = duration / f64::from(steps);
    for _ in 0..steps {
        // Acceleration by the law's own torque, integrated with the midpoint rule.
        let rate = |position: f64, velocity: f64| {
            -law.torque(&Moment { hidden: [position, velocity], ..held }) / law.inertia
        };
        let middle = (position + 0.5 * step * velocity, velocity + 0.5 * step * rate(position, velocity));
        (position, velocity) = (position + step * middle.1, velocity + step * rate(middle.0, middle.1));
    }
    let [found, speed] = law.relax(&held, duration);
    assert!((found - position).abs() < 1e-8 && (speed - velocity).abs() < 1e-8, "{found} {position}");
}

fn rigs() -> Vec<Case> {
    let folder = format!("{}/src/make/fixtures/rigs", env!("CARGO_MANIFEST_DIR"));
    let plan = plan(&format!("[trials]\nrigs_cases = 5\nrigs = {folder:?}"));
    assert_eq!(plan.len(), 3);
    let mut cases: Vec<Case> = (0..3).map(|index| plan.case(index).unwrap()).collect();
    cases.sort_by_key(|case| case.hidden.made.clone());
    cases
}

#[test]
fn rigs_keep_their_records_and_hide_sizes_apart() {
    let cases = rigs();
    assert!(cases.iter().all(|case| case.hidden.bank == Bank::Rigs && case.records.len() == 1));
    let composite = cases.iter().find(|case| !case.hidden.effects.is_empty()).unwrap();
    let hidden = &composite.hidden;
    assert_eq!(hidden.effects[0].id, "stiffness_drift");
    let floors = hidden.effects[0].floors.unwrap();
    assert!((hidden.effects[0].detectability / floors - 1078.0_f64.sqrt()).abs() < 1e-9);
    assert_eq!(hidden.nuisances, ["sensor_quantization", "clock_drift"]);
    assert_eq!((hidden.unlisted[0].law.as_str(), &hidden.foreign), ("maxwell", &None));
    for case in &cases {
        let (record, _) = read_text("record", case.records[0].as_bytes(), &ReadOptions::default()).unwrap();
        assert!(record.len() > 1000);
    }
}

#[test]
fn a_law_alone_allows_classes_that_leave_little_of_it_and_a_small_one_asks_for_no_verdict() {
    let cases = rigs();
    let alone = cases.iter().find(|case| case.hidden.foreign.is_some()).unwrap();
    // An exponential spring is a restoring torque by its mechanism; cubic and quadratic springs leave 0.23 ×
    // noise of it.
    assert!(alone.hidden.allowed.iter().all(|class| class == "restoring"), "{:?}", alone.hidden.allowed);
    assert!(!alone.hidden.allowed.is_empty() && alone.hidden.unlisted.is_empty());
    let small =
        cases.iter().find(|case| case.hidden.effects.is_empty() && case.hidden.foreign.is_none()).unwrap();
    assert_eq!(small.hidden.unlisted[0].law, "wandering_forcing");
}

#[test]
fn a_truth_that_the_vocabulary_does_not_know_is_refused() {
    let text = std::fs::read_to_string(format!(
        "{}/src/make/fixtures/rigs/truths/00001.json",
        env!("CARGO_MANIFEST_DIR")
    ))
    .unwrap();
    let refusal = |text: &str| hidden(serde_json::from_str::<RigTruth>(text).unwrap()).unwrap_err();
    assert_eq!(refusal(&text.replace("coulomb_friction", "magic")), "there is no effect magic");
    let other = refusal(&text.replace("ringdown.rig/1", "ringdown.rig/9"));
    assert_eq!(other, "its schema is ringdown.rig/9, not ringdown.rig/1");
}

#[test]
fn a_folder_without_rigs_is_left_out_and_said_so() {
    let plan = plan("[trials]\nrigs_cases = 5\nrigs = \"no/such/folder\"");
    let left = plan.left_out_banks();
    assert!(plan.is_empty() && left[0].bank == Bank::Rigs, "{left:?}");
    assert!(left[0].reason.starts_with("no/such/folder: cannot be read"), "{}", left[0].reason);
}
