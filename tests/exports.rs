//! Tests of `trainer export`: finished runs in the formats of TensorBoard and MLflow, read by our own readers
//! and, if installed, by those programs.

use crate::support::{result, trainer};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Makes a finished run and returns its result.
fn run() -> (Value, TempDir) {
    let (code, result, folder) = result(&["configs/pinn.toml", "seed=3"]);
    assert_eq!(code, 0);
    (result, folder)
}

fn export(run: &Path, to: &str, store: &Path) -> Vec<PathBuf> {
    let arguments =
        ["export", run.to_str().unwrap(), "--to", to, "--store", store.to_str().unwrap(), "--json"];
    let output = trainer(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let written: Value = serde_json::from_slice(&output.stdout).unwrap();
    written["written"].as_array().unwrap().iter().map(|path| path.as_str().unwrap().into()).collect()
}

/// Returns steps and values of a column of the trace.
fn column(run: &Path, name: &str) -> Vec<(i64, f64)> {
    let mut reader = csv::Reader::from_path(run.join("trace.csv")).unwrap();
    let at = reader.headers().unwrap().iter().position(|header| header == name).unwrap();
    let rows = reader.records().map(Result::unwrap);
    rows.map(|row| (row[0].parse().unwrap(), row[at].parse().unwrap())).collect()
}

/// Parses the fields of a protocol buffer: number, wire type, and the value or the content's bytes.
fn fields(mut message: &[u8]) -> Vec<(u64, Field<'_>)> {
    let mut found = Vec::new();
    while !message.is_empty() {
        let key = varint(&mut message);
        let field = match key & 7 {
            0 => Field::Whole(varint(&mut message)),
            1 => Field::Fixed(take(&mut message, 8)),
            2 => {
                let length = varint(&mut message);
                Field::Fixed(take(&mut message, length as usize))
            }
            5 => Field::Fixed(take(&mut message, 4)),
            other => panic!("wire type {other}"),
        };
        found.push((key >> 3, field));
    }
    found
}

#[derive(Clone, Copy)]
enum Field<'a> {
    Whole(u64),
    Fixed(&'a [u8]),
}

impl<'a> Field<'a> {
    fn bytes(self) -> &'a [u8] {
        match self {
            Self::Fixed(bytes) => bytes,
            Self::Whole(number) => panic!("{number}"),
        }
    }
}

fn take<'a>(message: &mut &'a [u8], count: usize) -> &'a [u8] {
    let (taken, rest) = message.split_at(count);
    *message = rest;
    taken
}

fn varint(message: &mut &[u8]) -> u64 {
    let mut value = 0;
    for shift in (0..).step_by(7) {
        let byte = take(message, 1)[0];
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            break;
        }
    }
    value
}

/// Returns the masked CRC-32C by a table, another algorithm than the writer's.
fn masked(content: &[u8]) -> u32 {
    let table: Vec<u32> = (0..256u32)
        .map(|byte| (0..8).fold(byte, |c, _| if c & 1 == 1 { 0x82f6_3b78 ^ (c >> 1) } else { c >> 1 }))
        .collect();
    let crc =
        !content.iter().fold(!0u32, |c, byte| table[((c ^ u32::from(*byte)) & 0xff) as usize] ^ (c >> 8));
    crc.rotate_right(15).wrapping_add(0xa282_ead8)
}

/// Returns the scalars by tag: step and value. Every checksum is compared with the content.
fn scalars(mut file: &[u8]) -> BTreeMap<String, Vec<(i64, f32)>> {
    let mut found: BTreeMap<String, Vec<(i64, f32)>> = BTreeMap::new();
    let mut first = true;
    while !file.is_empty() {
        let length = take(&mut file, 8);
        assert_eq!(take(&mut file, 4), masked(length).to_le_bytes());
        let content = take(&mut file, u64::from_le_bytes(length.try_into().unwrap()) as usize);
        assert_eq!(take(&mut file, 4), masked(content).to_le_bytes());
        let (mut step, mut summary) = (0, None);
        for (number, field) in fields(content) {
            match (number, field) {
                (1, time) => assert!(f64::from_le_bytes(time.bytes().try_into().unwrap()) > 1.7e9),
                (2, Field::Whole(number)) => step = number as i64,
                (3, version) => assert!(first && version.bytes() == b"brain.Event:2"),
                (5, content) => summary = Some(content.bytes()),
                (other, _) => panic!("field {other}"),
            }
        }
        first = false;
        let Some(summary) = summary else { continue };
        let [(1, value)] = fields(summary)[..] else { panic!("one value") };
        let [(1, tag), (2, number)] = fields(value.bytes())[..] else { panic!("tag and number") };
        let tag = String::from_utf8(tag.bytes().to_vec()).unwrap();
        let number = f32::from_le_bytes(number.bytes().try_into().unwrap());
        found.entry(tag).or_default().push((step, number));
    }
    found
}

#[test]
fn an_event_file_holds_the_trace_by_step_and_the_result() {
    let (result, folder) = run();
    let store = tempfile::tempdir().unwrap();
    let written = export(folder.path(), "tensorboard", store.path());
    assert!(written[0].file_name().unwrap().to_str().unwrap().contains("tfevents"));
    let file = std::fs::read(&written[0]).unwrap();
    let found = scalars(&file);
    for name in ["loss", "decay_rate"] {
        let expected: Vec<(i64, f32)> =
            column(folder.path(), name).into_iter().map(|(step, value)| (step, value as f32)).collect();
        assert!(expected.len() > 4);
        assert_eq!(found[&format!("trace/{name}")], expected);
    }
    let zeta = result["estimate"]["zeta"].as_f64().unwrap() as f32;
    assert_eq!(found["result/estimate/zeta"][0].1, zeta);
    // A second export gives the same bytes.
    export(folder.path(), "tensorboard", store.path());
    assert_eq!(std::fs::read(&written[0]).unwrap(), file);
    assert_eq!(std::fs::read_dir(folder.path().join("tensorboard")).unwrap().count(), 1);
}

