//! JSON Schema (draft 2020-12) of declared keys, for editors.
//!
//! Requirements are kept apart from properties, since a file with a base
//! ([`Document::on_its_bases`](crate::Document::on_its_bases)) may leave required keys to it.

use crate::document::{FROM_FILE, FROM_WORKING_DIRECTORY, PATHS};
use crate::field::{Default, Field, Kind, Section};
use serde_json::{Map, Value, json};

/// Returns the schema of a table that holds these keys and no others.
#[must_use]
pub fn table(fields: &[Field]) -> Value {
    let properties: Map<String, Value> =
        fields.iter().map(|known| (known.key.to_owned(), field(known))).collect();
    closed(properties)
}

/// Returns the schema of a table with these properties and no others.
#[must_use]
pub fn closed(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// Returns the schema of nested sections, nested by their dotted names.
#[must_use]
pub fn tables(sections: &[Section<'_>]) -> Value {
    let mut root = closed(Map::new());
    for section in sections {
        for known in section.fields {
            insert(&mut root, section.name, known.key, field(known));
        }
    }
    root
}

/// Inserts a property into the table of a dotted name. Missing tables are created.
pub fn insert(root: &mut Value, table: &str, key: &str, schema: Value) {
    let mut place = root;
    for name in table.split('.').filter(|name| !name.is_empty()) {
        let Some(below) = place.get_mut("properties").and_then(Value::as_object_mut) else { return };
        place = below.entry(name).or_insert_with(|| closed(Map::new()));
    }
    if let Some(properties) = place.get_mut("properties").and_then(Value::as_object_mut) {
        properties.insert(key.to_owned(), schema);
    }
}

/// Returns the required keys of these sections as a separate schema.
#[must_use]
pub fn requirements(sections: &[Section<'_>]) -> Value {
    let mut root = json!({});
    for section in sections {
        for known in section.fields.iter().filter(|known| known.default == Default::Required) {
            require(&mut root, section.name, known.key);
        }
    }
    root
}

/// Adds a key of a dotted table, and the table itself, to the required keys.
pub fn require(root: &mut Value, table: &str, key: &str) {
    let (name, rest) = table.split_once('.').unwrap_or((table, ""));
    let own = if name.is_empty() { key } else { name };
    let Some(object) = root.as_object_mut() else { return };
    let required = object.entry("required").or_insert_with(|| json!([]));
    if let Some(keys) = required.as_array_mut().filter(|keys| !keys.iter().any(|known| known == own)) {
        keys.push(json!(own));
    }
    if !name.is_empty() {
        let properties = object.entry("properties").or_insert_with(|| json!({}));
        if let Some(properties) = properties.as_object_mut() {
            require(properties.entry(name).or_insert_with(|| json!({})), rest, key);
        }
    }
}

/// Returns a schema that applies `then` if `key` has the value `word`.
#[must_use]
pub fn case(key: &str, word: &str, then: Value) -> Value {
    json!({ "if": { "properties": { key: { "const": word } }, "required": [key] }, "then": then })
}

/// Adds the keys `base` and `paths` to a schema, and requirements that hold only without `base`.
#[must_use]
pub fn with_base(mut table: Value, requirements: Value) -> Value {
    let base = json!({
        "description": "Files that this one builds on; its own keys override theirs.",
        "anyOf": [{ "type": "string" }, { "type": "array", "items": { "type": "string" } }],
    });
    insert(&mut table, "", "base", base);
    let paths = json!({
        "description": "Where relative paths in this file start: its own folder, or the working directory.",
        "enum": [FROM_FILE, FROM_WORKING_DIRECTORY],
        "default": FROM_FILE,
    });
    insert(&mut table, "", PATHS, paths);
    if let Some(object) = table.as_object_mut() {
        object.insert("if".to_owned(), json!({ "not": { "required": ["base"] } }));
        object.insert("then".to_owned(), requirements);
    }
    table
}

/// Returns the schema of one key: kind, range, default, and meaning with unit and source.
#[must_use]
pub fn field(field: &Field) -> Value {
    let mut schema = kind(&field.kind);
    schema.insert("description".to_owned(), json!(description(field)));
    if let Some(default) = field.default.value() {
        schema.insert("default".to_owned(), json!(default));
    }
    Value::Object(schema)
}

/// Returns meaning, unit and source of a key in words.
#[must_use]
pub fn description(field: &Field) -> String {
    let mut text = field.meaning.to_owned();
    if !field.unit.is_empty() {
        text.push_str(&format!(" Unit: {}.", field.unit));
    }
    if !field.source.is_empty() {
        text.push_str(&format!(" Source: {}.", field.source));
    }
    text
}

fn kind(kind: &Kind) -> Map<String, Value> {
    let list = |entry: Map<String, Value>, at_least: usize, at_most: usize| {
        object(json!({ "type": "array", "items": entry, "minItems": at_least, "maxItems": at_most }))
    };
    match *kind {
        Kind::Boolean => object(json!({ "type": "boolean" })),
        Kind::Integer { min, max } => integer(min, max),
        Kind::Float { min, max } => number(min, max),
        Kind::Text | Kind::Path => object(json!({ "type": "string" })),
        Kind::Choice(words) => object(json!({ "enum": words })),
        // A single text may replace a list: `a,b`.
        Kind::Texts { at_least, at_most } => {
            let list = list(object(json!({ "type": "string" })), at_least, at_most);
            object(json!({ "anyOf": [list, { "type": "string" }] }))
        }
        Kind::Integers { min, max, at_least, at_most } => list(integer(min, max), at_least, at_most),
        Kind::Floats { min, max, at_least, at_most } => list(number(min, max), at_least, at_most),
    }
}

fn integer(min: i64, max: i64) -> Map<String, Value> {
    let mut schema = object(json!({ "type": "integer" }));
    if min != i64::MIN {
        schema.insert("minimum".to_owned(), json!(min));
    }
    if max != i64::MAX {
        schema.insert("maximum".to_owned(), json!(max));
    }
    schema
}

fn number(min: f64, max: f64) -> Map<String, Value> {
    let mut schema = object(json!({ "type": "number" }));
    if min > f64::MIN {
        schema.insert("minimum".to_owned(), json!(min));
    }
    if max < f64::MAX {
        schema.insert("maximum".to_owned(), json!(max));
    }
    schema
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

#[cfg(test)]
mod tests {
    use crate::json_schema::{requirements, tables, with_base};
    use crate::{Default, Field, Kind, Section};
    use serde_json::json;

    const PLAIN: Field = Field {
        key: "",
        kind: Kind::Text,
        default: Default::Absent,
        unit: "",
        meaning: "What it is.",
        source: "",
    };

    #[test]
    fn sections_become_closed_tables_in_one_another() {
        let number = Field {
            key: "size",
            kind: Kind::Float { min: 0.0, max: f64::MAX },
            default: Default::Required,
            unit: "s",
            source: "a paper",
            ..PLAIN
        };
        let words =
            Field { key: "mode", kind: Kind::Choice(&["a", "b"]), default: Default::Text("a"), ..PLAIN };
        let sections =
            [Section { name: "", fields: &[words] }, Section { name: "one.two", fields: &[number] }];
        assert_eq!(
            tables(&sections),
            json!({
                "type": "object",
                "properties": {
                    "mode": { "enum": ["a", "b"], "description": "What it is.", "default": "a" },
                    "one": {
                        "type": "object",
                        "properties": {
                            "two": {
                                "type": "object",
                                "properties": {
                                    "size": {
                                        "type": "number",
                                        "minimum": 0.0,
                                        "description": "What it is. Unit: s. Source: a paper.",
                                    },
                                },
                                "additionalProperties": false,
                            },
                        },
                        "additionalProperties": false,
                    },
                },
                "additionalProperties": false,
            })
        );
        let required = json!({
            "required": ["one"],
            "properties": { "one": {
                "required": ["two"],
                "properties": { "two": { "required": ["size"] } },
            } },
        });
        assert_eq!(requirements(&sections), required);
        let whole = with_base(tables(&sections), required.clone());
        assert_eq!(whole["then"], required);
        assert!(whole["properties"]["base"].is_object());
    }

    #[test]
    fn lists_and_whole_numbers_keep_their_bounds() {
        let list = Field {
            key: "widths",
            kind: Kind::Integers { min: 1, max: i64::MAX, at_least: 1, at_most: 6 },
            default: Default::Integers(&[16, 16]),
            ..PLAIN
        };
        let texts = Field { key: "names", kind: Kind::Texts { at_least: 1, at_most: 2 }, ..PLAIN };
        let schema = tables(&[Section { name: "", fields: &[list, texts] }]);
        assert_eq!(
            schema["properties"]["widths"],
            json!({
                "type": "array",
                "items": { "type": "integer", "minimum": 1 },
                "minItems": 1,
                "maxItems": 6,
                "description": "What it is.",
                "default": [16, 16],
            })
        );
        assert_eq!(schema["properties"]["names"]["anyOf"][1], json!({ "type": "string" }));
    }
}
