//! Tests of the requests, and of the page's files against the crates that they repeat.

use crate::{Dropped, Host};
use report::plot::Hue;
use serde_json::{Value, json};
use std::cell::RefCell;

const PAGE: &str = include_str!("../../../web/index.html");
const STYLE: &str = include_str!("../../../web/style.css");

#[derive(Default)]
struct Nobody {
    stages: RefCell<Vec<String>>,
}

impl Host for Nobody {
    fn seconds(&self) -> f64 {
        0.0
    }

    fn stage(&self, text: &str) {
        self.stages.borrow_mut().push(text.to_owned());
    }
}

fn ask(dropped: &mut Dropped, request: &Value) -> Value {
    let answer = dropped.ask(request.to_string().as_bytes(), &Nobody::default());
    serde_json::from_str(&answer).unwrap()
}

/// The report is shown inside the page, whose policy has to admit the report's scripts by their digests.
#[test]
fn the_policy_of_the_page_admits_the_scripts_of_reports_and_no_others() {
    let scripts = report::script_policy();
    assert!(PAGE.contains(&format!("script-src 'self' 'wasm-unsafe-eval' {scripts};")), "expected {scripts}");
    assert!(PAGE.contains("default-src 'none'") && !PAGE.contains("://"));
}

#[test]
fn the_plots_follow_the_color_scheme() {
    for hue in [Hue::Ink, Hue::Axis, Hue::Grid, Hue::Shade, Hue::Data, Hue::Second, Hue::Oracle] {
        let (light, dark) = (hue.light(), hue.dark());
        let rules = [
            format!("svg [fill=\"{light}\"], svg[fill=\"{light}\"] {{ fill: light-dark({light}, {dark}); }}"),
            format!("svg [stroke=\"{light}\"] {{ stroke: light-dark({light}, {dark}); }}"),
        ];
        rules.iter().for_each(|rule| assert!(STYLE.contains(rule), "expected {rule}"));
    }
}

#[test]
fn every_example_is_a_log_that_can_be_diagnosed() {
    let mut dropped = Dropped::default();
    let offer = ask(&mut dropped, &json!({ "do": "offer" }));
    let effects: Vec<&str> =
        offer["examples"].as_array().unwrap().iter().map(|example| example["id"].as_str().unwrap()).collect();
    assert!(effects.len() >= 15, "{effects:?}");
    for effect in [&["shipped", "none"], &effects[..]].concat() {
        let made = ask(&mut dropped, &json!({ "do": "simulate", "effect": effect, "size": 1.0 }));
        let record = made["record"].as_str().unwrap_or_else(|| panic!("{effect}: {made}"));
        ask(&mut dropped, &json!({ "do": "clear" }));
        dropped.add("record.csv".to_owned(), record.as_bytes().to_vec());
        let found = ask(&mut dropped, &json!({ "do": "look", "reading": {} }));
        assert_eq!(found["logs"][0]["diagnosable"], true, "{effect}: {found}");
        assert!(workflow::nominal::parse("nominal.toml", made["nominal"].as_str().unwrap()).is_ok());
    }
}

#[test]
fn a_log_is_read_by_the_options_of_the_form() {
    let text = "a;b;c\n".to_owned()
        + &(0..600)
            .map(|at| {
                let time = f64::from(at) * 10.0;
                format!("{time};{};{}\n", 40.0 * (-2e-4 * time).exp() * (0.02 * time).cos(), at % 7)
            })
            .collect::<String>();
    let mut dropped = Dropped::default();
    dropped.add("log.csv".to_owned(), text.into_bytes());
    let reading = json!({ "time": "a", "time_unit": "ms", "value": "b", "unit": "deg" });
    let found = ask(&mut dropped, &json!({ "do": "look", "reading": reading }));
    let frequency =
        found.pointer("/logs/0/found/oscillator/natural_frequency_hz/value").and_then(Value::as_f64);
    assert!((frequency.unwrap() - 20.0 / std::f64::consts::TAU).abs() < 0.01, "{found}");
    let refused = ask(&mut dropped, &json!({ "do": "look", "reading": { "unit": "furlong" } }));
    assert!(refused["error"].as_str().unwrap().contains("furlong"), "{refused}");
    let estimated = ask(&mut dropped, &json!({ "do": "estimate", "reading": reading }));
    let methods = estimated.pointer("/logs/0/methods").and_then(Value::as_array).unwrap();
    for id in ["ols", "sindy", "weak-sindy", "envelope-matching"] {
        let method = methods.iter().find(|method| method["id"] == id).unwrap();
        assert!((method["zeta"].as_f64().unwrap() - 0.01).abs() < 1e-3, "{method}");
    }
    // The plot has the log's unit.
    assert!(found["logs"][0]["pictures"][0]["wide"].as_str().unwrap().contains("angle (deg)"));
}

#[test]
fn a_diagnosis_tells_its_stages_and_has_the_program_s_files() {
    let mut dropped = Dropped::default();
    let made = ask(&mut dropped, &json!({ "do": "simulate", "effect": "coulomb_friction", "size": 1.0 }));
    dropped.add("record.csv".to_owned(), made["record"].as_str().unwrap().as_bytes().to_vec());
    let request = json!({
        "do": "diagnose", "reading": {}, "nominal_name": "nominal.toml", "nominal": made["nominal"], "name": "record.csv",
    });
    let host = Nobody::default();
    let answer: Value = serde_json::from_str(&dropped.ask(request.to_string().as_bytes(), &host)).unwrap();
    assert!(answer["summary"].as_str().unwrap().contains("dry friction"), "{answer}");
    let names: Vec<&str> =
        answer["files"].as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect();
    for name in
        ["diagnosis.json", "report.html", "repaired.toml", "repaired.py", "nominal.toml", "series.csv"]
    {
        assert!(names.contains(&name), "{name} of {names:?}");
    }
    assert_eq!(host.stages.borrow().first().map(String::as_str), Some("measuring the record"));
    assert!(host.stages.borrow().len() >= 5, "{:?}", host.stages);
}

#[test]
fn logs_of_two_systems_are_told_apart_and_those_of_one_are_not() {
    let log = |frequency: f64| -> String {
        let line = |at: usize| {
            let time = 0.01 * at as f64;
            format!(
                "{time:.2},{}\n",
                0.3 * (-0.1 * time).exp() * (std::f64::consts::TAU * frequency * time).cos()
            )
        };
        format!("time_s,angle_rad\n{}", (0..2000).map(line).collect::<String>())
    };
    let mut dropped = Dropped::default();
    for (name, frequency) in [("a.csv", 2.0), ("b.csv", 2.1), ("c.csv", 5.0)] {
        dropped.add(name.to_owned(), log(frequency).into_bytes());
    }
    let found = ask(&mut dropped, &json!({ "do": "look", "reading": {} }));
    let apart = |at: usize| found["logs"][at]["apart"].as_str().unwrap_or_default();
    let told: Vec<bool> = (0..3).map(|at| apart(at).contains(" Hz: do they come from one system?")).collect();
    assert!(told == [false, false, true] || told == [true, true, false], "{found}");
}

#[test]
fn messages_name_the_fields_of_the_page() {
    let mut dropped = Dropped::default();
    dropped.add("log.csv".to_owned(), b"time_s,angle_rad\n0,1\n0.1,x\n0.2,3\n".to_vec());
    let found = ask(&mut dropped, &json!({ "do": "look", "reading": {} }));
    let error = found["logs"][0]["error"].as_str().unwrap();
    assert!(!error.contains(" --"), "{error}");
}
