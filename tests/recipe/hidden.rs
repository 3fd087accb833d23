//! Trials of the new effect: it takes its turn among those that are hidden, as large as asked for.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests")]

use settings::Document;
use trials::{Bank, TrialPlan};

#[test]
fn sine_drag_takes_its_turn_among_hidden_effects() {
    let effects = dynamics::REGISTRY.len();
    assert_eq!(TrialPlan::variety(Bank::Single), effects);
    let text = format!("[trials]\nsingle = {effects}\ndetectabilities = [25.0]\n[record]\nseconds = 10.0");
    let plan = TrialPlan::resolve(&Document::parse("test.toml", &text).unwrap()).unwrap();
    let cases = (0..plan.len()).map(|index| plan.case(index).unwrap());
    let hidden: Vec<_> = cases.map(|case| case.hidden).filter(|hidden| hidden.effects[0].id == "sine_drag").collect();
    assert_eq!(hidden.len(), 1);
    let effect = &hidden[0].effects[0];
    assert!((effect.detectability / 25.0 - 1.0).abs() < 0.02 && effect.parameters[0] > 0.0, "{effect:?}");
    assert_eq!(hidden[0].records[0].system.effects()[0].id(), "sine_drag");
}
