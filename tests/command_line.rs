//! Tests of what all commands share: options and output.

use crate::support::{root, trainer};
use std::fs::File;
use std::process::{Command, Stdio};

const COMMANDS: &[&str] = &[
    "check", "cite", "diagnose", "explain", "list", "schema", "simulate", "sweep", "compare", "trials",
    "verify", "export", "report",
];

#[test]
fn every_command_takes_every_option_and_shows_those_that_do_something() {
    for command in COMMANDS {
        let all =
            ["--out", "x", "--seed", "3", "--threads", "2", "--quiet", "--json", "--resume", "--nonsense"];
        let message = String::from_utf8(trainer(&[&[*command], &all[..]].concat()).stderr).unwrap();
        assert!(message.contains("unexpected argument '--nonsense'"), "{command}: {message}");
        let help = String::from_utf8(trainer(&[command, "--help"]).stdout).unwrap();
        assert!(!help.contains("No effect here") && help.contains("--help"), "{help}");
    }
    let shown = |command: &str, option: &str| {
        String::from_utf8(trainer(&[command, "--help"]).stdout).unwrap().contains(option)
    };
    assert!(shown("simulate", "--seed") && !shown("report", "--seed") && !shown("list", "--resume"));
    let options = ["--out", "x", "--seed", "3", "--threads", "2", "--resume", "--quiet"];
    let output = trainer(&[&["list", "effects"], &options[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let output = trainer(&["check", "configs/pinn.toml", "--seed", "17"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("seed 17"));
}

#[test]
fn completions_and_manual_pages_name_every_command() {
    for shell in ["bash", "zsh", "fish"] {
        let script = String::from_utf8(trainer(&["completions", shell]).stdout).unwrap();
        assert!(COMMANDS.iter().all(|command| script.contains(command)), "{shell}");
    }
    let page = String::from_utf8(trainer(&["man"]).stdout).unwrap();
    assert!(page.contains(".TH") && page.contains("diagnose"), "{page}");
    let folder = tempfile::tempdir().unwrap();
    let output = trainer(&["man", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    for command in COMMANDS {
        assert!(folder.path().join(format!("trainer-{command}.1")).is_file(), "{command}");
    }
}

#[test]
fn a_result_that_cannot_be_written_is_an_error() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let mut command = Command::new(env!("CARGO_BIN_EXE_trainer"));
    let output = command.args(["list", "effects"]).current_dir(root()).stdout(full).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.starts_with("error: the result cannot be written to standard output: "), "{message}");
}

#[test]
fn a_message_that_cannot_be_written_changes_no_exit_code() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let mut command = Command::new(env!("CARGO_BIN_EXE_trainer"));
    let status = command.arg("nowhere.toml").current_dir(root()).stderr(full).status().unwrap();
    assert_eq!(status.code(), Some(2));
}

#[test]
fn a_reader_that_goes_away_is_none() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trainer"));
    command.args(["list", "effects"]).current_dir(root()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty());
}

/// Expects exit code 2 and these words in the only message.
fn refused(arguments: &[&str], expected: &[&str]) {
    let output = trainer(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert_eq!(message.trim_end().lines().count(), 1, "{message}");
    for words in expected {
        assert!(message.contains(words), "no `{words}` in {message}");
    }
}

#[test]
fn a_log_without_a_simulator_is_sent_to_init() {
    let record = "experiments/default-record/record.csv";
    refused(&["diagnose", record], &["--nominal FILE", &format!("`trainer init {record}`")]);
}

#[test]
fn a_configuration_in_the_place_of_a_simulator_is_told_as_one() {
    let record = "experiments/default-record/record.csv";
    for (config, command) in [
        ("configs/pinn.toml", "trainer"),
        ("configs/simulate.toml", "trainer simulate"),
        ("configs/trials-quick.toml", "trainer trials"),
    ] {
        let runs = format!("the configuration of an experiment, which `{command} {config}` runs");
        refused(&["diagnose", record, "--nominal", config], &[&runs, "`trainer init LOG`"]);
    }
}

#[test]
fn files_in_each_others_places_are_told_apart() {
    let record = "experiments/default-record/record.csv";
    refused(
        &["diagnose", record, "--nominal", record],
        &[
            "is a record, not a nominal simulator",
            "`trainer init experiments/default-record/record.csv` writes one",
        ],
    );
    let nominal = "experiments/default-record/nominal.toml";
    refused(&["init", nominal], &["describes a nominal simulator, not a log", "trainer diagnose RECORD"]);
    refused(
        &["init", "configs/pinn.toml"],
        &["is a configuration, not a log", "`trainer configs/pinn.toml`"],
    );
    refused(&["--nominal", nominal, record], &["--nominal is an option of `trainer diagnose`"]);
}

#[test]
fn a_missing_record_is_answered_with_the_nearest_one() {
    let nominal = "experiments/default-record/nominal.toml";
    let near = "did you mean experiments/default-record/record.csv?";
    for line in [
        &["init", "experiments/default-record/recrod.csv"][..],
        &["diagnose", "experiments/default-record/records.csv", "--nominal", nominal],
    ] {
        refused(line, &["there is no such file", near]);
    }
    refused(&["init", "experiments/default-record/other.csv"], &["other.csv: cannot be read"]);
}

#[test]
fn a_missing_configuration_is_answered_with_the_nearest_one() {
    refused(&["configs/pin.toml"], &["did you mean configs/pinn.toml?"]);
    refused(&["pinn.tml"], &["did you mean configs/pinn.toml?"]);
    let output = trainer(&["configs/nothing-like-it.toml"]);
    assert!(!String::from_utf8(output.stderr).unwrap().contains("did you mean"));
}

#[test]
fn the_reason_for_the_clock_is_said_once() {
    let scratch = tempfile::tempdir().unwrap();
    let output = trainer(&["configs/ols.toml", "--out", scratch.path().to_str().unwrap()]);
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("clock in force: uniform-index"), "{shown}");
    assert_eq!(shown.matches("repeat the one before").count(), 1, "{shown}");
}
