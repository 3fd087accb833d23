//! Tests of the page of trials.

use serde_json::{Value, json};

use crate::{RunTexts, render, render_diagnosis};

fn share(count: u64, of: u64) -> Value {
    json!({ "count": count, "of": of, "share": count as f64 / of as f64, "interval_95": [0.1, 0.9] })
}

fn bar(metric: &str, state: &str, beyond: bool, value: Value) -> Value {
    json!({ "metric": metric, "at_least": 0.95, "at_most": null, "unit": "%", "value": value,
            "interval_95": [0.5, 0.99], "cases": 10, "state": state, "missed_beyond_chance": beyond })
}

/// Returns small made-up trials.
fn small() -> Value {
    let nothing = json!({ "count": 0, "of": 0, "share": null, "interval_95": [0.0, 1.0] });
    let size = |effect: &str, size: f64, right: u64| {
        json!({ "bank": "single", "effect": effect, "size": size, "range": [17.0, null],
                "top_1": share(right, 4), "class": share(4, 4), "both": nothing })
    };
    let quantiles = json!({ "count": 3, "median": { "value": 1.02, "interval_95": [null, null] },
                            "quantile_95": 1.3, "worst": 1.4 });
    json!({
        "schema": "ringdown.trials/1", "task": "trials", "name": "small", "seed": 1, "cases": 10, "unanswered": 1,
        "left_out": [{ "bank": "engine", "reason": "the folder <b>engine</b> is empty" }],
        "right_means": "Exactly the hidden set.",
        "bars": [bar("first", "met", false, json!(0.97)), bar("second", "not met", true, json!(0.5)),
                 bar("third", "not measured here", false, Value::Null)],
        "banks": [{ "bank": "single", "right": share(7, 8), "top_1": share(7, 8), "class": share(8, 8),
                    "both": nothing, "either": nothing, "false_alarms": nothing }],
        "effects": [size("gravity", 12.0, 1), size("gravity", 25.0, 3), size("backlash", 25.0, 4)],
        "sizes": [size("", 12.0, 1), size("", 25.0, 7)],
        "confusion": { "hidden": ["gravity"], "said": ["gravity", "backlash"], "counts": [[4, 0]] },
        "kinds": { "hidden": ["structure"], "said": ["structure"], "counts": [[8]] },
        "reliability": [{ "subject": "confidence", "banks": "own", "count": 8,
                          "calibration_error": { "value": 0.1, "interval_95": [0.05, 0.2] },
                          "calibration_error_by_chance": 0.08, "brier": 0.1,
                          "bins": [{ "range": [0.2, 0.5], "stated": 0.4, "found": share(2, 4) },
                                   { "range": [0.5, 0.9], "stated": 0.8, "found": share(4, 4) }] }],
        "map": { "method": "isotonic", "knots": [[0.4, 0.5], [0.8, 1.0]], "fitted_to": 30 },
        "unknown": { "areas": [{ "size": null, "positives": 2, "negatives": 8,
                                 "area": { "value": 0.9, "interval_95": [0.6, 0.99] } }],
                     "curve": [[0.0, 0.0], [0.1, 0.8], [1.0, 1.0]] },
        "ratio_to_floor": quantiles,
        "closure": { "means": "1 less m²/m₀²", "coverage": share(5, 6), "below": 1, "above": 0,
                     "left_out": { "no answer": 1 } },
        "seconds_per_case": quantiles,
        "nuisances": [{ "id": "timestamp_batching", "named": share(2, 3) }],
        "baselines": [{ "id": "most-common", "method": "always the same", "top_1": share(2, 8),
                        "diagnosis": share(7, 8), "false_alarms": share(2, 2), "sizes": [] }],
        "failures": [{ "id": "000003", "bank": "single", "hidden": "gravity", "said": "backlash", "size": 25.0,
                       "same_class": true, "command": "trainer diagnose <x>" }],
        "seconds": 12.5
    })
}

fn texts(result: &str) -> RunTexts<'_> {
    RunTexts {
        name: "a run",
        config: "",
        result,
        trace: "",
        envelope: "",
        predictions: "",
        series: "",
        environment: "",
        reader: crate::Reader::CommandLine,
    }
}

#[test]
fn bars_come_first_and_their_states_are_told_apart() {
    let result = small().to_string();
    let page = crate::glossary::unexplained(&render(&texts(&result)).unwrap()).replace('\u{a0}', " ");
    assert!(page.contains("Of 3 bars 1 are met, 1 are not (of these 1 with the whole 95 % interval), 1 are"));
    assert!(page.contains("Some bars missed beyond chance"));
    assert!(page.contains("1 of 10 cases have no answer"));
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text}"));
    assert!(
        place("id=\"bars\"") < place("id=\"accuracy\"")
            && place("id=\"accuracy\"") < place("id=\"failures\"")
    );
    assert!(page.contains("backlash (said to be indistinguishable)"));
    assert!(page.contains("75.0 %") && page.contains("3/4 [10.0, 90.0]"));
    assert!(page.contains("timestamp_batching in 2 of 3") && page.contains("0.400 → 0.500"));
    assert!(page.contains("id=\"reliability\"") && page.contains("id=\"unknown-curve\""));
}

#[test]
fn what_comes_from_files_is_escaped_and_the_same_again() {
    let result = small().to_string();
    let page = render(&texts(&result)).unwrap();
    assert!(page.contains("engine: the folder &#60;b&#62;engine") && !page.contains("<b>engine"));
    assert!(page.contains("trainer diagnose &#60;x&#62;"));
    assert_eq!(render(&texts(&result)).unwrap(), page);
    let text = crate::scripts::stripped(&page);
    assert!(!text.contains("NaN") && !text.contains("not finite"));
}

#[test]
fn trials_are_no_diagnosis() {
    let result = small().to_string();
    let error = render_diagnosis(&texts(&result)).unwrap_err().to_string();
    assert!(error.contains("\"diagnose\", the file says \"trials\""), "{error}");
}

#[test]
fn several_effects_at_once_have_a_section_of_their_own() {
    let quantiles = json!({ "count": 1, "median": { "value": 0.7512, "interval_95": [null, null] },
                            "quantile_95": 0.8, "worst": 0.8 });
    let row = json!({ "id": "friction", "recall": share(3, 4), "precision": share(3, 5),
                      "stated_where_it_acts": 0.62, "stated_where_it_does_not": null });
    let mut result = small();
    let without = render(&texts(&result.to_string())).unwrap();
    assert!(!without.contains("id=\"classes\""));
    result["inclusion"] = json!([{
        "banks": "rigs, composite", "cases": 8, "leading_named": share(7, 8), "leading_sure": share(1, 8),
        "set": share(2, 8), "recall": [{ "floors": [10.0, null], "named": share(5, 7) }],
        "precision": share(9, 12), "attributed": quantiles, "unknown": share(0, 0), "false_alarms": share(0, 0),
        "classes": [row], "effects": []
    }]);
    result["gate"] = json!([bar("gate: leading class named", "not met", true, json!(0.4))]);
    let page = render(&texts(&result.to_string())).unwrap();
    for words in [
        "rigs, composite",
        "class named, effects of 10 and more",
        "0.75",
        "friction",
        "0.62",
        "gate: leading class named",
    ] {
        assert!(page.contains(words), "{words}");
    }
}
