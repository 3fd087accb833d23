//! What the documents say holds.

use crate::support::{measured, result, root, trainer};
use std::path::PathBuf;

fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn source_files_stay_readable_in_length() {
    for path in files("crates", "rs").into_iter().chain(files("tests", "rs")) {
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= 520, "{} has {lines} lines", path.display());
    }
}

#[test]
fn the_help_shows_the_exit_codes_and_examples() {
    let output = trainer(&["--help"]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    for words in ["configs/pinn.toml", "Exit codes", "130 interrupted"] {
        assert!(text.contains(words), "{text}");
    }
}

/// Cuts trials down to three short cases, wherever these come from.
pub(crate) const FEW_TRIALS: &[&str] = &[
    "trials.none=1",
    "trials.calibration=0",
    "trials.single=2",
    "trials.pair=0",
    "trials.left_out=0",
    "trials.foreign=0",
    "trials.releases=0",
    "trials.driven=0",
    "trials.stressed=0",
    "trials.measured_cases=0",
    "trials.engine_cases=0",
    "trials.composite=0",
    "trials.rigs_cases=0",
    "record.seconds=8",
    "record.rate_hz=130",
];

/// Each one as a user would run it, the study of many problems and trials cut short. The null estimator's misses its
/// bar by design.
#[test]
fn every_shipped_configuration_runs() {
    for path in files("configs", "toml") {
        if path.ends_with("beyond.toml") {
            // A record that is absent is no obstacle to it.
            let quick = ["predict.draws=2", "predict.draws_seeded=1", "predict.max_steps=20"];
            let (code, result, _) = result(&[&[path.to_str().unwrap()], &quick[..]].concat());
            assert_eq!(code, 0, "{}: {result}", path.display());
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        if text.contains("task = \"trials\"") {
            let (code, result, _) = result(&[&[path.to_str().unwrap()], FEW_TRIALS].concat());
            assert_eq!(code, 0, "{}: {result}", path.display());
            assert_eq!(result["cases"], 3, "{}", path.display());
            continue;
        }
        if text.contains("task = \"learn\"") {
            let mut quick =
                vec![path.to_str().unwrap(), "learn.max_steps=2", "bayesian.warm_up=2", "bayesian.draws=10"];
            let all = path.ends_with("learn.toml") || path.ends_with("measured.toml");
            quick.extend(all.then_some("learn.learners=sindy,gaussian-process"));
            let (code, result, _) = result(&quick);
            assert_eq!(code, 0, "{}: {result}", path.display());
            continue;
        }
        let needs = text.lines().find_map(|line| line.strip_prefix("path = \"../shared/data/"));
        if needs.is_some_and(|rest| measured(rest.split('"').next().unwrap()).is_none()) {
            continue;
        }
        let (code, result, _) = result(&[path.to_str().unwrap()]);
        let expected = i32::from(path.ends_with("baseline.toml"));
        assert_eq!(code, expected, "{}: {result}", path.display());
    }
}

/// The gate runs the test command of the README, word for word.
#[test]
fn the_gate_runs_the_readmes_test_command() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let gate = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let commands: Vec<&str> = readme
        .lines()
        .filter_map(|line| line.strip_prefix("    "))
        .filter(|line| line.starts_with("cargo "))
        .take(2)
        .collect();
    let [run, test] = commands[..] else { panic!("{commands:?}") };
    assert_eq!(run, "cargo run -p trainer -- configs/pinn.toml");
    assert!(gate.lines().any(|line| line == test), "`{test}` is not a line of .ci/run");
}
