//! Tests of the page of several rigs.

use serde_json::{Value, json};

use crate::{RunTexts, render};

fn small() -> Value {
    let rig = |name: &str, friction: f64| {
        json!({ "name": name, "folder": format!("build/{name}"), "origin": "simulated", "status": "effect",
                "summary": "The simulator certainly lacks dry friction (Coulomb).", "nameless_share": 0.25,
                "classes": [{ "id": "friction", "probability": friction }] })
    };
    let value = |rig: &str, value: f64| json!({ "rig": rig, "value": value, "interval_95": [value - 0.02, value + 0.02], "unit": "N m" });
    let torque = |agree: bool| {
        json!({ "effect": "coulomb_friction", "title": "Coulomb friction", "parameter": "torque", "unit": "N m",
                "values": [value("A", 2.0), value("B", 2.01)], "agree": agree, "chi_squared": 0.5, "degrees": 1,
                "mean": null, "farthest": { "rigs": ["A", "B"], "standard_errors": 0.7 } })
    };
    json!({
        "schema": "ringdown.rigs/1", "rigs": [rig("A", 0.99), rig("B", 0.95)],
        "classes": [{ "id": "friction", "probability": 0.999, "present_in": ["A", "B"],
                      "coefficients": [torque(true), torque(false)] }],
        "sentences": ["Dry friction: in all two."], "failed": [], "complete": true, "seconds": 1.0
    })
}

fn page(result: &Value) -> String {
    let texts = RunTexts { name: "a build", result: &result.to_string(), ..RunTexts::default() };
    crate::glossary::unexplained(&render(&texts).unwrap())
}

#[test]
fn agreement_and_difference_are_told_in_words_and_by_rig() {
    let html = page(&small());
    for part in [
        "certain: dry friction",
        "Of 2 coefficients that can be compared, 1 differs between the rigs.",
        "the same within errors",
        "not the same",
        "A and B: 0.70 standard errors",
        "href=\"A/report.html\"",
        "Simulated",
        "25.0\u{a0}%",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn rigs_that_failed_or_were_left_are_told() {
    let mut result = small();
    result["failed"] = json!([{ "id": "C", "message": "C/nominal.toml: cannot be used" }]);
    result["complete"] = json!(false);
    result["rigs"][1]["origin"] = json!("measured");
    let html = page(&result);
    for part in
        ["as far as they answered", "C/nominal.toml: cannot be used", "It was interrupted", "several origins"]
    {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn names_of_rigs_are_text_and_no_addresses_of_elsewhere() {
    let mut result = small();
    let evil = "javascript:<script>alert(1)</script>";
    result["rigs"][0]["name"] = json!(evil);
    let texts = RunTexts { name: "a build", result: &result.to_string(), ..RunTexts::default() };
    let html = render(&texts).unwrap();
    assert!(!crate::scripts::stripped(&html).contains("<script"));
    assert!(html.contains("href=\"javascript%3A%3Cscript%3E"));
}
