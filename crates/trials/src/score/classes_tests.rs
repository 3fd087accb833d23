//! Tests of scores by class, on answers that can be counted by hand.

use super::AnsweredCase;
use super::classes::{statements, study};
use super::judgment::Judgment;
use super::sample::{answered, case};
use crate::hidden::{Bank, Foreign, Unlisted};
use results::{ClassScores, WithInterval};

/// Builds a composite case: effects with their sizes × noise, and a law outside the vocabulary that belongs
/// to a class.
fn composite(hidden: &[(&str, f64)], class: Option<&str>, named: &[&str]) -> AnsweredCase {
    let ids: Vec<&str> = hidden.iter().map(|(id, _)| *id).collect();
    let mut case = case(Bank::Composite, &ids, answered("effect", named, 0.95));
    for (effect, (_, floors)) in case.hidden.effects.iter_mut().zip(hidden) {
        effect.floors = Some(*floors);
    }
    let class = class.map(str::to_owned);
    case.hidden.unlisted = vec![Unlisted { law: "field".to_owned(), floors: 1.0, class }];
    case
}

fn scores(cases: &[AnsweredCase]) -> Vec<ClassScores> {
    study(&cases.iter().map(Judgment::of).collect::<Vec<_>>())
}

#[test]
fn recall_and_precision_go_by_class_and_size() {
    let hidden = [("coulomb_friction", 60.0), ("gravity", 12.0), ("quadratic_drag", 2.0)];
    let found = scores(&[composite(&hidden, None, &["hysteresis", "backlash"])]);
    let [group] = found.as_slice() else { panic!("{found:?}") };
    let recall: Vec<(u64, u64)> = group.recall.iter().map(|row| (row.named.count, row.named.of)).collect();
    assert_eq!(recall, [(0, 1), (0, 0), (0, 1), (1, 1)]);
    assert_eq!((group.precision.count, group.precision.of), (1, 2));
    assert_eq!((group.leading_named.count, group.leading_sure.count, group.set.count), (1, 1, 0));
    let friction = group.classes.iter().find(|row| row.id == "friction").unwrap();
    assert_eq!((friction.recall.count, friction.stated_where_it_acts), (1, 0.95));
    // By effect, it is another effect.
    let coulomb = group.effects.iter().find(|row| row.id == "coulomb_friction").unwrap();
    assert_eq!((coulomb.recall.count, coulomb.stated_where_it_acts), (0, 0.0));
}

#[test]
fn a_class_of_an_unlisted_law_counts_neither_way() {
    let hidden = [("gravity", 60.0), ("backlash", 12.0)];
    let case = composite(&hidden, Some("damping"), &["gravity", "backlash", "quadratic_drag"]);
    let judged = [Judgment::of(&case)];
    let found = study(&judged);
    assert_eq!((found[0].precision.count, found[0].precision.of, found[0].set.count), (3, 3, 1));
    assert!(found[0].classes.iter().all(|row| row.id != "damping"));
    let stated = statements(judged.iter());
    assert_eq!(stated, [vec![(0.95, true), (0.95, true)]]);
}

#[test]
fn shares_of_the_gap_go_to_what_acts() {
    let mut case = composite(&[("gravity", 60.0)], None, &["gravity", "end_stop"]);
    let shares = [0.6, 0.2];
    for (row, share) in case.answer.as_mut().unwrap().effects.iter_mut().zip(shares) {
        row.gap_share = Some(WithInterval { value: share, interval_95: [0.0, 1.0] });
    }
    assert!((scores(&[case])[0].attributed.median.value - 0.75).abs() < 1e-12);
}

#[test]
fn a_class_that_the_truth_allows_is_no_mistake_for_a_law_alone() {
    let of = |status: &str, named: &[&str]| {
        let mut case = case(Bank::Rigs, &[], answered(status, named, 0.9));
        case.hidden.foreign = Some(Foreign { law: "rough_bearing".to_owned(), detectability: 900.0 });
        case.hidden.allowed = vec!["friction".to_owned()];
        Judgment::of(&case).right
    };
    assert!(of("unknown", &[]) && of("effect", &["coulomb_friction"]));
    assert!(!of("effect", &["coulomb_friction", "gravity"]) && !of("none", &[]));
}

#[test]
fn a_small_unlisted_law_alone_asks_for_no_name() {
    let of = |status: &str, named: &[&str]| {
        let mut case = composite(&[], None, named);
        case.hidden.bank = Bank::Rigs;
        case.answer = answered(status, named, 0.9);
        Judgment::of(&case).right
    };
    assert!(of("unknown", &[]) && of("calibration", &[]) && of("none", &[]));
    assert!(!of("effect", &["gravity"]));
}
