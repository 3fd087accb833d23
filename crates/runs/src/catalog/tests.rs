use super::{KeptRun, list_runs, read_run};
use crate::folder::RunFolder;
use crate::sweep::SweepFolder;
use results::{RunState, SWEEP_SCHEMA, SweepEnd, SweepState};
use serde_json::{Value, json};
use std::path::Path;

/// Creates a run folder that contains these files.
fn run(root: &Path, name: &str, files: &[(&str, &str)]) -> RunFolder {
    let folder = RunFolder::create_at(&root.join(name)).unwrap();
    for (file, text) in files {
        folder.write(file, text.as_bytes()).unwrap();
    }
    folder
}

#[test]
fn every_state_is_told_from_the_others() {
    let root = tempfile::tempdir().unwrap();
    let simulated = "{\"schema\":\"ringdown.result/1\",\"task\":\"simulate\"}";
    let diagnosed =
        "{\"schema\":\"ringdown.diagnosis/1\",\"verdict\":{\"status\":\"effect\",\"effects\":[\"gravity\"]}}";
    let config = ("config.toml", "task = \"estimate\"\n[estimator]\nname = \"pinn\"\n");
    run(root.path(), "done", &[config, ("result.json", simulated)]);
    run(root.path(), "diagnosed", &[("diagnosis.json", diagnosed)]);
    run(root.path(), "unfinished", &[config]);
    run(root.path(), "failed", &[config]).record_event("failed", &json!({ "message": "too few" })).unwrap();
    run(root.path(), "empty", &[]);
    run(root.path(), "cut", &[config, ("result.json", &simulated[..20])]);
    run(root.path(), "foreign", &[config, ("result.json", "{\"schema\":\"other/1\"}")]);
    run(root.path(), "bare", &[("result.json", simulated)]);
    run(root.path(), "garbled", &[("config.toml", "a = ["), ("result.json", simulated)]);
    run(root.path(), "torn", &[config]);
    std::fs::write(root.path().join("torn/result.json"), [0xff, 0xfe]).unwrap();
    run(root.path(), ".hidden", &[]);
    std::fs::write(root.path().join("a file"), "").unwrap();
    std::fs::create_dir(root.path().join("photographs")).unwrap();
    std::fs::write(root.path().join("photographs/rig.jpg"), [0xff, 0xd8]).unwrap();
    let expected = [
        ("bare", RunState::Corrupt, "config.toml is missing"),
        ("cut", RunState::Corrupt, "result.json: EOF"),
        ("diagnosed", RunState::Done, ""),
        ("done", RunState::Done, ""),
        ("empty", RunState::Corrupt, "no file of a run"),
        ("failed", RunState::Failed, "too few"),
        ("foreign", RunState::Corrupt, "\"other/1\""),
        ("garbled", RunState::Corrupt, "config.toml:1:"),
        ("torn", RunState::Corrupt, "result.json: "),
        ("unfinished", RunState::Unfinished, "no result yet"),
    ];
    let mut runs = list_runs(root.path()).unwrap();
    runs.sort_by(|one, other| one.name.cmp(&other.name));
    assert_eq!(runs.len(), expected.len());
    for (run, (name, state, reason)) in runs.iter().zip(expected) {
        assert_eq!((run.name.as_str(), run.state), (name, state), "{run:?}");
        assert!(run.reason.contains(reason), "{run:?}");
        assert!(run.started.is_some());
    }
    assert_eq!(runs[2].summary, "effect: gravity");
    assert_eq!((runs[9].estimator.as_str(), runs[9].task.as_str()), ("pinn", "estimate"));
}

#[test]
fn the_newest_comes_first() {
    let root = tempfile::tempdir().unwrap();
    for (name, year) in [("b", 2024), ("a", 2025), ("c", 2023)] {
        let line =
            format!("{{\"time\":\"{year}-01-01T00:00:00Z\",\"event\":\"start\",\"details\":{{}}}}\n{{\"ti");
        run(root.path(), name, &[("events.jsonl", &line)]);
    }
    let names: Vec<String> = list_runs(root.path()).unwrap().into_iter().map(|run| run.name).collect();
    assert_eq!(names, ["a", "b", "c"]);
}

