//! Tests of `trainer list runs` and `trainer compare`: many runs, one of them broken.

use crate::support::trainer;
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Instant;

fn run(folder: &Path, arguments: &[&str]) -> PathBuf {
    let out = folder.to_path_buf();
    let output = trainer(&[arguments, &["--quiet", "--out", out.to_str().unwrap()]].concat());
    assert!(output.status.code().unwrap() <= 1, "{}", String::from_utf8_lossy(&output.stderr));
    out
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)))
}

fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Creates three runs, one with a truncated result, one without a result, and an empty folder.
fn runs() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    run(&folder.path().join("first"), &["configs/lstm.toml", "seed=3"]);
    run(&folder.path().join("second"), &["configs/lstm.toml", "seed=12"]);
    run(&folder.path().join("third"), &["configs/ols.toml", "fit.tolerance_percent=0.5"]);
    let cut = run(&folder.path().join("cut"), &["configs/ols.toml"]);
    let result = std::fs::read_to_string(cut.join("result.json")).unwrap();
    std::fs::write(cut.join("result.json"), &result[..result.len() / 2]).unwrap();
    let unfinished = run(&folder.path().join("unfinished"), &["configs/ols.toml"]);
    std::fs::remove_file(unfinished.join("result.json")).unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    folder
}

#[test]
fn one_broken_run_is_one_red_row_in_list_and_table() {
    let folder = runs();
    let root = folder.path().to_str().unwrap();
    let output = trainer(&["list", "runs", root, "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let listed = json(&output);
    let rows = listed["runs"].as_array().unwrap();
    let state = |name: &str| {
        let row = rows.iter().find(|row| row["name"] == name).unwrap();
        (row["state"].as_str().unwrap().to_owned(), row["reason"].as_str().unwrap().to_owned())
    };
    assert_eq!(rows.len(), 6);
    for name in ["first", "second", "third"] {
        assert_eq!(state(name).0, "done");
    }
    assert_eq!(state("unfinished").0, "unfinished");
    for (name, says) in [("cut", "result.json: EOF"), ("empty", "no file of a run is in it")] {
        let (state, reason) = state(name);
        assert!(state == "corrupt" && reason.contains(says), "{name}: {state}, {reason}");
    }
    // The newest run comes first.
    let times: Vec<&str> = rows.iter().map(|row| row["began"].as_str().unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[0] >= pair[1]), "{times:?}");
    let shown = text(&trainer(&["list", "runs", root]));
    assert!(shown.contains("CORRUPT") && shown.contains("3 done") && shown.contains("2 corrupt"), "{shown}");

    let output = trainer(&["compare", root, "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let table = json(&output);
    assert_eq!((&table["done"], &table["failed"], &table["open"]), (&3.into(), &2.into(), &1.into()));
    assert_eq!(table["rows"].as_array().unwrap().len(), 6);
    let columns = table["columns"].as_array().unwrap();
    assert!(
        columns.contains(&"seed".into()) && columns.contains(&"fit.tolerance_percent".into()),
        "{columns:?}"
    );
    // Keys that only another estimator has are not columns.
    assert!(columns.iter().all(|key| !key.as_str().unwrap().starts_with("estimator.")), "{columns:?}");
}

#[test]
fn a_table_is_sorted_and_printed_in_every_form() {
    let folder = runs();
    let pattern = format!("{}/*", folder.path().display());
    let order = |arguments: &[&str]| -> Vec<String> {
        let table = json(&trainer(&[&["compare", &pattern, "--json"], arguments].concat()));
        let rows = table["rows"].as_array().unwrap();
        rows.iter().map(|row| row["run"].as_str().unwrap().rsplit('/').next().unwrap().to_owned()).collect()
    };
    let seeds = order(&["--sort", "seed"]);
    assert!(
        seeds.iter().position(|run| run == "first") < seeds.iter().position(|run| run == "second"),
        "{seeds:?}"
    );
    let errors = order(&["--sort", "error", "--reverse"]);
    assert!(errors[..3].iter().all(|run| ["first", "second", "third"].contains(&run.as_str())), "{errors:?}");
    let refused = trainer(&["compare", &pattern, "--sort", "sead"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no such column"));

    let csv = text(&trainer(&["compare", &pattern, "--format", "csv"]));
    assert_eq!(csv.lines().count(), 7, "{csv}");
    let markdown = text(&trainer(&["compare", &pattern, "--format", "md"]));
    assert!(markdown.contains("| run |") && markdown.contains("**CORRUPT**"), "{markdown}");
    assert!(text(&trainer(&["compare", &pattern, "--format", "html"])).starts_with("<!DOCTYPE html>"));
    let out = folder.path().join("out");
    let written = trainer(&["compare", &pattern, "--quiet", "--out", out.to_str().unwrap()]);
    assert!(written.status.success() && written.stdout.is_empty());
    assert_eq!(std::fs::read_to_string(out.join("table.csv")).unwrap(), csv);
    for name in ["report.html", "table.md", "result.json"] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

#[test]
fn sweeps_and_comparisons_of_methods_go_into_the_same_table() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = folder.path().join("sweep");
    run(&sweep, &["sweep", "configs/ols.toml", "seed=0,1"]);
    let methods = run(&folder.path().join("methods"), &["configs/compare.toml", "compare.methods=qr,svd"]);
    let paths = [sweep.to_str().unwrap(), methods.to_str().unwrap()];
    let table = json(&trainer(&[&["compare", "--json"], &paths[..]].concat()));
    let estimators: Vec<&str> =
        table["rows"].as_array().unwrap().iter().map(|row| row["estimator"].as_str().unwrap()).collect();
    assert_eq!(estimators, ["ols", "ols", "qr", "svd"]);
    assert_eq!(table["done"], 3);
    // The result of one run of the sweep is removed.
    let lost = std::fs::read_dir(sweep.join("runs")).unwrap().next().unwrap().unwrap().path();
    std::fs::remove_file(lost.join("result.json")).unwrap();
    let table = json(&trainer(&["compare", paths[0], "--json"]));
    let states: Vec<&str> =
        table["rows"].as_array().unwrap().iter().map(|row| row["state"].as_str().unwrap()).collect();
    assert!(states.contains(&"corrupt") && states.contains(&"done"), "{states:?}");
    // A listing shows the sweep as one entry, and lists its runs if the sweep is named.
    let listed = json(&trainer(&["list", "runs", folder.path().to_str().unwrap(), "--json"]));
    let rows = listed["runs"].as_array().unwrap();
    let row = rows.iter().find(|row| row["name"] == "sweep").unwrap();
    assert_eq!((&row["task"], &row["summary"]), (&"sweep".into(), &"2 of 2 done, 0 failed".into()));
    let inside = json(&trainer(&["list", "runs", paths[0], "--json"]));
    assert_eq!(inside["runs"].as_array().unwrap().len(), 2);
}

#[test]
fn what_is_not_there_is_named() {
    for (arguments, says) in [
        (&["compare", "no-such-run"][..], "no-such-run: there is no such folder"),
        (&["compare", "no-such-*"], "nothing matches the pattern"),
        (&["compare", "a[b"], "not a pattern"),
        (&["list", "runs", "no-such-folder"], "no-such-folder: cannot list"),
        (&["list", "effects", "somewhere"], "takes no folder"),
    ] {
        let output = trainer(arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(says), "{message}");
    }
}

/// Lists a thousand runs, one of them truncated: 999 rows and a red one. The test prints the time that takes:
///
/// `cargo test --release -p trainer --test acceptance thousand -- --ignored`
#[test]
#[ignore = "makes a thousand folders"]
fn a_thousand_runs_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let one = run(&folder.path().join("pinn-0000"), &["configs/pinn.toml", "fit.max_steps=3"]);
    for number in 1..1000 {
        let copy = folder.path().join(format!("pinn-{number:04}"));
        std::fs::create_dir(&copy).unwrap();
        for name in ["config.toml", "result.json", "events.jsonl", "environment.json", "trace.csv"] {
            std::fs::copy(one.join(name), copy.join(name)).unwrap();
        }
    }
    let result = std::fs::read_to_string(one.join("result.json")).unwrap();
    std::fs::write(folder.path().join("pinn-0500/result.json"), &result[..100]).unwrap();
    let start = Instant::now();
    let output = trainer(&["list", "runs", folder.path().to_str().unwrap(), "--json"]);
    let seconds = start.elapsed().as_secs_f64();
    let listed = json(&output);
    let rows = listed["runs"].as_array().unwrap();
    let of = |state: &str| rows.iter().filter(|row| row["state"] == state).count();
    assert_eq!((of("done"), of("corrupt")), (999, 1));
    let said = format!("1000 runs listed in {seconds:.3} s\n");
    std::io::stderr().write_all(said.as_bytes()).unwrap();
}
