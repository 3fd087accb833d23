//! Validator for the part of JSON Schema (draft 2020-12) that `trainer schema` uses. A complete library would
//! add twenty-four crates and make burn build twice.

use serde_json::{Map, Value};

/// Returns the errors of a value, with places as JSON pointers; empty if it is valid.
///
/// An unknown keyword fails the test, so that no part of a schema is ignored.
pub(crate) fn errors(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, schema, value, "", &mut found);
    found
}

fn is_valid(root: &Value, schema: &Value, value: &Value) -> bool {
    let mut found = Vec::new();
    check(root, schema, value, "", &mut found);
    found.is_empty()
}

fn check(root: &Value, schema: &Value, value: &Value, place: &str, found: &mut Vec<String>) {
    let schema = match schema {
        Value::Bool(true) => return,
        Value::Bool(false) => return found.push(format!("{place}: nothing is allowed here")),
        Value::Object(schema) => schema,
        other => panic!("no schema: {other}"),
    };
    for (keyword, of) in schema {
        let holds = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" | "then" | "else" => true,
            "type" => is_of_type(value, of.as_str().unwrap()),
            "enum" => of.as_array().unwrap().contains(value),
            "const" => of == value,
            "minimum" => value.as_f64().is_none_or(|number| number >= of.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|number| number <= of.as_f64().unwrap()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > of.as_f64().unwrap()),
            "exclusiveMaximum" => value.as_f64().is_none_or(|number| number < of.as_f64().unwrap()),
            "minItems" => value.as_array().is_none_or(|list| list.len() as u64 >= of.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|list| list.len() as u64 <= of.as_u64().unwrap()),
            "minProperties" => {
                value.as_object().is_none_or(|table| table.len() as u64 >= of.as_u64().unwrap())
            }
            "required" => value.as_object().is_none_or(|table| {
                of.as_array().unwrap().iter().all(|key| table.contains_key(key.as_str().unwrap()))
            }),
            "items" => {
                for (i, entry) in value.as_array().into_iter().flatten().enumerate() {
                    check(root, of, entry, &format!("{place}/{i}"), found);
                }
                true
            }
            "properties" => {
                for (key, of) in of.as_object().unwrap() {
                    if let Some(below) = value.as_object().and_then(|table| table.get(key)) {
                        check(root, of, below, &format!("{place}/{key}"), found);
                    }
                }
                true
            }
            "additionalProperties" => {
                let none = Map::new();
                let named = schema.get("properties").map_or(&none, |named| named.as_object().unwrap());
                for (key, below) in value.as_object().into_iter().flatten() {
                    if !named.contains_key(key) {
                        check(root, of, below, &format!("{place}/{key}"), found);
                    }
                }
                true
            }
            "allOf" => {
                for one in of.as_array().unwrap() {
                    check(root, one, value, place, found);
                }
                true
            }
            "anyOf" => of.as_array().unwrap().iter().any(|one| is_valid(root, one, value)),
            "oneOf" => of.as_array().unwrap().iter().filter(|one| is_valid(root, one, value)).count() == 1,
            "not" => !is_valid(root, of, value),
            "if" => {
                let branch = if is_valid(root, of, value) { "then" } else { "else" };
                if let Some(branch) = schema.get(branch) {
                    check(root, branch, value, place, found);
                }
                true
            }
            "$ref" => {
                let pointer = of.as_str().unwrap().strip_prefix('#').unwrap();
                check(root, root.pointer(pointer).unwrap(), value, place, found);
                true
            }
            other => panic!("keyword `{other}` is not known here"),
        };
        if !holds {
            found.push(format!("{place}: {value} against {keyword}: {of}"));
        }
    }
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        other => panic!("type `{other}` is not known here"),
    }
}

#[test]
fn keywords_mean_what_the_standard_says() {
    use serde_json::json;
    let cases = [
        (
            json!({ "type": "integer", "minimum": 1, "maximum": 3 }),
            vec![json!(1), json!(3)],
            vec![json!(0), json!(4), json!(1.5), json!("1")],
        ),
        (
            json!({ "exclusiveMinimum": 0, "exclusiveMaximum": 1 }),
            vec![json!(0.5), json!("text")],
            vec![json!(0), json!(1)],
        ),
        (
            json!({ "items": { "enum": ["a"] }, "minItems": 1, "maxItems": 2 }),
            vec![json!(["a"])],
            vec![json!([]), json!(["b"]), json!(["a", "a", "a"])],
        ),
        (
            json!({ "properties": { "a": { "const": 1 } }, "required": ["a"], "additionalProperties": false }),
            vec![json!({ "a": 1 })],
            vec![json!({ "a": 2 }), json!({}), json!({ "a": 1, "b": 1 })],
        ),
        (
            json!({ "if": { "required": ["a"] }, "then": { "required": ["b"] }, "else": { "required": ["c"] } }),
            vec![json!({ "a": 1, "b": 1 }), json!({ "c": 1 })],
            vec![json!({ "a": 1 }), json!({})],
        ),
        (
            json!({ "$defs": { "n": { "not": { "type": "number" } } }, "allOf": [{ "$ref": "#/$defs/n" }] }),
            vec![json!("a")],
            vec![json!(1)],
        ),
        (
            json!({ "anyOf": [{ "type": "boolean" }, { "type": "array" }] }),
            vec![json!(true), json!([])],
            vec![json!({})],
        ),
        (
            json!({ "oneOf": [{ "required": ["a"] }, { "required": ["b"] }] }),
            vec![json!({ "a": 1 }), json!({ "b": 1 })],
            vec![json!({}), json!({ "a": 1, "b": 1 })],
        ),
    ];
    for (schema, valid, invalid) in cases {
        for value in valid {
            assert!(errors(&schema, &value).is_empty(), "{schema} refuses {value}");
        }
        for value in invalid {
            assert!(!errors(&schema, &value).is_empty(), "{schema} takes {value}");
        }
    }
}