#[test]
fn a_folder_that_cannot_be_listed_is_an_error_with_its_name() {
    let root = tempfile::tempdir().unwrap();
    let message = list_runs(&root.path().join("absent")).unwrap_err().to_string();
    assert!(message.contains("absent: cannot list"), "{message}");
    assert_eq!(read_run(&root.path().join("absent")).state, RunState::Corrupt);
}

const CONFIG: (&str, &str) = ("config.toml", "task = \"estimate\"\n[estimator]\nname = \"pinn\"\n");

/// Fields that all results share, each number with a different value.
fn shared(task: &str) -> Value {
    json!({
        "schema": "ringdown.result/1", "task": task, "seed": 3, "error_percent": 0.31, "worst_error_percent": 0.32,
        "tolerance_percent": 0.33, "pass": true, "seconds": 0.34, "pipelines": [],
        "data": {
            "path": "record.csv", "digest": "sha256:0", "origin": "measured", "samples": 11, "clock": "host",
            "clock_reason": "", "believed_clock": "host", "believed_clock_reason": "", "sample_period_s": 0.11,
            "sample_rate_hz": 0.12, "sample_rate_std_error_hz": 0.13, "resolution": null, "unit": "rad", "findings": []
        },
        "envelope": {
            "pipeline": "paper", "peaks": 12, "samples": 13, "period_s": 0.14, "omega_rad_s": 0.15, "offset": 0.16,
            "first_peak_s": 0.17
        },
        "oracle": {
            "decay_rate": 0.21, "log_amplitude": 0.22, "r_squared": 0.23, "zeta": 0.24, "std_error": 0.25,
            "interval_95": [0.26, 0.27], "zeta_std_error": 0.28, "zeta_interval_95": [0.281, 0.282], "condition": 0.29,
            "promised_digits": 15.0, "residual_autocorrelation": 0.291
        }
    })
}

fn with(mut result: Value, more: Value) -> Value {
    result.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    result
}

/// Estimation result that ended in state `reached`, with one other seed that ended in state `other`.
fn estimation(reached: &str, other: &str) -> Value {
    let seed = json!({
        "seed": 4, "decay_rate": 0.51, "zeta": 0.52, "error_percent": 0.53, "reached": other, "steps": 54, "seconds": 0.55
    });
    let estimate = json!({
        "decay_rate": 0.41, "log_amplitude": 0.42, "zeta": 0.43, "std_error": 0.44, "interval_95": [0.45, 0.46],
        "zeta_std_error": 0.47, "zeta_interval_95": [0.48, 0.49], "reached": reached, "stopped_because": ""
    });
    with(
        shared("estimate"),
        json!({
            "estimator": "gp", "estimator_title": "", "steps": 61, "parameters": 62, "estimate": estimate, "seeds": [seed]
        }),
    )
}

fn method(id: &str, outcome: Value) -> Value {
    json!({ "number": null, "id": id, "title": "", "family": "classical", "outcome": outcome })
}

fn fitted(reached: &str) -> Value {
    json!({ "estimate": {
        "decay_rate": 0.71, "zeta": 0.72, "zeta_std_error": 0.73, "error_percent": 0.74, "median_error_percent": 0.75,
        "worst_error_percent": 0.76, "digits_of_agreement": 7.0, "seeds": 2, "steps": 77, "parameters": 78,
        "seconds": 0.79, "reached": reached, "stopped_because": "", "pass": true
    } })
}

fn comparison(methods: Vec<Value>) -> Value {
    let derived = json!({
        "period_s": 1.0, "frequency_hz": 1.0, "inertia_kg_m2": 1.0, "stiffness_n_m_per_rad": 1.0,
        "damping_n_m_s_per_rad": 1.0, "critical_damping_n_m_s_per_rad": 1.0, "quality_factor": 1.0,
        "cycles_to_one_over_e": 1.0, "half_life_s": 1.0, "time_constant_s": 1.0
    });
    let more = json!({ "seeds": 2, "derived": derived, "results": methods, "max_error_percent": 0.8, "cautions": [] });
    with(shared("compare"), more)
}

