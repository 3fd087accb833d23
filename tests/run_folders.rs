//! Tests of the files of a run, and of their reproducibility.

use crate::support::{number, result, trainer};
use serde_json::Value;

#[test]
fn the_default_run_leaves_a_whole_folder() {
    let (code, result, folder) = result(&["configs/pinn.toml"]);
    assert_eq!(code, 0, "{result}");
    for name in [
        "config.toml",
        "result.json",
        "trace.csv",
        "envelope.csv",
        "model/weights.safetensors",
        "report.html",
        "events.jsonl",
        "environment.json",
    ] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    let kept: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("result.json")).unwrap()).unwrap();
    assert_eq!(kept, result);
    assert_eq!(result["schema"], "ringdown.result/1");
    assert_eq!(result["estimator"], "pinn");
    assert_eq!(result["data"]["origin"], "simulated");
    assert_eq!(result["pass"], true);
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(report.to_lowercase().contains("simulated"));
    let weights = std::fs::read(folder.path().join("model/weights.safetensors")).unwrap();
    let tensors = neural::from_safetensors(&weights).unwrap();
    let count: usize = tensors.iter().map(|tensor| tensor.values.len()).sum();
    assert_eq!(count as f64, number(&result, "/parameters"));
}

#[test]
fn the_resolved_config_runs_again_to_the_same_result() {
    let (_, first, folder) = result(&["configs/pinn.toml", "seed=4", "estimator.hidden=[6]"]);
    let config = folder.path().join("config.toml");
    let (_, second, _) = result(&[config.to_str().unwrap()]);
    assert_eq!(timeless(first), timeless(second));
}

#[test]
fn threads_do_not_change_a_bit() {
    let arguments = ["configs/pinn.toml", "fit.seeds=4", "fit.max_steps=20", "--threads"];
    let run = |threads| timeless(result(&[&arguments[..], &[threads]].concat()).1);
    assert_eq!(run("1"), run("2"));
}

/// Removes the wall times from a result.
fn timeless(mut result: Value) -> Value {
    result["seconds"] = Value::Null;
    for row in result["seeds"].as_array_mut().unwrap() {
        row["seconds"] = Value::Null;
    }
    result
}

#[test]
fn every_seed_is_below_the_bar_and_the_worst_is_reported() {
    let (code, result, _) = result(&["configs/pinn.toml", "fit.seeds=10"]);
    assert_eq!(code, 0);
    let rows = result["seeds"].as_array().unwrap();
    assert_eq!(rows.len(), 10);
    let worst = rows.iter().map(|row| number(row, "/error_percent")).fold(0.0, f64::max);
    assert_eq!(worst, number(&result, "/worst_error_percent"));
    assert!(worst < 1e-4, "worst error {worst} % (1e-6 relative)");
}

#[test]
fn untrained_every_seed_misses_and_the_exit_code_says_so() {
    let (code, result, _) = result(&["configs/pinn.toml", "fit.seeds=10", "fit.max_steps=0"]);
    assert_eq!(code, 1);
    assert_eq!(result["pass"], false);
    for row in result["seeds"].as_array().unwrap() {
        assert!(number(row, "/error_percent") > 1.0, "{row}");
        assert_eq!(row["steps"], 0);
        assert_eq!(row["reached"], "budget_spent");
    }
}

/// A fit that takes minutes is asked to stop after it has started.
#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_its_best_and_exits_with_130() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args(["configs/pinn.toml", "estimator.hidden=[16,16]", "estimator.loss_tolerance=0"])
        .args(["estimator.max_steps=1000000", "estimator.collocation_points=200", "fit.seeds=5"])
        .args(["--quiet", "--out", out.to_str().unwrap()])
        .current_dir(crate::support::root())
        .spawn()
        .unwrap();
    while !out.join("events.jsonl").exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended before it began");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    std::thread::sleep(std::time::Duration::from_millis(500));
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let text = std::fs::read_to_string(out.join("result.json")).unwrap();
    let result: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(result["estimate"]["reached"], "interrupted");
    assert!(result["seeds"].as_array().unwrap().len() < 5);
    assert!(out.join("report.html").is_file());
}

