//! `trainer schema`: JSON Schema of configurations, for editors.

use crate::error::TrainerError;
use crate::outcome::Outcome;
use crate::terminal::console;
use ::learn::learners::LEARNERS;
use clap::ValueEnum;
use experiment::{
    ACTUATOR, ACTUATOR_STATED, KNOWN_EFFECT, NOMINAL, NOMINAL_DECAYS, NOMINAL_SWINGS, compare_schema,
    estimate_schema, learn_schema, predict_schema,
};
use oracle::classical::CLASSICAL;
use registry::ESTIMATORS;
use serde_json::{Value, json};
use settings::json_schema;
use simulator::simulate_schema;
use trials::trials_schema;

/// Purpose of a configuration file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Purpose {
    /// One estimator on one record
    Estimate,
    /// Many methods on one record
    Compare,
    /// Dynamics learned from records
    Learn,
    /// Methods scored on held-out peaks
    Predict,
    /// Records of systems drawn from priors
    Simulate,
    /// Withheld-effect trials
    Trials,
    /// The nominal simulator of a diagnosis
    Nominal,
}

/// Purposes that a file names as its task.
const TASKS: [Purpose; 6] = [
    Purpose::Estimate,
    Purpose::Compare,
    Purpose::Learn,
    Purpose::Predict,
    Purpose::Simulate,
    Purpose::Trials,
];

impl Purpose {
    fn name(self) -> &'static str {
        match self {
            Self::Estimate => "estimate",
            Self::Compare => "compare",
            Self::Learn => "learn",
            Self::Predict => "predict",
            Self::Simulate => "simulate",
            Self::Trials => "trials",
            Self::Nominal => "nominal",
        }
    }

    fn schema(self) -> Value {
        let classical: Vec<&str> = CLASSICAL.iter().map(|route| route.id).collect();
        match self {
            Self::Estimate => estimate_schema(ESTIMATORS, &classical),
            Self::Compare => compare_schema(ESTIMATORS, &classical),
            Self::Learn => learn_schema(LEARNERS),
            Self::Predict => predict_schema(ESTIMATORS, &classical),
            Self::Simulate => simulate_schema(),
            Self::Trials => trials_schema(),
            Self::Nominal => nominal_schema(),
        }
    }
}

/// Builds the schema of a nominal simulator: the oscillator at the top or in a table, the effects of a
/// simulation with their key, and the other keys of a simulation's configuration, so that a repaired
/// simulator is valid as a nominal one.
fn nominal_schema() -> Value {
    let simulation = simulate_schema();
    let mut root = json_schema::tables(&[NOMINAL]);
    json_schema::insert(&mut root, "", "nominal", json_schema::table(NOMINAL.fields));
    json_schema::insert(&mut root, "", "actuator", actuator_schema());
    let properties = simulation.get("properties").and_then(Value::as_object).into_iter().flatten();
    for (name, schema) in properties {
        let is_own = root.pointer(&format!("/properties/{name}")).is_some();
        if !is_own && name != "base" {
            json_schema::insert(&mut root, "", name, schema.clone());
        }
    }
    for table in ["anyOf/0/items", "anyOf/1/additionalProperties"] {
        if let Some(effect) = root.pointer_mut(&format!("/properties/effects/{table}")) {
            for field in KNOWN_EFFECT.fields.iter().filter(|field| field.key == "recalibrate") {
                json_schema::insert(effect, "", field.key, json_schema::field(field));
            }
        }
    }
    let one_of = |keys: &[&str]| -> Value { keys.iter().map(|key| json!({ "required": [key] })).collect() };
    let stated = json!({
        "allOf": [
            { "oneOf": one_of(&NOMINAL_SWINGS) },
            { "oneOf": one_of(&NOMINAL_DECAYS) },
            { "if": { "required": ["stiffness"] }, "then": { "required": ["inertia"] } },
        ],
    });
    if let Some(root) = root.as_object_mut() {
        let servo = json!({ "required": ["inertia", "actuator"] });
        root.insert("anyOf".to_owned(), json!([{ "required": ["nominal"] }, servo, stated]));
    }
    if let Some(table) = root.pointer_mut("/properties/nominal").and_then(Value::as_object_mut) {
        table.extend(stated.as_object().cloned().unwrap_or_default());
    }
    root
}

/// Builds the schema of an inner loop: some of its numbers may be known within a tolerance, or unknown.
fn actuator_schema() -> Value {
    let mut table = json_schema::table(ACTUATOR.fields);
    let tolerant = json!({
        "type": "object",
        "properties": { "value": { "type": "number" }, "tolerance": { "type": "number", "exclusiveMinimum": 0 } },
        "required": ["value", "tolerance"],
        "additionalProperties": false,
    });
    for key in ACTUATOR_STATED {
        if let Some(own) = table.pointer_mut(&format!("/properties/{key}")) {
            *own = json!({ "anyOf": [own.take(), { "const": "unknown" }, tolerant] });
        }
    }
    table
}

/// Prints the schema of one task, or that of all tasks, which depends on the file's `task`.
pub(crate) fn command(purpose: Option<Purpose>) -> Result<Outcome, TrainerError> {
    let (title, schema) = match purpose {
        Some(purpose) => (format!("Ringdown: {}", purpose.name()), purpose.schema()),
        None => ("Ringdown".to_owned(), of_all_tasks()),
    };
    let mut whole = serde_json::Map::new();
    whole.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    whole.insert("title".to_owned(), json!(title));
    if let Value::Object(schema) = schema {
        whole.extend(schema);
    }
    let text = serde_json::to_string_pretty(&whole)
        .map_err(|error| TrainerError::System { what: "the schema", problem: error.to_string() })?;
    console::result(&text);
    Ok(Outcome::Done)
}

/// Combines the schemas of all tasks by the `task` that a file names. A file without a task or a base is an
/// estimation.
fn of_all_tasks() -> Value {
    let names: Vec<&str> = TASKS.iter().map(|task| task.name()).collect();
    let definitions: serde_json::Map<String, Value> =
        TASKS.iter().map(|task| (task.name().to_owned(), task.schema())).collect();
    let reference = |name: &str| json!({ "$ref": format!("#/$defs/{name}") });
    let mut cases: Vec<Value> =
        names.iter().map(|name| json_schema::case("task", name, reference(name))).collect();
    cases.push(json!({
        "if": { "not": { "anyOf": [{ "required": ["task"] }, { "required": ["base"] }] } },
        "then": reference(Purpose::Estimate.name()),
    }));
    json!({
        "type": "object",
        "properties": { "task": { "enum": names, "description": "What to do." } },
        "allOf": cases,
        "$defs": definitions,
    })
}