fn kept(root: &Path, result: &Value) -> KeptRun {
    let name = format!("{}", std::fs::read_dir(root).unwrap().count());
    read_run(run(root, &name, &[CONFIG, ("result.json", &result.to_string())]).path())
}

/// Asserts that each named field of a row equals the value at its place in the result, and that every other
/// field is empty.
fn holds(run: &KeptRun, row: usize, result: &Value, places: &[(&str, &str)]) {
    let row = serde_json::to_value(&run.rows[row]).unwrap();
    for (name, found) in row.as_object().unwrap() {
        let place = places.iter().find(|(known, _)| known == name);
        match (name.as_str(), place) {
            ("run", None) => assert_eq!(found, &json!(run.path)),
            ("state", None) => assert_eq!(found, run.state.name()),
            ("settings", None) => assert_eq!(found, &json!({})),
            (_, None) => assert!(found.is_null() || found == "", "{name}: {found}"),
            (_, Some((_, place))) => assert_eq!(Some(found), result.pointer(place), "{name}"),
        }
    }
}

#[test]
fn a_row_of_an_estimation_says_what_its_result_says() {
    let root = tempfile::tempdir().unwrap();
    let result = estimation("converged", "converged");
    let run = kept(root.path(), &result);
    assert_eq!((run.state, run.task.as_str(), run.estimator.as_str()), (RunState::Done, "estimate", "gp"));
    assert_eq!(run.rows.len(), 1);
    holds(
        &run,
        0,
        &result,
        &[
            ("task", "/task"),
            ("estimator", "/estimator"),
            ("origin", "/data/origin"),
            ("zeta", "/estimate/zeta"),
            ("zeta_std_error", "/estimate/zeta_std_error"),
            ("zeta_interval_95", "/estimate/zeta_interval_95"),
            ("decay_rate", "/estimate/decay_rate"),
            ("oracle_zeta", "/oracle/zeta"),
            ("error_percent", "/error_percent"),
            ("worst_error_percent", "/worst_error_percent"),
            ("tolerance_percent", "/tolerance_percent"),
            ("reached", "/estimate/reached"),
            ("steps", "/steps"),
            ("parameters", "/parameters"),
            ("seconds", "/seconds"),
            ("pass", "/pass"),
        ],
    );
}

/// JSON has no number for the error relative to an oracle estimate of zero, so that error is `null`.
#[test]
fn null_is_no_number_and_not_absent() {
    let root = tempfile::tempdir().unwrap();
    let null = json!({ "error_percent": null });
    let run = kept(root.path(), &with(estimation("converged", "converged"), null));
    assert_eq!(run.state, RunState::Done, "{}", run.reason);
    assert!(run.rows[0].error_percent.unwrap().is_nan());
    assert_eq!(run.rows[0].worst_error_percent, Some(0.32));
}

