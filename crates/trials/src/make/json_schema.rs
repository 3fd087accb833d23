//! JSON Schema of trial configurations.

use super::schema::SECTIONS;
use serde_json::{Value, json};
use settings::json_schema;

/// Returns the JSON Schema of `task = "trials"`.
#[must_use]
pub fn trials_schema() -> Value {
    let mut root = json_schema::tables(SECTIONS);
    json_schema::insert(&mut root, "", "task", json!({ "const": "trials" }));
    json_schema::with_base(root, json_schema::requirements(SECTIONS))
}
