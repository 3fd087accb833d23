//! JSON Schema of a simulation's configuration.

use crate::number::NumberKey;
use crate::plan::{
    ConfiguredUnits, EFFECT_ID, HIDDEN_START, NOMINAL_CHOICES, PROBABILITY, noise_key, nominal_keys,
    parameter_keys, start_keys,
};
use crate::schema::{PRIOR, SECTIONS};
use dynamics::{REGISTRY, Range, UNNAMED};
use serde_json::{Map, Value, json};
use settings::{Default, Field, Kind, json_schema};

/// Returns the JSON Schema of `task = "simulate"`; its units are those of an angle with a known inertia.
#[must_use]
pub fn simulate_schema() -> Value {
    let units = ConfiguredUnits::of_document(&settings::Document::default(), "nominal");
    let mut root = json_schema::tables(SECTIONS);
    // The nominal oscillator has a table of its own, or is at the top.
    for table in ["nominal", ""] {
        for field in &NOMINAL_CHOICES {
            json_schema::insert(&mut root, table, field.key, json_schema::field(field));
        }
        add(&mut root, table, &nominal_keys(units));
    }
    add(&mut root, "start", &start_keys(units));
    add(&mut root, "sensor", &[noise_key(units)]);
    let effect = effect(units);
    let effects = json!({
        "description": "The effects that a system may have, each once; as a list or as numbered tables.",
        "anyOf": [
            { "type": "array", "items": effect },
            { "type": "object", "additionalProperties": effect },
        ],
    });
    json_schema::insert(&mut root, "", "effects", effects);

    let mut start = json!({});
    for key in start_keys(units).iter().filter(|key| key.default == Default::Required) {
        json_schema::require(&mut start, "start", key.key);
    }
    let needed = |table: &str| {
        let mut required = json!({});
        for key in nominal_keys(units).iter().filter(|key| key.default == Default::Required) {
            json_schema::require(&mut required, table, key.key);
        }
        required
    };
    let required = json!({
        "allOf": [start],
        "if": { "required": ["inertia"] },
        "then": needed(""),
        "else": needed("nominal"),
    });
    json_schema::with_base(root, required)
}

/// Returns the schema of a table of `[[effects]]`, whose parameters depend on its id.
fn effect(units: ConfiguredUnits) -> Value {
    let ids: Vec<&str> = REGISTRY.iter().chain(UNNAMED).map(|effect| effect.id()).collect();
    let mut table = json_schema::table(&[PROBABILITY, HIDDEN_START]);
    let id = json!({ "enum": ids, "description": json_schema::description(&EFFECT_ID) });
    json_schema::insert(&mut table, "", "id", id);
    json_schema::insert(&mut table, "", "parameters", json!({ "type": "object" }));
    let cases: Vec<Value> = REGISTRY
        .iter()
        .chain(UNNAMED)
        .map(|effect| {
            let keys = parameter_keys(effect.description(), units);
            let mut parameters = json_schema::closed(Map::new());
            add(&mut parameters, "", &keys);
            let mut then = json!({ "properties": { "parameters": parameters } });
            for key in keys.iter().filter(|key| key.default == Default::Required) {
                json_schema::require(&mut then, "parameters", key.key);
            }
            json_schema::case("id", effect.id(), then)
        })
        .collect();
    if let Some(object) = table.as_object_mut() {
        object.insert("required".to_owned(), json!(["id"]));
        object.insert("allOf".to_owned(), json!(cases));
    }
    table
}

fn add(root: &mut Value, table: &str, keys: &[NumberKey]) {
    for key in keys {
        json_schema::insert(root, table, key.key, number(key));
    }
}

/// Returns the schema of a number that may be drawn: a value, or a prior.
fn number(key: &NumberKey) -> Value {
    let fixed = Field::new(key.key, Kind::Float { min: f64::MIN, max: f64::MAX }, key.default)
        .unit(key.unit)
        .meaning(key.meaning);
    let mut value = json!({ "type": "number" });
    bound(&mut value, &key.range);
    let mut schema = json!({
        "description": json_schema::description(&fixed),
        "anyOf": [value, json_schema::table(PRIOR)],
    });
    if let (Some(object), Some(default)) = (schema.as_object_mut(), key.default.value()) {
        object.insert("default".to_owned(), json!(default));
    }
    schema
}

fn bound(value: &mut Value, range: &Range) {
    let [lower, upper] =
        if range.closed { ["minimum", "maximum"] } else { ["exclusiveMinimum", "exclusiveMaximum"] };
    let Some(object) = value.as_object_mut() else { return };
    for (word, end) in [(lower, range.minimum), (upper, range.maximum)] {
        if end.is_finite() {
            object.insert(word.to_owned(), json!(end));
        }
    }
}