#[test]
fn a_comparison_has_a_row_for_each_method_with_its_estimate_or_why_there_is_none() {
    let root = tempfile::tempdir().unwrap();
    let failed = method("svd", json!({ "failed": { "reason": "too few peaks" } }));
    let result = comparison(vec![method("ols", fitted("converged")), failed]);
    let run = kept(root.path(), &result);
    assert_eq!(
        (run.state, run.task.as_str(), run.estimator.as_str()),
        (RunState::Done, "compare", "2 methods")
    );
    assert_eq!(run.rows.len(), 2);
    let shared = [
        ("task", "/task"),
        ("origin", "/data/origin"),
        ("oracle_zeta", "/oracle/zeta"),
        ("tolerance_percent", "/tolerance_percent"),
    ];
    let of = |row: usize, own: &[(&str, &str)]| {
        let own: Vec<_> = own.iter().map(|(name, at)| (*name, format!("/results/{row}{at}"))).collect();
        let own = own.iter().map(|(name, at)| (*name, at.as_str()));
        let places: Vec<_> = shared.into_iter().chain(own).collect();
        holds(&run, row, &result, &places);
    };
    of(
        0,
        &[
            ("estimator", "/id"),
            ("zeta", "/outcome/estimate/zeta"),
            ("zeta_std_error", "/outcome/estimate/zeta_std_error"),
            ("decay_rate", "/outcome/estimate/decay_rate"),
            ("error_percent", "/outcome/estimate/error_percent"),
            ("worst_error_percent", "/outcome/estimate/worst_error_percent"),
            ("reached", "/outcome/estimate/reached"),
            ("steps", "/outcome/estimate/steps"),
            ("parameters", "/outcome/estimate/parameters"),
            ("seconds", "/outcome/estimate/seconds"),
            ("pass", "/outcome/estimate/pass"),
        ],
    );
    // A method without an estimate has not passed.
    assert_eq!(run.rows[1].pass, Some(false));
    let result = with(result.clone(), json!({ "no": false }));
    let run = kept(root.path(), &result);
    let places =
        [("estimator", "/results/1/id"), ("reason", "/results/1/outcome/failed/reason"), ("pass", "/no")];
    holds(&run, 1, &result, &[&shared[..], &places[..]].concat());
}

#[test]
fn a_result_that_was_cut_off_anywhere_is_interrupted() {
    let root = tempfile::tempdir().unwrap();
    let failed = |reason: &str| method("svd", json!({ "failed": { "reason": reason } }));
    for (result, state) in [
        (estimation("converged", "budget_spent"), RunState::Done),
        (estimation("interrupted", "converged"), RunState::Interrupted),
        (estimation("converged", "interrupted"), RunState::Interrupted),
        (comparison(vec![method("ols", fitted("stalled")), failed("too few peaks")]), RunState::Done),
        (
            comparison(vec![method("ols", fitted("interrupted")), failed("too few peaks")]),
            RunState::Interrupted,
        ),
        (
            comparison(vec![
                method("ols", fitted("stalled")),
                failed(&results::Failure::NotBegun.to_string()),
            ]),
            RunState::Interrupted,
        ),
    ] {
        let run = kept(root.path(), &result);
        assert_eq!(run.state, state, "{result}");
        assert!(run.rows.iter().all(|row| row.state == state));
    }
}

#[test]
fn without_a_result_the_last_event_says_why() {
    let root = tempfile::tempdir().unwrap();
    for (name, event, state, says) in [
        ("stopped", "interrupted", RunState::Interrupted, "stopped before it had a result"),
        ("running", "start", RunState::Unfinished, "no result yet"),
        ("silent", "failed", RunState::Failed, "no reason was kept"),
    ] {
        let folder = run(root.path(), name, &[CONFIG]);
        folder.record_event(event, &json!({ "steps": 1 })).unwrap();
        let found = read_run(folder.path());
        assert_eq!(found.state, state);
        assert!(found.reason.contains(says), "{found:?}");
        // One row, with the fields that are known without a result.
        let [row] = &found.rows[..] else { panic!("{:?}", found.rows) };
        assert_eq!((row.task.as_str(), row.estimator.as_str()), ("estimate", "pinn"));
        assert_eq!(
            (row.state, &row.reason, &row.run),
            (state, &found.reason, &folder.path().display().to_string())
        );
    }
}

#[test]
fn when_it_began_is_told_to_the_second() {
    let root = tempfile::tempdir().unwrap();
    let line = "{\"time\":\"2026-03-04T05:06:07.89Z\",\"event\":\"start\",\"details\":{}}\n";
    let began = read_run(run(root.path(), "a", &[("events.jsonl", line)]).path()).began();
    assert_eq!(began, "2026-03-04 05:06:07");
    assert_eq!(read_run(&root.path().join("absent")).began(), "");
}

