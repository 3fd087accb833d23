//! MLflow's file store: a folder for a run, a file for each parameter, metric and tag.
//!
//! Format: `mlflow/store/tracking/file_store.py`.

use crate::Finished;
use runs::digest;
use serde_json::{Value, json};
use std::path::Path;

/// The description of the experiment that runs belong to, the store's default one.
pub const EXPERIMENT: &str = "0/meta.yaml";

/// MLflow refuses longer values of parameters.
const LONGEST: usize = 6000;

/// The folder of a run in the store.
#[must_use]
pub fn folder(run: &Finished) -> String {
    format!("0/{}", id(run))
}

/// 32 hexadecimal digits; the same run has the same ones.
fn id(run: &Finished) -> String {
    let digest = digest(format!("{} {}", run.name, run.began_ms).as_bytes());
    digest.rsplit(':').flat_map(str::chars).take(32).collect()
}

/// Names within a store that lies at a path, and contents.
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

/// Names take letters, digits and a few signs.
fn admitted(name: &str) -> String {
    let admit = |c: char| if c.is_ascii_alphanumeric() || "_-. ".contains(c) { c } else { '_' };
    name.chars().map(admit).collect()
}

fn meta(run: &Finished, artifacts: &Path) -> String {
    /// Codes of `SourceType.LOCAL`, `RunStatus.FINISHED` and `RunStatus.KILLED` (`mlflow/protos/service.proto`).
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

/// The description of the store's default experiment, the store lying at a path.
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

/// A value as JSON writes it is YAML too.
fn yaml(entries: &[(&str, Value)]) -> String {
    entries.iter().map(|(key, value)| format!("{key}: {value}\n")).collect()
}
