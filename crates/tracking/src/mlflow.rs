//! MLflow's file store: a folder for each run, a file for each parameter, metric and tag.
//!
//! Format: `mlflow/store/tracking/file_store.py`.

use crate::Finished;
use runs::digest;
use serde_json::{Value, json};
use std::path::Path;

/// Description file of the experiment that runs belong to, which is the store's default experiment.
pub const EXPERIMENT: &str = "0/meta.yaml";

/// Length in characters above which MLflow refuses values of parameters.
const LONGEST: usize = 6000;

/// Returns the folder of a run in the store.
#[must_use]
pub fn folder(run: &Finished) -> String {
    format!("0/{}", id(run))
}

/// Returns the id of a run, 32 hexadecimal digits; the same run always has the same id.
fn id(run: &Finished) -> String {
    let digest = digest(format!("{} {}", run.name, run.began_ms).as_bytes());
    digest.rsplit(':').flat_map(str::chars).take(32).collect()
}

/// Returns the names and contents of a run's files; names are relative to `store`, the path of the store.
#[must_use]
pub fn files(run: &Finished, store: &Path) -> Vec<(String, String)> {
    let folder = folder(run);
    let mut files = vec![(format!("{folder}/meta.yaml"), meta(run, &store.join(&folder).join("artifacts")))];
    let mut add = |kind: &str, name: &str, content: String| {
        files.push((format!("{folder}/{kind}/{}", admitted(name)), content));
    };
    for (name, value) in &run.parameters {
        add("params", name, value.chars().take(LONGEST).collect());
    }
    for curve in &run.curves {
        let line = |(step, value): &(i64, f64)| format!("{} {value:?} {step}\n", run.began_ms);
        add("metrics", &format!("trace.{}", curve.name), curve.points.iter().map(line).collect());
    }
    for (name, value) in &run.metrics {
        add("metrics", name, format!("{} {value:?} 0\n", run.ended_ms));
    }
    for (name, text) in &run.tags {
        add("tags", name, text.clone());
    }
    for (name, text) in &run.files {
        add("artifacts", name, text.clone());
    }
    add("tags", "mlflow.runName", run.name.clone());
    add("tags", "mlflow.source.name", "ringdown".to_owned());
    files
}

/// Replaces characters that MLflow does not allow in names; letters, digits and a few signs are allowed.
fn admitted(name: &str) -> String {
    let admit = |c: char| if c.is_ascii_alphanumeric() || "_-. ".contains(c) { c } else { '_' };
    name.chars().map(admit).collect()
}

fn meta(run: &Finished, artifacts: &Path) -> String {
    /// Codes of `SourceType.LOCAL`, `RunStatus.FINISHED` and `RunStatus.KILLED`
    /// (`mlflow/protos/service.proto`).
    const LOCAL: u8 = 4;
    const FINISHED: u8 = 3;
    const KILLED: u8 = 5;
    let id = id(run);
    yaml(&[
        ("artifact_uri", json!(artifacts.display().to_string())),
        ("end_time", json!(run.ended_ms)),
        ("entry_point_name", json!("")),
        ("experiment_id", json!("0")),
        ("lifecycle_stage", json!("active")),
        ("run_id", json!(id)),
        ("run_name", json!(run.name)),
        ("run_uuid", json!(id)),
        ("source_name", json!("")),
        ("source_type", json!(LOCAL)),
        ("source_version", json!("")),
        ("start_time", json!(run.began_ms)),
        ("status", json!(if run.is_complete { FINISHED } else { KILLED })),
        ("tags", json!([])),
        ("user_id", json!("")),
    ])
}

/// Returns the description of the default experiment of a store at the path `store`.
#[must_use]
pub fn experiment(run: &Finished, store: &Path) -> String {
    yaml(&[
        ("artifact_location", json!(store.join("0").display().to_string())),
        ("creation_time", json!(run.began_ms)),
        ("experiment_id", json!("0")),
        ("last_update_time", json!(run.began_ms)),
        ("lifecycle_stage", json!("active")),
        ("name", json!("Default")),
    ])
}

/// Encodes entries as YAML. Values are written as JSON, which is valid YAML.
fn yaml(entries: &[(&str, Value)]) -> String {
    entries.iter().map(|(key, value)| format!("{key}: {value}\n")).collect()
}
