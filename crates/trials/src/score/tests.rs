//! Tests of whole scores.

use super::sample::{answered, case};
use super::{AnsweredCase, Gate, Trials, case_rows, misses_a_bar, misses_the_gate, score};
use crate::baseline::most_common;
use crate::hidden::Bank;
use results::LeftOutBank;

fn trials() -> Trials {
    Trials {
        name: "trials".to_owned(),
        seed: 1,
        left_out: vec![LeftOutBank { bank: "engine".to_owned(), reason: "no engine here".to_owned() }],
        gate: Gate::default(),
        seconds: 1.0,
    }
}

fn cases() -> Vec<AnsweredCase> {
    let mut cases = Vec::new();
    for index in 0..60 {
        let (bank, hidden): (Bank, &[&str]) = match index % 6 {
            0 => (Bank::None, &[]),
            1 => (Bank::Single, &["gravity"]),
            2 => (Bank::Single, &["coulomb_friction"]),
            3 => (Bank::Pair, &["coulomb_friction", "gravity"]),
            4 => (Bank::LeftOut, &["gravity"]),
            _ => (Bank::Stressed, &["backlash"]),
        };
        let answer = match bank {
            Bank::None => answered("none", &[], 0.95),
            Bank::LeftOut => answered("unknown", &[], 0.9),
            _ if index > 50 => Err("too few samples".to_owned()),
            _ => answered("effect", hidden, 0.9),
        };
        let mut case = case(bank, hidden, answer);
        case.id = format!("case-{index:03}");
        cases.push(case);
    }
    cases[1].true_closure = Ok(0.95);
    cases[7].true_closure = Ok(0.5);
    cases
}

#[test]
fn a_score_counts_every_case_once() {
    let cases = cases();
    let found = score(&trials(), &cases, &[most_common(&cases)]);
    assert_eq!((found.cases, found.unanswered), (60, 6));
    let of: u64 = found.banks.iter().map(|bank| bank.right.of).sum();
    assert_eq!(of, 60);
    // A case without an answer is wrong.
    assert_eq!(found.failures.len(), 6);
    assert!(found.failures.iter().all(|row| row.said == "no answer: too few samples"));
    assert_eq!((found.closure.coverage.count, found.closure.coverage.of, found.closure.below), (1, 2, 1));
    let left_out: u64 = found.closure.left_out.values().sum();
    assert_eq!(left_out, 58);
    assert_eq!(found.unknown.areas[0].area.value, 1.0);
    assert_eq!(found.ratio_to_floor.median.value, 1.02);
    assert_eq!(found.baselines[0].top_1.of, 20);
    assert_eq!(found.bars.len(), 14);
    assert_eq!(found.left_out[0].bank, "engine");
    // A map fitted to the even half improves the other half's scores, whose confidence is too low.
    assert!(!found.map.knots.is_empty() && found.map.fitted_to > 20);
    assert_eq!(case_rows(&cases).len(), 60);
}

#[test]
fn a_score_survives_its_file_and_is_the_same_again() {
    let cases = cases();
    let found = score(&trials(), &cases, &[]);
    let text = serde_json::to_string(&found).unwrap();
    let read: results::TrialsResult = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string(&read).unwrap(), text);
    assert_eq!(serde_json::to_string(&score(&trials(), &cases, &[])).unwrap(), text);
}

#[test]
fn a_bar_missed_beyond_chance_is_noticed() {
    let good: Vec<AnsweredCase> =
        (0..40).map(|_| case(Bank::None, &[], answered("none", &[], 0.99))).collect();
    assert!(!misses_a_bar(&score(&trials(), &good, &[])));
    let bad: Vec<AnsweredCase> =
        (0..40).map(|_| case(Bank::None, &[], answered("effect", &["gravity"], 0.97))).collect();
    assert!(misses_a_bar(&score(&trials(), &bad, &[])));
}

fn gated(text: &str) -> Trials {
    let document = settings::Document::parse("gate.toml", text).unwrap();
    Trials { gate: Gate::of(&document).unwrap(), ..trials() }
}

#[test]
fn a_gate_is_missed_by_a_score_on_the_wrong_side_alone() {
    let quiet: Vec<AnsweredCase> =
        (0..8).map(|_| case(Bank::None, &[], answered("none", &[], 0.9))).collect();
    let loud = [vec![case(Bank::None, &[], answered("effect", &["gravity"], 0.9))], quiet.clone()].concat();
    let gate = gated("[gate]\nfalse_alarms = 0.1");
    assert!(!misses_the_gate(&score(&gate, &quiet, &[])));
    let missed = score(&gate, &loud, &[]);
    assert!(misses_the_gate(&missed) && missed.gate.len() == 1, "{:?}", missed.gate);
    // A limit that is not set is not part of the gate.
    assert!(!misses_the_gate(&score(&trials(), &loud, &[])));
}

#[test]
fn a_gate_looks_at_the_leading_class() {
    let of = |named: &[&str], sure: f64| {
        let mut case = case(Bank::Composite, &["gravity", "backlash"], answered("effect", named, sure));
        case.hidden.effects[0].floors = Some(60.0);
        case.hidden.effects[1].floors = Some(3.0);
        case.hidden.unlisted = vec![crate::Unlisted { law: "field".to_owned(), floors: 1.0, class: None }];
        case
    };
    let gate = gated("[gate]\nleading_named = 0.9\nleading_sure = 0.9\nrecall = 0.9\nprecision = 0.9");
    let states = |case: AnsweredCase| -> Vec<String> {
        score(&gate, &[case], &[]).gate.into_iter().map(|row| row.state).collect()
    };
    // A cubic spring belongs to gravity's class; the backlash is too small to count.
    assert_eq!(states(of(&["cubic_stiffness"], 0.95)), ["met", "met", "met", "met"]);
    assert_eq!(states(of(&["cubic_stiffness"], 0.5)), ["met", "not met", "met", "met"]);
    assert_eq!(states(of(&["backlash", "end_stop"], 0.95)), ["not met", "not met", "not met", "met"]);
    assert_eq!(states(of(&["hysteresis", "gravity"], 0.95)), ["met", "met", "met", "not met"]);
}
