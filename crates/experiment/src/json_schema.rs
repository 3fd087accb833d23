//! JSON Schemas of experiment configurations.

use crate::prediction::{KINDS, PREDICT_SECTIONS, fields_of};
use crate::schema::{COMPARE, SECTIONS, estimator_name_field};
use estimator::Entry;
use serde_json::{Map, Value, json};
use settings::{Default, Field, json_schema};

/// Returns the JSON Schema of `task = "estimate"`, with the keys of each estimator under its name.
#[must_use]
pub fn estimate_schema(registry: &[Entry], classical: &[&str]) -> Value {
    let ids: Vec<&str> = registry.iter().map(|entry| entry.id).chain(classical.iter().copied()).collect();
    let mut name = json_schema::field(&estimator_name_field());
    put(&mut name, "enum", json!(ids));
    let mut every = Map::new();
    for field in registry.iter().flat_map(|entry| entry.fields) {
        let schema = json_schema::field(field);
        every
            .entry(field.key)
            .and_modify(|known| *known = either(known.take(), &schema))
            .or_insert_with(|| schema.clone());
    }
    every.insert("name".to_owned(), name);
    let own = |id: &str, fields: &[Field]| {
        let mut table = json_schema::table(fields);
        json_schema::insert(&mut table, "", "name", json!(true));
        json_schema::case("name", id, table)
    };
    let learned = registry.iter().map(|entry| own(entry.id, entry.fields));
    let cases: Vec<Value> = learned.chain(classical.iter().map(|id| own(id, &[]))).collect();
    let mut estimator = json_schema::closed(every);
    put(&mut estimator, "allOf", json!(cases));

    let mut root = json_schema::tables(SECTIONS);
    json_schema::insert(&mut root, "", "task", json!({ "const": "estimate" }));
    json_schema::insert(&mut root, "", "estimator", estimator);
    let mut required = json_schema::requirements(SECTIONS);
    json_schema::require(&mut required, "estimator", "name");
    json_schema::with_base(root, required)
}

/// Returns the JSON Schema of `task = "compare"`.
#[must_use]
pub fn compare_schema(registry: &[Entry], classical: &[&str]) -> Value {
    let sections: Vec<_> = SECTIONS.iter().copied().chain([COMPARE]).collect();
    let mut root = json_schema::tables(&sections);
    json_schema::insert(&mut root, "", "task", json!({ "const": "compare" }));
    name_methods(&mut root, "/properties/compare/properties/methods", registry, classical);
    json_schema::with_base(root, asking_for_task(json_schema::requirements(&sections)))
}

/// Returns the JSON Schema of `task = "predict"`, with the keys of each kind of problem under its kind.
#[must_use]
pub fn predict_schema(registry: &[Entry], classical: &[&str]) -> Value {
    let mut root = json_schema::tables(PREDICT_SECTIONS);
    json_schema::insert(&mut root, "", "task", json!({ "const": "predict" }));
    name_methods(&mut root, "/properties/predict/properties/methods", registry, classical);
    let mut problem = json_schema::table(&fields_of(None));
    let cases: Vec<Value> = KINDS
        .iter()
        .map(|kind| {
            let fields = fields_of(Some(kind));
            let mut table = json_schema::table(&fields);
            for field in fields.iter().filter(|field| field.default == Default::Required) {
                json_schema::require(&mut table, "", field.key);
            }
            json_schema::case("kind", kind, table)
        })
        .collect();
    put(&mut problem, "allOf", json!(cases));
    let problems = json!({ "type": "object", "additionalProperties": problem });
    json_schema::insert(&mut root, "", "problem", problems);
    let mut required = asking_for_task(json_schema::requirements(PREDICT_SECTIONS));
    json_schema::require(&mut required, "", "problem");
    if let Some(object) = required.as_object_mut() {
        let each = json!({ "minProperties": 1, "additionalProperties": { "required": ["kind"] } });
        put(object.entry("properties").or_insert_with(|| json!({})), "problem", each);
    }
    json_schema::with_base(root, required)
}

/// Makes the key `task` required; only the default task may omit it.
pub(crate) fn asking_for_task(mut required: Value) -> Value {
    json_schema::require(&mut required, "", "task");
    required
}

/// Restricts the names in a list of methods to the known ones.
fn name_methods(root: &mut Value, list: &str, registry: &[Entry], classical: &[&str]) {
    let ids: Vec<&str> = classical.iter().copied().chain(registry.iter().map(|entry| entry.id)).collect();
    if let Some(items) = root.pointer_mut(&format!("{list}/anyOf/0/items")) {
        put(items, "enum", json!(ids));
    }
}

/// Returns a schema that allows what either of two schemas allows, for a key that several estimators share.
fn either(known: Value, other: &Value) -> Value {
    let mut all = match known.get("anyOf").and_then(Value::as_array) {
        Some(all) => all.clone(),
        None => vec![known],
    };
    if !all.contains(other) {
        all.push(other.clone());
    }
    match all.as_slice() {
        [only] => only.clone(),
        _ => json!({ "anyOf": all }),
    }
}

pub(crate) fn put(schema: &mut Value, key: &str, value: Value) {
    if let Some(object) = schema.as_object_mut() {
        object.insert(key.to_owned(), value);
    }
}