/// Sweep of four runs that ended in these states; `None` for a run that has not ended.
fn swept(path: &Path, ends: [Option<SweepState>; 4]) -> KeptRun {
    let digest = |at: usize| format!("sha256:{at:064}");
    let line = |at: usize| {
        json!({
            "number": at + 1, "digest": digest(at), "overrides": [], "config": "", "state": "pending", "run": null,
            "message": null
        })
    };
    let axis = |key: &str| json!({ "key": key, "values": ["1", "2"] });
    let manifest = json!({
        "schema": SWEEP_SCHEMA, "name": "", "config": "", "version": "", "records": [],
        "axes": [axis("seed"), axis("noise")], "runs": (0..4).map(line).collect::<Vec<_>>()
    });
    std::fs::create_dir(path).unwrap();
    std::fs::write(path.join("sweep.json"), manifest.to_string()).unwrap();
    for (at, state) in ends.into_iter().enumerate() {
        if let Some(state) = state {
            let end = SweepEnd { digest: digest(at), state, run: None, message: None };
            SweepFolder::open(path).end_run(&end).unwrap();
        }
    }
    read_run(path)
}

#[test]
fn a_sweep_is_one_entry_that_is_done_when_every_run_came_to_its_end() {
    use SweepState::{Done, Failed, Interrupted};
    let root = tempfile::tempdir().unwrap();
    let cases = [
        ([Some(Done), Some(Done), Some(Failed), Some(Failed)], RunState::Done, "2 of 4 done, 2 failed"),
        ([Some(Done), Some(Done), Some(Done), Some(Failed)], RunState::Done, "3 of 4 done, 1 failed"),
        ([Some(Done), Some(Done), None, Some(Failed)], RunState::Unfinished, "2 of 4 done, 1 failed"),
        ([Some(Done), Some(Interrupted), None, None], RunState::Interrupted, "1 of 4 done, 0 failed"),
        ([None; 4], RunState::Unfinished, "0 of 4 done, 0 failed"),
    ];
    for (at, (ends, state, summary)) in cases.into_iter().enumerate() {
        let found = swept(&root.path().join(at.to_string()), ends);
        assert_eq!((found.state, found.summary.as_str()), (state, summary));
        assert_eq!((found.task.as_str(), found.estimator.as_str()), ("sweep", "over seed, noise"));
        assert_eq!((found.rows.len(), found.rows[0].state), (1, state));
    }
}

#[test]
fn every_learner_of_a_study_is_a_row_with_its_scores() {
    let row = |id: &str, kind: &str, error: Value| {
        json!({ "problem": "drag", "id": id, "title": id, "kind": kind, "coefficients": null, "equation": null,
                "torque_error": null, "parameters": 7, "seconds": 1.5, "reached": "converged", "failure": null,
                "model": null, "validation": { "free_run_rmse": 0.1, "over_noise": 2.0 },
                "test": { "free_run_rmse": 0.25, "unit": "rad", "over_noise": error, "horizon_s": 3.5,
                          "one_step_rmse": null, "coverage_95": null } })
    };
    let mut failed = row("lstm", "learner", Value::Null);
    (failed["test"], failed["reached"]) = (Value::Null, json!("failed"));
    failed["failure"] = json!("no stretch");
    let data = json!({ "records": 1, "train": 1, "validation": 1, "test": 1 });
    let result = json!({ "schema": "ringdown.result/1", "task": "learn", "seed": 0, "data": data, "seconds": 2.0,
                         "problems": [], "results": [row("sindy", "learner", json!(4.0)), failed,
                                                     row("arx", "baseline", json!(9.0))] });
    let root = tempfile::tempdir().unwrap();
    let config = ("config.toml", "task = \"learn\"\n");
    run(root.path(), "study", &[config, ("result.json", &result.to_string())]);
    let read = read_run(&root.path().join("study"));
    let rows: Vec<&str> = read.rows.iter().map(|row| row.estimator.as_str()).collect();
    assert_eq!(rows, ["sindy", "lstm"], "{}", read.reason);
    let scores = read.rows[0].learned.as_ref().unwrap();
    assert_eq!((scores.validation_over_noise, scores.test_over_noise), (Some(2.0), Some(4.0)));
    assert_eq!((read.rows[1].reason.as_str(), &read.rows[1].learned), ("no stretch", &None));
}
