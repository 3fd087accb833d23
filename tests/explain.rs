//! Tests of commands that look at configurations without running them: `check`, `explain`, and base files.

use crate::support::{measured, result, root, trainer};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn text(arguments: &[&str]) -> String {
    let output = trainer(arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {said}");
    String::from_utf8(output.stdout).unwrap()
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&text(&[arguments, &["--json"]].concat())).unwrap()
}

/// Runs the program and returns the message of a refusal: exit code 2, one line.
fn refusal(arguments: &[&str]) -> String {
    let output = trainer(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty());
    assert_eq!(message.trim_end().lines().count(), 1, "{message}");
    message
}

/// The shipped configuration of one method has that method's defaults, as in the paper's table and in
/// comparisons.
#[test]
fn shipped_configurations_write_an_estimators_defaults() {
    let mut compared = 0;
    for entry in std::fs::read_dir(root().join("configs")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        if !std::fs::read_to_string(&path).unwrap().contains("\n[estimator]") {
            continue;
        }
        let explained = json(&["explain", path.to_str().unwrap()]);
        for setting in explained["settings"].as_array().unwrap() {
            let key = setting["key"].as_str().unwrap();
            if key.starts_with("estimator.") && key != "estimator.name" && !setting["default"].is_null() {
                let number = |of: &str| setting[of].as_f64().ok_or(&setting[of]);
                assert_eq!(number("value"), number("default"), "{}: {key}", path.display());
                compared += 1;
            }
        }
    }
    assert!(compared > 50, "{compared}");
}

/// Creates files in a scratch folder, by name.
fn files(contents: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in contents {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    folder
}

fn path(folder: &TempDir, name: &str) -> String {
    folder.path().join(name).to_str().unwrap().to_owned()
}

#[test]
fn every_shipped_configuration_can_be_checked_and_names_its_task() {
    let mut tasks = std::collections::BTreeSet::new();
    for entry in std::fs::read_dir(root().join("configs")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        // Some configurations use measured records beside the project, which may be absent.
        let needs = text.lines().find_map(|line| line.strip_prefix("path = \"../../shared/data/"));
        if needs.is_some_and(|rest| measured(rest.split('"').next().unwrap()).is_none()) {
            let task = text.lines().find_map(|line| line.strip_prefix("task = "));
            tasks.extend(task.map(|task| task.trim_matches('"').to_owned()));
            continue;
        }
        let checked = json(&["check", path.to_str().unwrap()]);
        tasks.insert(checked["task"].as_str().unwrap().to_owned());
        assert!(!checked["plan"].as_array().unwrap().is_empty(), "{checked}");
    }
    let tasks: Vec<&str> = tasks.iter().map(String::as_str).collect();
    assert_eq!(tasks, ["compare", "estimate", "learn", "predict", "simulate", "trials"]);
}

#[test]
fn a_check_says_what_would_run_and_writes_nothing() {
    let runs = root().join("reports/runs");
    let count = || std::fs::read_dir(&runs).map(Iterator::count).unwrap_or(0);
    let before = count();
    let said = text(&["check", "configs/pinn.toml", "seed=3", "fit.seeds=4"]);
    for words in ["(pinn)", "4, from 3 on", "experiments/default-record/record.csv: ", "samples, simulated"] {
        assert!(said.contains(words), "no `{words}` in {said}");
    }
    assert!(count() <= before);
}

/// A check refuses the same configurations as a run, in the same words.
#[test]
fn a_check_refuses_what_a_run_refuses() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    for arguments in [
        &["configs/pinn.toml", "estimator.hiden=3"][..],
        &["configs/pinn.toml", "data.path=nowhere.csv"],
        &["configs/paper.toml", "compare.methods=olz"],
        &["configs/beyond.toml", "predict.block_peaks=60"],
        &["configs/default-record.toml", "record.seconds=0.03"],
        &["configs/trials-quick.toml", "system.lowest_frequency_hz=50"],
        &["configs/nowhere.toml"],
    ] {
        let checked = refusal(&[&["check"], arguments].concat());
        let run = refusal(&[arguments, &["--out", out.to_str().unwrap()]].concat());
        assert_eq!(checked, run);
    }
}

