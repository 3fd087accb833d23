//! Tests of `trainer init`, the first look at a log, and of the commands that it prints.

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

/// A column that is unrelated to a free decay, or constant, is not taken as an input; the user can exclude
/// any column.
#[test]
fn a_column_that_the_motion_does_not_follow_is_no_input() {
    let scratch = tempfile::tempdir().unwrap();
    for (title, of) in [
        ("battery_voltage", (|row| 12.0 + 0.01 * (f64::from(row) * 0.7).sin()) as fn(u32) -> f64),
        ("command", |_| 1.0),
        ("force_n", |row| 0.02 * (f64::from(row).powi(2) * 0.37).sin()),
    ] {
        let line = |row: u32| {
            let time = f64::from(row) * 0.01;
            let angle = 0.5 * (-0.1 * time).exp() * (TAU * time).cos() + 1e-4 * (f64::from(row) * 37.7).sin();
            format!("{time:.2},{angle:.6},{:.6}\n", of(row))
        };
        let text = format!("time_s,angle_rad,{title}\n{}", (0..2000).map(line).collect::<String>());
        write(scratch.path(), "log.csv", &text);
        for (folder, asked) in [("plain", ""), ("none", " --input none")] {
            let call = format!("trainer init log.csv --out {title}-{folder}{asked} --json");
            let found = said(&shell(&call, scratch.path()));
            assert_eq!(found["oscillator"]["input_gain_per_inertia"], Value::Null, "{call}");
            let frequency = number(&found, "/oscillator/natural_frequency_hz/value");
            assert!((frequency - 1.0).abs() < 1e-3, "{call}: {frequency}");
            assert!(found["next"][0].as_str().unwrap().ends_with(" --input none"), "{}", found["next"]);
            let said = format!("`{title}` was not taken as the input, since the motion does not follow it");
            assert_eq!(found["record"]["findings"].to_string().contains(&said), asked.is_empty(), "{found}");
            let output = shell(&format!("{} --json", found["next"][1].as_str().unwrap()), scratch.path());
            let ratio = number(&self::said(&output), "/estimate/zeta");
            assert!((ratio * TAU / 0.1 - 1.0).abs() < 0.01, "{call}: {ratio}");
        }
    }
}

/// Regression: `--clock` was ignored, and a stated rate was not compared with the stamps.
#[test]
fn a_clock_that_is_asked_for_is_used_and_a_stated_rate_compared() {
    let scratch = tempfile::tempdir().unwrap();
    let (_, text, _, _) = files().swap_remove(0);
    write(scratch.path(), "log.csv", &format!("# sample_rate_hz: 50\n{text}"));
    let found = said(&shell("trainer init log.csv --clock host --json", scratch.path()));
    assert_eq!(found["record"]["clock"], "host", "{found}");
    assert!(found["record"]["findings"].to_string().contains("not the stated 50 Hz"), "{found}");
    assert!(found["next"][0].as_str().unwrap().ends_with(" --clock host"), "{}", found["next"]);
    let written = std::fs::read_to_string(scratch.path().join("log/estimate.toml")).unwrap();
    assert!(written.lines().any(|line| line == "clock = \"host\""), "{written}");
}

/// Noise has a strongest spectral line, as a swing has, but its frequency is uncertain.
#[test]
fn noise_is_said_to_hold_no_swing() {
    let scratch = tempfile::tempdir().unwrap();
    let line = |row: u32| {
        let noise = (f64::from(row + 1) * 12.9898).sin() * 43_758.545_3;
        format!("{:.2},{:.6}\n", f64::from(row) * 0.01, 0.02 * (noise - noise.floor() - 0.5))
    };
    let text = format!("time_s,angle_rad\n{}", (0..1000).map(line).collect::<String>());
    write(scratch.path(), "log.csv", &text);
    let found = said(&shell("trainer init log.csv --json", scratch.path()));
    let findings = found["record"]["findings"].to_string();
    assert!(findings.contains("may hold noise and no swing"), "{found}");
}

