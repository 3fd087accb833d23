//! What every command has in common: its options, and what becomes of what it prints.

use crate::support::{root, trainer};
use std::fs::File;
use std::process::{Command, Stdio};

const COMMANDS: &[&str] = &[
    "check", "cite", "diagnose", "explain", "list", "schema", "simulate", "sweep", "compare", "trials",
    "verify", "export", "report",
];

#[test]
fn every_command_takes_every_option() {
    for command in COMMANDS.iter().map(|name| vec![*name]).chain([vec![]]) {
        let output = trainer(&[&command[..], &["--help"]].concat());
        let help = String::from_utf8(output.stdout).unwrap();
        for option in ["--out", "--seed", "--threads", "--quiet", "--json", "--resume"] {
            assert!(help.lines().any(|line| line.trim_start().starts_with(option)), "{command:?}: {option}");
        }
    }
    let options = ["--out", "x", "--seed", "3", "--threads", "2", "--resume", "--quiet"];
    let output = trainer(&[&["list", "effects"], &options[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let output = trainer(&["check", "configs/pinn.toml", "--seed", "17"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("seed 17"));
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
