//! A first look at a log, and the calls that it prints.

use crate::reading::{files, write};
use crate::support::{number, trainer};
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::{Command, Output};

/// Runs a line as a user's shell would, in a folder, with the program on its path.
fn shell(line: &str, folder: &Path) -> Output {
    let line = line.replacen("trainer", "\"$TRAINER\"", 1);
    Command::new("sh")
        .args(["-c", &line])
        .env("TRAINER", env!("CARGO_BIN_EXE_trainer"))
        .current_dir(folder)
        .output()
        .unwrap()
}

fn said(output: &Output) -> Value {
    let message = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {message}"))
}

#[test]
fn every_file_is_looked_at_and_diagnosed_as_printed() {
    let scratch = tempfile::tempdir().unwrap();
    for (name, text, coordinate, options) in files() {
        write(scratch.path(), &format!("{name}.csv"), &text);
        let flags: String = options.chunks(2).map(|pair| format!(" --{} {}", pair[0], pair[1])).collect();
        let found = said(&shell(&format!("trainer init '{name}.csv'{flags} --json"), scratch.path()));
        let frequency = number(&found, "/oscillator/natural_frequency_hz/value");
        assert!((frequency * TAU / 22.0 - 1.0).abs() < 1e-3, "{name}: {frequency}");
        let ratio = number(&found, "/oscillator/damping_ratio/value");
        let error = number(&found, "/oscillator/damping_ratio/std_error");
        assert!((ratio - 0.15 / 22.0).abs() < 4.0 * error, "{name}: {ratio} ± {error}");
        if name != "position" {
            assert_eq!(found["oscillator"]["coordinate"], coordinate, "{name}");
        }
        let next = found["next"].as_array().unwrap();
        assert_eq!(next.len(), 2, "{name}");
        let diagnosed = said(&shell(&format!("{} --json", next[0].as_str().unwrap()), scratch.path()));
        assert_ne!(diagnosed["verdict"]["status"], "unknown", "{name}: {}", diagnosed["verdict"]);
        let estimated = said(&shell(&format!("{} --json", next[1].as_str().unwrap()), scratch.path()));
        assert!((number(&estimated, "/estimate/zeta") / ratio - 1.0).abs() < 1e-3, "{name}");
    }
}

#[test]
fn a_driven_log_gets_a_gain_and_no_envelope() {
    let scratch = tempfile::tempdir().unwrap();
    let config = ["simulate", "configs/simulate.toml", "simulate.systems=1", "simulate.records=1"];
    let input = ["input.waveform=chirp", "input.amplitude=0.02", "start.position=0.0"];
    let out = scratch.path().join("made");
    let effects = ["simulate.effects_per_system=0"];
    let mut arguments: Vec<&str> = config.into_iter().chain(input).chain(effects).collect();
    arguments.extend(["--out", out.to_str().unwrap(), "--quiet"]);
    let made = trainer(&arguments);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let records = walk(&out.join("records"));
    let log = records.iter().find(|path| path.ends_with("record-000.csv")).unwrap();
    let found = said(&shell(&format!("trainer init {log} --out rig --json"), scratch.path()));
    let gain = number(&found, "/oscillator/input_gain_per_inertia/value");
    let error = number(&found, "/oscillator/input_gain_per_inertia/std_error");
    assert!((gain - 2000.0).abs() < 4.0 * error + 20.0, "{gain} ± {error}");
    let next = found["next"].as_array().unwrap();
    assert_eq!(next.len(), 1);
    let diagnosed = shell(&format!("{} --json", next[0].as_str().unwrap()), scratch.path());
    assert_eq!(diagnosed.status.code(), Some(0), "{}", String::from_utf8_lossy(&diagnosed.stderr));
}

fn walk(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(walk(&path));
        } else {
            found.push(path.to_str().unwrap().to_owned());
        }
    }
    found
}

#[test]
fn nothing_is_overwritten_and_what_says_nothing_is_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let (_, text, _, _) = files().swap_remove(0);
    write(scratch.path(), "log.csv", &text);
    let first = shell("trainer init log.csv", scratch.path());
    assert_eq!(first.status.code(), Some(0), "{}", String::from_utf8_lossy(&first.stderr));
    let shown = String::from_utf8(first.stdout).unwrap();
    for words in
        ["read as: comma-separated", "damping ratio", "trainer diagnose log.csv --nominal log/nominal.toml"]
    {
        assert!(shown.contains(words), "{words}: {shown}");
    }
    let again = shell("trainer init log.csv", scratch.path());
    let message = String::from_utf8(again.stderr).unwrap();
    assert_eq!(again.status.code(), Some(2), "{message}");
    assert!(message.contains("log is not empty") && message.contains("--out"), "{message}");
    write(
        scratch.path(),
        "still.csv",
        &format!("time,angle\n{}", (0..50).map(|i| format!("{i},0.5\n")).collect::<String>()),
    );
    let still = shell("trainer init still.csv", scratch.path());
    let message = String::from_utf8(still.stderr).unwrap();
    assert_eq!(still.status.code(), Some(2), "{message}");
    assert!(message.contains("nothing moves in the record"), "{message}");
    assert!(!scratch.path().join("still").exists());
}