#[test]
fn a_key_is_explained_with_its_place_range_unit_meaning_and_source() {
    let key = "fit.tolerance_percent";
    let said = text(&["explain", key, "configs/pinn.toml"]);
    for words in [
        "configs/pinn.toml:",
        "from 0 to 1000000000",
        "unit      %",
        "from closed-form least squares",
        "the paper's bar",
    ] {
        assert!(said.contains(words), "no `{words}` in {said}");
    }
    let origin = |arguments: &[&str]| json(arguments)["origin"].clone();
    assert_eq!(
        origin(&["explain", key, "configs/pinn.toml", "fit.tolerance_percent=2"])["command_line"],
        "fit.tolerance_percent=2"
    );
    assert_eq!(origin(&["explain", "data.quantity", "configs/pinn.toml"]), "default");
    assert_eq!(origin(&["explain", key, "configs/pinn.toml"])["file"], "configs/pinn.toml");
}

#[test]
fn a_key_that_is_not_there_gets_the_nearest() {
    let message = refusal(&["explain", "estimator.hiden", "configs/pinn.toml"]);
    assert!(message.contains("did you mean `estimator.hidden`?"), "{message}");
}

#[test]
fn all_keys_are_listed_in_aligned_columns() {
    let said = text(&["explain", "configs/pinn.toml", "seed=3"]);
    let lines: Vec<&str> = said.lines().collect();
    let column = lines[0].find("from").unwrap();
    let seed = lines.iter().find(|line| line.trim_start().starts_with("seed ")).unwrap();
    assert_eq!(&seed[column..], "command line: `seed=3`");
    let listed = json(&["explain", "configs/pinn.toml"]);
    assert_eq!(listed["settings"].as_array().unwrap().len() + 1, lines.len());
    let table = json(&["explain", "envelope", "configs/pinn.toml"]);
    let keys: Vec<&str> =
        table["settings"].as_array().unwrap().iter().map(|row| row["key"].as_str().unwrap()).collect();
    assert!(keys.contains(&"envelope.pipeline") && keys.contains(&"envelope.paper.peak_distance"));
    assert!(keys.iter().all(|key| key.starts_with("envelope.")), "{keys:?}");
}

#[test]
fn a_value_of_a_base_is_explained_with_its_own_place() {
    let folder = files(&[
        ("groups/rig.toml", "seed = 5\n[envelope]\npipeline = \"paper\"\n"),
        ("groups/method.toml", "[estimator]\nname = \"ols\"\n"),
        ("main.toml", "base = [\"groups/rig.toml\", \"groups/method.toml\"]\n[fit]\nseeds = 2\n"),
    ]);
    let main = path(&folder, "main.toml");
    let explained = json(&["explain", "envelope.pipeline", &main]);
    assert_eq!(explained["origin"]["file"], path(&folder, "groups/rig.toml"));
    assert_eq!(explained["origin"]["line"], 3);
    assert_eq!(json(&["explain", "fit.seeds", &main])["origin"]["file"], main.as_str());

    // The run's folder is independent of the three files.
    let (code, composed, run) = result(&[&main]);
    assert_eq!(code, 0, "{composed}");
    let config = path(&run, "config.toml");
    drop(folder);
    let (code, again, _) = result(&[&config]);
    assert_eq!(code, 0);
    assert_eq!(composed["estimate"], again["estimate"]);
    assert_eq!(again["seed"], 5);
}

#[test]
fn bases_in_a_circle_or_absent_are_refused_with_their_place() {
    let folder = files(&[
        ("a.toml", "base = \"b.toml\"\n"),
        ("b.toml", "\n  base = \"a.toml\"\n"),
        ("c.toml", "base = \"absent.toml\"\n"),
        ("d.toml", "base = \"e.toml\"\n[estimator]\nname = \"ols\"\n"),
        ("e.toml", "[fit]\nsedes = 3\n"),
    ]);
    let message = refusal(&["check", &path(&folder, "a.toml")]);
    assert!(message.contains("b.toml:2:3: `base` leads back to where it started"), "{message}");
    let message = refusal(&["check", &path(&folder, "c.toml")]);
    assert!(message.contains("c.toml:1:1: the base ") && message.contains("absent.toml"), "{message}");
    let message = refusal(&["check", &path(&folder, "d.toml")]);
    assert!(message.contains("e.toml:2:1: unknown key `fit.sedes`; did you mean `fit.seeds`?"), "{message}");
    assert!(Path::new(&path(&folder, "a.toml")).exists());
}