#[test]
fn a_store_holds_parameters_metrics_and_tags() {
    let (result, folder) = run();
    let scratch = tempfile::tempdir().unwrap();
    let store = scratch.path().join("mlruns");
    let run = &export(folder.path(), "mlflow", &store)[0];
    let text = |name: &str| std::fs::read_to_string(run.join(name)).unwrap();
    assert_eq!(text("params/seed"), "3");
    assert_eq!(text("params/estimator.name"), "pinn");
    assert_eq!(text("tags/task"), "estimate");
    let zeta = text("metrics/estimate.zeta");
    let zeta: Vec<&str> = zeta.split_whitespace().collect();
    assert_eq!(zeta[1].parse::<f64>().unwrap(), result["estimate"]["zeta"].as_f64().unwrap());
    let steps: Vec<(i64, f64)> = text("metrics/trace.loss")
        .lines()
        .map(|line| line.split(' ').collect::<Vec<_>>())
        .map(|parts| (parts[2].parse().unwrap(), parts[1].parse().unwrap()))
        .collect();
    assert_eq!(steps, column(folder.path(), "loss"));
    assert!(store.join("0/meta.yaml").exists());
    // An existing store keeps its description, and the same run keeps its folder.
    std::fs::write(store.join("0/meta.yaml"), "mine").unwrap();
    assert_eq!(&export(folder.path(), "mlflow", &store)[0], run);
    assert_eq!(std::fs::read_to_string(store.join("0/meta.yaml")).unwrap(), "mine");
    assert_eq!(std::fs::read_dir(store.join("0")).unwrap().count(), 2);
}

#[test]
fn what_is_no_run_is_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let empty = scratch.path().to_str().unwrap();
    let output = trainer(&["export", empty, "--to", "mlflow", "--store", empty]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("events.jsonl"));
    assert_eq!(std::fs::read_dir(scratch.path()).unwrap().count(), 0);
}

const READ_WITH_THEIRS: &str = r#"
import json, os, sys
os.environ["MLFLOW_ALLOW_FILE_STORE"] = "true"
run, store, mlflow_run = sys.argv[1:4]
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
events = EventAccumulator(run + "/tensorboard", size_guidance={"scalars": 0})
events.Reload()
loss = [[e.step, e.value] for e in events.Scalars("trace/loss")]
from mlflow.tracking import MlflowClient
client = MlflowClient(tracking_uri="file://" + store)
found = client.get_run(mlflow_run)
json.dump({
    "loss": loss,
    "tags": events.Tags()["scalars"],
    "params": found.data.params,
    "zeta": found.data.metrics["estimate.zeta"],
    "status": found.info.status,
    "runs": len(client.search_runs(["0"])),
    "artifacts": [file.path for file in client.list_artifacts(mlflow_run)],
    "history": [[m.step, m.value] for m in client.get_metric_history(mlflow_run, "trace.loss")],
}, sys.stdout)
"#;

/// Needs `pip install tensorboard mlflow`; without them the test reports that it checked nothing.
/// `TRACKERS_PYTHON` names another Python than `python3`.
#[test]
fn their_own_programs_read_what_was_written() {
    let python = std::env::var("TRACKERS_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let there = Command::new(&python)
        .args(["-c", "import tensorboard, mlflow"])
        .output()
        .is_ok_and(|output| output.status.success());
    if !there {
        let line = "SKIPPED: tensorboard and mlflow are not installed, so neither read an export\n";
        std::io::stderr().write_all(line.as_bytes()).unwrap();
        return;
    }
    let (result, folder) = run();
    let scratch = tempfile::tempdir().unwrap();
    let written = export(folder.path(), "tensorboard,mlflow", scratch.path());
    let id = written[1].file_name().unwrap().to_str().unwrap();
    let output = Command::new(&python)
        .args(["-c", READ_WITH_THEIRS, folder.path().to_str().unwrap()])
        .args([scratch.path().to_str().unwrap(), id])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read: Value = serde_json::from_slice(&output.stdout).unwrap();
    let pairs = |value: &Value| -> Vec<(i64, f64)> {
        let pairs = value.as_array().unwrap().iter();
        pairs.map(|pair| (pair[0].as_i64().unwrap(), pair[1].as_f64().unwrap())).collect()
    };
    let loss = column(folder.path(), "loss");
    assert_eq!(pairs(&read["history"]), loss);
    let narrow = |points: Vec<(i64, f64)>| -> Vec<(i64, f32)> {
        points.into_iter().map(|(step, value)| (step, value as f32)).collect()
    };
    assert_eq!(narrow(pairs(&read["loss"])), narrow(loss));
    assert_eq!(read["zeta"], result["estimate"]["zeta"]);
    assert_eq!(read["params"]["seed"], "3");
    assert_eq!((read["status"].as_str(), read["runs"].as_u64()), (Some("FINISHED"), Some(1)));
    let artifacts: Vec<&str> =
        read["artifacts"].as_array().unwrap().iter().map(|path| path.as_str().unwrap()).collect();
    assert!(artifacts.contains(&"report.html") && artifacts.contains(&"result.json"), "{artifacts:?}");
}