/// If a comparison is asked to stop during its first fit, the other methods do not count as failed.
#[cfg(unix)]
#[test]
fn methods_that_were_not_begun_are_no_failures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args(["configs/compare.toml", "compare.methods=pinn,lstm,transformer,ols", "fit.seeds=200"])
        .args(["--threads", "1", "--out", out.to_str().unwrap()])
        .current_dir(crate::support::root())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    while !out.join("events.jsonl").exists() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    std::thread::sleep(std::time::Duration::from_millis(300));
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let shown = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(130), "{shown}");
    assert!(!shown.contains("FAILED"), "{shown}");
    let waiting =
        shown.lines().find(|line| line.starts_with("interrupted before these were fitted: ")).unwrap();
    assert!(waiting.contains("transformer") && shown.contains("WERE NOT STARTED"), "{shown}");
}

#[test]
fn the_null_estimator_fails_the_bar() {
    let (code, result, folder) = result(&["configs/baseline.toml"]);
    assert_eq!(code, 1);
    assert_eq!(number(&result, "/error_percent"), 100.0);
    assert_eq!(result["estimate"]["std_error"], Value::Null);
    assert!(folder.path().join("report.html").is_file());
    assert!(!folder.path().join("trace.csv").exists());
}

#[test]
fn a_report_made_again_is_the_same_to_the_byte() {
    let (_, _, folder) = result(&["configs/pinn.toml", "fit.max_steps=3"]);
    let report = folder.path().join("report.html");
    let before = std::fs::read(&report).unwrap();
    std::fs::remove_file(&report).unwrap();
    let output = trainer(&["report", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(std::fs::read(&report).unwrap(), before);
}

#[test]
fn a_folder_that_is_no_run_is_told_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("record.csv");
    std::fs::write(&file, "t,angle\n0,1\n").unwrap();
    for (command, place) in
        [("report", folder.path()), ("report", file.as_path()), ("verify", file.as_path())]
    {
        let output = trainer(&[command, place.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2));
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains("is not a finished run: it holds none of its files"), "{message}");
    }
}

#[test]
fn json_prints_the_result_alone_and_quiet_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let arguments = ["configs/pinn.toml", "fit.max_steps=1", "--quiet", "--out", out.to_str().unwrap()];
    let output = trainer(&arguments);
    assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{output:?}");
    assert!(out.join("result.json").is_file());
}

#[test]
fn estimators_are_listed() {
    let output = trainer(&["list", "estimators", "--json"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    let ids: Vec<&str> =
        value["estimators"].as_array().unwrap().iter().map(|row| row["id"].as_str().unwrap()).collect();
    assert!(["baseline", "pinn", "ols"].iter().all(|id| ids.contains(id)), "{ids:?}");
}

/// The configuration of a classical method gives the same result as a comparison.
#[test]
fn a_classical_method_runs_from_its_own_configuration() {
    let (code, single, folder) = result(&["configs/differential-evolution.toml", "fit.seeds=2"]);
    assert_eq!((code, single["seeds"].as_array().unwrap().len()), (0, 2));
    assert!(folder.path().join("report.html").is_file());
    let (_, compared, _) =
        result(&["configs/compare.toml", "compare.methods=differential-evolution", "fit.seeds=2"]);
    let row = &compared["results"][0]["outcome"]["estimate"];
    assert_eq!(row["decay_rate"], single["estimate"]["decay_rate"]);
    assert_eq!(row["worst_error_percent"], single["worst_error_percent"]);
}

/// With both half-cycles and the believed clock, the recommended pipeline finds the simulated oscillator's
/// own frequency; the paper's pipeline misses it because of the host's bursts.
#[test]
fn the_recommended_pipeline_finds_the_simulated_frequency() {
    let (_, result, _) =
        result(&["configs/pinn.toml", "envelope.pipeline=recommended", "data.clock=auto", "fit.max_steps=0"]);
    assert_eq!(result["data"]["clock"], "uniform-index");
    assert!((number(&result, "/data/sample_rate_hz") - 259.6).abs() < 0.1);
    assert!((number(&result, "/envelope/omega_rad_s") / 21.75 - 1.0).abs() < 1e-3);
}