/// A growing swing has a negative damping and gets a note; its nominal simulator has zero damping.
#[test]
fn a_swing_that_grows_is_said_to() {
    let scratch = tempfile::tempdir().unwrap();
    let line = |row: u32| {
        let time = f64::from(row) * 0.01;
        format!("{time:.2},{:.6}\n", 0.05 * (0.1 * time).exp() * (TAU * time).cos())
    };
    write(
        scratch.path(),
        "log.csv",
        &format!("time_s,angle_rad\n{}", (0..2000).map(line).collect::<String>()),
    );
    let found = said(&shell("trainer init log.csv --out rig --json", scratch.path()));
    let ratio = number(&found, "/oscillator/damping_ratio/value");
    assert!((ratio + 0.1 / TAU).abs() < 1e-3, "{ratio}");
    assert!(found["record"]["findings"].to_string().contains("the swing grows"), "{found}");
    let nominal = std::fs::read_to_string(scratch.path().join("rig/nominal.toml")).unwrap();
    assert!(nominal.lines().any(|line| line.starts_with("damping_ratio = 0.0 ")), "{nominal}");
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

/// Two logs of one system in a folder are looked at together, and diagnosed by the printed command.
#[test]
fn a_folder_of_logs_is_one_system() {
    let scratch = tempfile::tempdir().unwrap();
    let logs = scratch.path().join("logs");
    std::fs::create_dir(&logs).unwrap();
    let of = |name: &str, text: &str| write(&logs, name, text);
    of("README.txt", "two releases of the pendulum");
    let files = files();
    let plain = &files[0].1;
    // The second release starts half a second later, so that it is another record.
    let later: Vec<&str> = plain.lines().take(1).chain(plain.lines().skip(51)).collect();
    of("one.csv", plain);
    of("two.csv", &later.join("\n"));
    let found = said(&shell("trainer init logs --json", scratch.path()));
    assert_eq!(found["logs"].as_array().unwrap().len(), 2, "{found}");
    let next = found["next"].as_array().unwrap();
    assert_eq!(next[0], "trainer diagnose logs --nominal logs-nominal/nominal.toml");
    let diagnosed = said(&shell(&format!("{} --json", next[0].as_str().unwrap()), scratch.path()));
    assert_eq!(diagnosed["records"].as_array().unwrap().len(), 2, "{}", diagnosed["records"]);
    let estimated = said(&shell(&format!("{} --json", next[1].as_str().unwrap()), scratch.path()));
    assert!((number(&estimated, "/estimate/zeta") * 22.0 / 0.15 - 1.0).abs() < 0.01);
    let shown = String::from_utf8(shell("trainer init logs/ --out again", scratch.path()).stdout).unwrap();
    for words in
        ["logs/two.csv", "the most certain of them: logs/", "trainer diagnose logs/ --nominal again/"]
    {
        assert!(shown.contains(words), "{words}: {shown}");
    }
    // The nominal simulator in the folder of records is the one that they are compared with.
    std::fs::copy(scratch.path().join("again/nominal.toml"), logs.join("nominal.toml")).unwrap();
    let beside = said(&shell("trainer diagnose logs --out beside --json", scratch.path()));
    assert_eq!(beside["nominal"], "logs/nominal.toml", "{beside}");
    let faster = plain.lines().skip(1).filter_map(|line| line.split_once(',')).enumerate();
    let faster = faster.map(|(at, (_, angle))| format!("{},{angle}\n", at as f64 * 0.005));
    of("three.csv", &format!("time_s,angle_rad\n{}", faster.collect::<String>()));
    let shown = String::from_utf8(shell("trainer init logs --out third", scratch.path()).stdout).unwrap();
    assert!(shown.contains("too far apart for records of one system"), "{shown}");
}

#[test]
fn a_folder_that_is_none_of_logs_is_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let refused = |line: &str, expected: &str| {
        let output = shell(line, scratch.path());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        assert_eq!(message.trim_end().lines().count(), 1, "{message}");
        assert!(message.contains(expected), "{line}: no `{expected}` in {message}");
    };
    std::fs::create_dir(scratch.path().join("empty")).unwrap();
    let (_, text, _, _) = files().swap_remove(0);
    write(scratch.path(), "log.csv", &text);
    write(scratch.path(), "nominal.toml", "natural_frequency_rad_s = 22.0\ndamping_ratio = 0.007\n");
    for line in ["trainer init empty", "trainer diagnose empty --nominal nominal.toml"] {
        refused(
            line,
            "empty: holds no log: no file in it has one of the endings .csv, .tsv, .lvm, .npy, .npz, .mat, .wav, .txt,",
        );
    }
    std::fs::create_dir_all(scratch.path().join("day/morning")).unwrap();
    write(&scratch.path().join("day/morning"), "log.csv", &text);
    refused("trainer init day", "there are some in day/morning");
    refused(
        "trainer day/morning",
        "is a folder of logs, not a configuration; look at them with `trainer init ",
    );
    refused("trainer diagnose day/morning", "`trainer init day/morning` makes a first guess");
    write(&scratch.path().join("day/morning"), "diagnosis.json", "{}");
    refused(
        "trainer diagnose day/morning --nominal nominal.toml",
        "day/morning: is the folder of a finished run",
    );
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
