//! Tests that `trainer schema`, used by editors to check configurations, agrees with the program.

use crate::json_schema::errors;
use crate::support::{root, trainer};
use serde_json::Value;
use std::path::PathBuf;

fn schema(purpose: &[&str]) -> Value {
    let output = trainer(&[&["schema"], purpose].concat());
    assert_eq!(output.status.code(), Some(0));
    let schema: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    schema
}

fn is_valid(schema: &Value, value: &Value) -> bool {
    errors(schema, value).is_empty()
}

fn value(text: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Value>(text).unwrap()).unwrap()
}

fn configurations() -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> =
        std::fs::read_dir(root().join("configs")).unwrap().map(|entry| entry.unwrap().path()).collect();
    found.retain(|path| path.is_file());
    found.sort();
    assert!(found.len() > 20);
    found
}

#[test]
fn every_shipped_configuration_is_valid_and_a_slip_in_any_key_is_not() {
    let schema = schema(&[]);
    for path in configurations() {
        let text = std::fs::read_to_string(&path).unwrap();
        let config = value(&text);
        let found = errors(&schema, &config);
        assert!(found.is_empty(), "{}: {found:?}", path.display());
        for key in keys(&config) {
            let wrong = misspelled(&config, &key);
            assert!(!is_valid(&schema, &wrong), "{}: {} misspelled is valid", path.display(), key.join("."));
        }
    }
}

/// Returns the path to every key of a value, except for tables that the configuration names itself, which
/// have no wrong name.
fn keys(value: &Value) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let children: Vec<(String, &Value)> = match value {
        Value::Object(table) => table.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(entries) => {
            entries.iter().enumerate().map(|(i, value)| (i.to_string(), value)).collect()
        }
        _ => Vec::new(),
    };
    for (key, below) in children {
        if value.is_object() {
            found.push(vec![key.clone()]);
        }
        found.extend(keys(below).into_iter().map(|rest| [vec![key.clone()], rest].concat()));
    }
    let is_named = |way: &[String]| match way {
        [problem, _] => problem == "problem",
        [problem, _, part, _] => problem == "problem" && part == "part",
        _ => false,
    };
    found.retain(|way| !is_named(way));
    found
}

fn misspelled(value: &Value, way: &[String]) -> Value {
    let mut wrong = value.clone();
    let (last, before) = way.split_last().unwrap();
    let place = before.iter().fold(&mut wrong, |place, key| match place {
        Value::Array(entries) => &mut entries[key.parse::<usize>().unwrap()],
        other => &mut other[key.as_str()],
    });
    let table = place.as_object_mut().unwrap();
    let kept = table.remove(last).unwrap();
    table.insert(format!("{last}x"), kept);
    wrong
}

#[test]
fn values_that_the_program_refuses_are_invalid() {
    let schema = schema(&["estimate"]);
    let valid = |text: &str| is_valid(&schema, &value(text));
    assert!(valid("[estimator]\nname = \"pinn\"\nhidden = [8]\n"));
    assert!(valid("base = \"rig.toml\"\n[fit]\nseeds = 3\n"));
    for wrong in [
        "[fit]\nseeds = 3\n",
        "[estimator]\nname = \"pin\"\n",
        "[estimator]\nname = \"pinn\"\nhidden = []\n",
        "[estimator]\nname = \"pinn\"\nhidden = [0]\n",
        "[estimator]\nname = \"ols\"\nhidden = [8]\n",
        "[estimator]\nname = \"sindy\"\nphysics_weight = 1.0\n",
        "[estimator]\nname = \"pinn\"\nphysics_weight = \"much\"\n",
        "seed = -1\n[estimator]\nname = \"pinn\"\n",
        "[data]\nclock = \"sun\"\n[estimator]\nname = \"pinn\"\n",
    ] {
        assert!(!valid(wrong), "{wrong}");
    }
}

#[test]
fn a_simulation_may_draw_its_numbers_and_names_parameters_by_effect() {
    let schema = schema(&["simulate"]);
    let text = |nominal: &str, effect: &str| {
        format!("{nominal}\nstart = {{ position = 0.5 }}\n[[effects]]\nid = \"coulomb_friction\"\n{effect}\n")
    };
    let nominal = "nominal = { inertia = 1, damping = { from = 0.1, to = 0.2 }, stiffness = 400 }";
    let valid = |nominal: &str, effect: &str| is_valid(&schema, &value(&text(nominal, effect)));
    assert!(valid(nominal, "parameters.torque = 1e-5"));
    assert!(valid("inertia = 1\ndamping = 0.1\nstiffness = 400", "parameters.torque = 1e-5"));
    assert!(valid(nominal, "parameters.torque = { mean = 1e-5, deviation = 1e-6 }"));
    assert!(!valid(nominal, "parameters.torqe = 1e-5"));
    assert!(!valid(nominal, "parameters.coefficient = 1e-5"));
    assert!(!valid(nominal, ""));
    assert!(!valid("nominal = { inertia = 0, damping = 0.1, stiffness = 400 }", "parameters.torque = 1e-5"));
    assert!(!valid("nominal = { inertia = 1, stiffness = 400 }", "parameters.torque = 1e-5"));
    assert!(!valid("damping = 0.1", "parameters.torque = 1e-5"));
}

#[test]
fn the_nominal_simulator_of_a_diagnosis_has_a_schema() {
    let schema = schema(&["nominal"]);
    let text = std::fs::read_to_string(root().join("experiments/default-record/nominal.toml")).unwrap();
    let shipped = value(&text);
    assert!(is_valid(&schema, &shipped));
    for key in keys(&shipped) {
        assert!(!is_valid(&schema, &misspelled(&shipped, &key)), "{key:?}");
    }
    let valid = |text: &str| is_valid(&schema, &value(text));
    let effect = "[[effects]]\nid = \"coulomb_friction\"\nrecalibrate = false\nparameters.torque = 1e-5\n";
    assert!(valid(&format!("natural_frequency = 3.5\ndamping_ratio = 0.01\n{effect}")));
    assert!(valid(&format!("[start]\nposition = 0.7\n[nominal]\nperiod = 2\ndamping = 0.1\n{effect}")));
    assert!(!valid("natural_frequency = 3.5\nperiod = 2\ndamping_ratio = 0.01\n"));
    assert!(!valid("natural_frequency = 3.5\n"));
    assert!(!valid("stiffness = 8\ndamping = 0.1\n"));
    assert!(!valid(&format!("period = 2\ndamping = 0.1\n{}", effect.replace("torque", "torqe"))));
}

/// Each default of the schema is the value that the program uses if a file does not set the key.
#[test]
fn defaults_of_the_schema_are_those_in_force() {
    let output = trainer(&["schema", "estimate"]);
    let schema: Value = serde_json::from_slice(&output.stdout).unwrap();
    let explained = trainer(&["explain", "configs/ols.toml", "--json"]);
    let explained: Value = serde_json::from_slice(&explained.stdout).unwrap();
    let mut compared = 0;
    for setting in explained["settings"].as_array().unwrap() {
        let key = setting["key"].as_str().unwrap();
        let pointer = format!("/properties/{}", key.replace('.', "/properties/"));
        let declared = schema.pointer(&pointer).unwrap_or_else(|| panic!("{key} has no schema"));
        if key != "task" {
            assert_eq!(declared["default"], setting["default"], "{key}");
            compared += 1;
        }
    }
    assert!(compared > 20);
}
