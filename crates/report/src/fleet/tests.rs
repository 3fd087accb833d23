//! Tests with a small fleet of two robots, and with a fleet whose names hold everything that a page has to
//! escape.

use crate::{RunTexts, render};
use serde_json::{Value, json};

fn small() -> Value {
    let case = |id: &str, robot: &str, status: &str, friction: f64| {
        json!({"id": id, "labels": {"robot": robot}, "origin": "simulated", "status": status,
            "classes": {"friction": friction, "drift": 0.02}, "summary": "",
            "numbers": {"error over noise": {"value": 1.25, "unit": ""}, "closure": {"value": 0.97, "unit": ""}}})
    };
    json!({"schema": "ringdown.fleet/1", "task": "fleet", "labels": ["robot"],
        "classes": [{"id": "friction", "likely": 2, "certain": 1, "gap_share": 0.6},
                    {"id": "drift", "likely": 0, "certain": 0, "gap_share": null}],
        "groups": [{"label": "robot", "value": "r7", "cases": 2, "likely": {"friction": 2}},
                   {"label": "robot", "value": "r8", "cases": 1, "likely": {}}],
        "outliers": [{"case": "b", "name": "coulomb_friction.torque", "unit": "N m", "value": 0.5, "median": 0.1, "of": 12,
                      "score": 9.7}],
        "cases": [case("a", "r7", "effect", 0.99), case("b", "r7", "effect", 0.6), case("c", "r8", "none", 0.01)],
        "failed": [{"id": "d", "message": "record-000.csv:3: `x` is not a number"}]})
}

fn page(result: &Value) -> String {
    render(&RunTexts { name: "a fleet", result: &result.to_string(), ..RunTexts::default() }).unwrap()
}

#[test]
fn it_says_which_effects_where_and_what_is_odd() {
    let html = crate::glossary::unexplained(&page(&small()));
    for part in [
        "Of 3 diagnoses, 2 name effects, 0 find only wrong coefficients, 1 find nothing beyond the noise",
        "Most often: dry friction in 2.",
        "One case gave no answer",
        "<th scope=\"row\" class=\"words\">Dry friction</th><td>2</td><td>1</td>",
        "<th scope=\"row\" class=\"words\">robot</th><td class=\"words\">r7</td><td>2</td><td>2</td>",
        "coulomb friction torque",
        "<a href=\"a/diagnosis.json\">a</a>",
        "record-000.csv:3:",
    ] {
        assert!(html.contains(part), "{part}\n{html}");
    }
    // A class that no case has gets no row, and every long table can be filtered.
    assert!(!html.contains("drift"));
    assert_eq!(html.matches("<table class=\"rows methods filtered\">").count(), 4);
}

#[test]
fn names_from_folders_cannot_act() {
    let mut result = small();
    result["cases"][0]["id"] = json!("javascript:<script>alert(1)</script>");
    result["failed"][0]["message"] = json!("<script>alert(2)</script>");
    let html = page(&result);
    assert!(!crate::scripts::stripped(&html).contains("<script"));
    assert!(html.contains("href=\"javascript%3A%3Cscript%3E"));
}

#[test]
fn a_thousand_cases_are_one_page() {
    let mut result = small();
    let one = result["cases"][0].clone();
    let named = |number: usize| {
        let mut case = one.clone();
        case["id"] = json!(format!("case-{number:04}"));
        case
    };
    result["cases"] = (0..1000).map(named).collect();
    let html = page(&result);
    assert_eq!(html.matches("/diagnosis.json\">case-").count(), 1000);
    assert!(html.len() < 1_500_000, "{}", html.len());
}
