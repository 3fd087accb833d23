//! Tests of `task = "learn"` and `trainer predict`: dynamics learned from records and scored on unseen
//! records.

use crate::support::{measured, number, result, root, trainer};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

/// One sparse learner with the quick baselines.
const QUICK: [&str; 3] = ["configs/learn/sindy.toml", "sindy.members=10", "sindy.refit_samples=2000"];

/// All baselines except the one that needs a diagnosis.
const QUICK_BASELINES: &str = "learn.baselines=persistence,nominal,recalibrated,arx";

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    let rows = result["results"].as_array().unwrap();
    rows.iter().find(|row| row["id"] == id).unwrap_or_else(|| panic!("no {id}"))
}

#[test]
fn a_study_leaves_scores_models_tables_and_a_page() {
    let (code, result, folder) = result(&QUICK);
    assert_eq!(code, 0, "{result}");
    assert_eq!((&result["schema"], &result["task"]), (&"ringdown.result/1".into(), &"learn".into()));
    assert_eq!(result["data"], serde_json::json!({ "records": 20, "train": 12, "validation": 3, "test": 5 }));
    let error = |id: &str| number(row(&result, id), "/test/free_run_rmse");
    assert!(error("sindy") < 1.2 * error("exact"), "{result}");
    assert!(10.0 * error("sindy") < error("recalibrated") && error("recalibrated") < error("nominal"));
    assert!(error("arx") < error("persistence"));
    let sindy = row(&result, "sindy");
    assert_eq!(sindy["kind"], "learner");
    assert_eq!(row(&result, "exact")["kind"], "reference");
    // The reference `exact` names its coefficients in the simulator's own terms; only a law is compared with
    // the true terms.
    assert!(row(&result, "exact")["coefficients"].get("sign(theta_dot)").is_none(), "{result}");
    let friction = &sindy["coefficients"]["sign(theta_dot)"];
    assert!(
        (number(friction, "/value") + 0.15).abs() < 0.01 && (number(friction, "/truth") + 0.15).abs() < 1e-6
    );
    assert!(number(friction, "/interval_95/0") < number(friction, "/value"));
    for file in ["report.html", "predictions.csv", "series.csv", "trace.csv", "config.toml", "events.jsonl"] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Free runs: Friction and gravity, free (simulated)"));
    for (ablation, words) in [("at-zero", "what it learned at zero"), ("on-noise", "given noise")] {
        let without = row(&result, &format!("sindy:{ablation}"));
        assert_eq!(without["kind"], "ablation");
        assert!(number(without, "/test/free_run_rmse") > 10.0 * error("sindy"), "{without}");
        assert!(page.contains(words), "no {words}");
    }

    let model = folder.path().join(sindy["model"].as_str().unwrap());
    predicts_a_record(&model);
}

/// Applies the model of friction and gravity to a record of that system drawn with another seed.
fn predicts_a_record(model: &Path) {
    let (code, _, records) =
        result(&["simulate", "configs/learn/systems/friction-gravity.toml", "seed=77", "simulate.records=1"]);
    assert_eq!(code, 0);
    let record = records.path().join("records/record-000.csv");
    let out = records.path().join("predicted");
    let arguments = [
        "predict",
        model.to_str().unwrap(),
        record.to_str().unwrap(),
        "--json",
        "--out",
        out.to_str().unwrap(),
    ];
    let output = trainer(&arguments);
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    // The record is from another system with the same priors: its coefficients are the same, its initial
    // states are not.
    assert!(number(&said, "/over_noise") < 2.0, "{said}");
    assert!(out.join("predictions.csv").is_file());
    let refused = trainer(&["predict", record.to_str().unwrap(), record.to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(2));
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(message.contains("expected a model that `task = \"learn\"` wrote"), "{message}");
}

/// A short training is enough: after two epochs the network improves on the linear prediction.
#[test]
fn a_sequence_model_beats_the_autoregression_and_predicts_a_record() {
    let quick =
        ["configs/learn/temporal-convolution.toml", "temporal-convolution.epochs=2", "learn.baselines=arx"];
    let (code, result, folder) = result(&quick);
    assert_eq!(code, 0, "{result}");
    let error = |id: &str| number(row(&result, id), "/test/free_run_rmse");
    assert!(error("temporal-convolution") < 0.8 * error("arx"), "{result}");
    let model = folder.path().join(row(&result, "temporal-convolution")["model"].as_str().unwrap());
    let simulated = crate::support::result(&[
        "simulate",
        "configs/learn/systems/drag-cubic.toml",
        "seed=77",
        "simulate.records=1",
    ]);
    let record = simulated.2.path().join("records/record-000.csv");
    let output = trainer(&["predict", model.to_str().unwrap(), record.to_str().unwrap(), "--json"]);
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(number(&said, "/free_run_rmse") < error("arx"), "{said}");
}

/// A learner that begins with random weights is trained with several seeds; the row is that of the study's own seed.
#[test]
fn several_seeds_of_a_network_stand_beside_the_row_of_the_first() {
    let quick = ["configs/learn/neural-ode.toml", "learn.max_steps=3", "learn.baselines=arx"];
    let redrawn = [&quick[..], &["learn.seeds=3", "learn.redrawn=neural-ode"]].concat();
    let (code, result, folder) = result(&redrawn);
    assert_eq!(code, 0, "{result}");
    let several = row(&result, "neural-ode");
    let draws = several["draws"].as_array().unwrap();
    let errors: Vec<f64> = draws.iter().map(|draw| number(draw, "/free_run_rmse")).collect();
    assert_eq!(draws.iter().map(|draw| number(draw, "/seed")).collect::<Vec<f64>>(), [0.0, 1.0, 2.0]);
    assert!(errors[0] != errors[1] && errors[1] != errors[2], "{errors:?}");
    let (_, alone, plain) = crate::support::result(&quick);
    let alone = row(&alone, "neural-ode");
    assert_eq!(several["test"], alone["test"]);
    assert_eq!(errors[0], number(alone, "/test/free_run_rmse"));
    assert!(
        alone.get("draws").is_none_or(Value::is_null) && row(&result, "arx").get("draws").is_none(),
        "{result}"
    );
    // The page's tables show the range of the seeds, such as (0.12 to 0.34).
    let ranges = |folder: &Path| {
        let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
        let is_number = |text: &str| text.len() < 20 && text.parse::<f64>().is_ok();
        page.split('(').filter(|text| text.split_once(" to ").is_some_and(|(low, _)| is_number(low))).count()
    };
    assert_eq!(ranges(plain.path()), 0);
    assert!(ranges(folder.path()) > 0);
}

/// Every device computes at least in single precision: a training in it equals that in doubles up to
/// rounding.
#[test]
fn single_precision_learns_what_doubles_do_and_a_device_that_is_not_there_is_refused() {
    let config = "configs/learn/temporal-convolution.toml";
    let with = |precision: &str| {
        let precision = format!("temporal-convolution.precision={precision}");
        let few = ["temporal-convolution.epochs=1", "temporal-convolution.windows=64", "learn.baselines=arx"];
        let (code, result, _) = result(&[&[config, precision.as_str()], &few[..]].concat());
        assert_eq!(code, 0, "{result}");
        number(row(&result, "temporal-convolution"), "/test/free_run_rmse")
    };
    let (single, double) = (with("f32"), with("f64"));
    assert!(single != double && (single / double - 1.0).abs() < 1e-3, "{single} {double}");
    for feature in ["wgpu", "cuda"] {
        let device = format!("temporal-convolution.device={feature}");
        let output = trainer(&["check", config, &device]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("built with (cpu)") && message.contains(&format!("--features {feature}")));
    }
}

#[test]
fn a_killed_study_goes_on_to_the_same_result() {
    let arguments = [
        "configs/learn/state-space.toml",
        "state-space.epochs=2",
        "state-space.windows=64",
        "learn.baselines=arx",
    ];
    let (code, whole, _) = result(&arguments);
    assert_eq!(code, 0, "{whole}");
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let resumable = [&arguments[..], &["--json", "--out", out.to_str().unwrap(), "--resume"]].concat();
    let mut killed = Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args(&resumable)
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_secs(2));
    killed.kill().unwrap();
    killed.wait().unwrap();
    let output = trainer(&resumable);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(out.join("result.json")).unwrap();
    let resumed: Value = serde_json::from_str(&text).unwrap();
    let test = |result: &Value| row(result, "state-space")["test"].clone();
    assert_eq!(test(&resumed), test(&whole));
}

/// Runs a study with these overrides and expects a refusal with these words.
fn refused(overrides: &[&str], words: &str) {
    let out = tempfile::tempdir().unwrap();
    let out = out.path().join("run");
    let arguments = [&["configs/learn/sindy.toml", "--out", out.to_str().unwrap()], overrides].concat();
    let output = trainer(&arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert_eq!(message.trim_end().lines().count(), 1, "{message}");
    assert!(message.contains(words), "no `{words}` in: {message}");
}

#[test]
fn what_nothing_can_be_learned_from_is_refused() {
    let of = |key: &str| format!("problem.friction-gravity.{key}");
    refused(&[&of("test_records=0")], "no record is left to test on");
    refused(&[&of("test_records=20")], "leave none to train on");
    refused(&[&of("warm_up_s=5")], "too few for a part of its own");
    refused(&["learn.learners=sindi"], "did you mean `sindy`?");
    refused(
        &["learn.learners=ols"],
        "`ols` is an estimator of the damping and no learner of dynamics; run it with",
    );
    refused(&["learn.baselines=arks"], "baseline");
    refused(&["sindy.library=theta,thetta"], "library term");
    refused(&["sindy.terms=sin(2*omega)"], "at character 7: `omega` is not known");
    refused(&[&of("simulation=configs/pinn.toml")], "pinn.toml");
}

#[test]
fn files_that_do_not_go_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let swing = |rate: f64, column: &str, more: &str| -> String {
        let row = |at: usize| {
            let time = at as f64 / rate;
            format!("{time:.4},{:.6}{more}\n", (6.0 * time).cos())
        };
        format!("time_s,{column}\n") + &(0..(10.0 * rate) as usize).map(row).collect::<String>()
    };
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.csv", &swing(50.0, "angle_rad", ""));
    write("fast.csv", &swing(100.0, "angle_rad", ""));
    write("driven.csv", &swing(50.0, "angle_rad,torque_nm", ",1"));
    write("meters.csv", &swing(50.0, "displacement_m", ""));
    let config = folder.path().join("learn.toml");
    let text = "task = \"learn\"\n[learn]\nlearners = [\"sindy\"]\nbaselines = []\n[problem.p]\nfolder = \".\"\nrecords = ";
    for (records, words) in [
        ("[\"a.csv\"]", "a is the only record"),
        ("[\"a.csv\", \"fast.csv\"]", "a set needs one rate"),
        ("[\"a.csv\", \"driven.csv\"]", "a has no input column, driven has one"),
        ("[\"a.csv\", \"meters.csv\"]", "a is in rad, meters in m"),
        ("[\"none-*.csv\"]", "is called none-*.csv"),
    ] {
        std::fs::write(&config, format!("{text}{records}\n")).unwrap();
        let out = folder.path().join("out");
        let output = trainer(&[config.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{records}: {message}");
        assert!(message.contains(words), "no `{words}` in: {message}");
    }
}

#[test]
fn missing_cells_of_a_record_are_told() {
    let folder = tempfile::tempdir().unwrap();
    for (name, missing) in [("a", 0..0), ("b", 100..103), ("c", 0..0), ("d", 0..0)] {
        let value = |at: usize| if missing.contains(&at) { f64::NAN } else { (0.12 * at as f64).cos() };
        let rows: String =
            (0..1000).map(|at| format!("{:.2},{:.6}\n", 0.02 * at as f64, value(at))).collect();
        std::fs::write(folder.path().join(format!("{name}.csv")), format!("time_s,angle_rad\n{rows}"))
            .unwrap();
    }
    let config = folder.path().join("learn.toml");
    let text = "task = \"learn\"\n[learn]\nlearners = [\"sindy\"]\nbaselines = []\n[problem.p]\nfolder = \".\"\nrecords = [\"?.csv\"]\n";
    std::fs::write(&config, text).unwrap();
    let (code, result, run) = result(&[config.to_str().unwrap(), "sindy.members=2", "learn.ablations=false"]);
    let told = "b: 3 missing cells left as gaps";
    assert_eq!((code, &result["problems"][0]["missing"]), (0, &serde_json::json!([told])));
    assert!(std::fs::read_to_string(run.path().join("report.html")).unwrap().contains(told));
}

/// The disc's nominal simulator has a spring and lacks dry friction (KNOWN.md); the law is stated by the
/// user.
#[test]
fn dry_friction_of_a_measured_disc_is_learned_from_one_release_and_helps_on_another() {
    if measured("disc-oscillator/free-a.csv").is_none() {
        return;
    }
    let law = "sindy.library=theta,theta_dot,sign(theta_dot)";
    let problem = "learn.problems=disc-oscillator";
    let (code, result, _) =
        result(&["configs/learn/measured.toml", problem, "learn.learners=sindy", QUICK_BASELINES, law]);
    assert_eq!(code, 0, "{result}");
    assert_eq!(result["problems"][0]["origin"], "measured");
    let error = |id: &str| number(row(&result, id), "/test/free_run_rmse");
    assert!(
        error("sindy") < 0.95 * error("recalibrated") && error("recalibrated") < error("nominal"),
        "{result}"
    );
    let friction = number(row(&result, "sindy"), "/coefficients/sign(theta_dot)/value");
    assert!((-3.0..-2.0).contains(&friction), "{friction}");
}

#[test]
fn absent_records_leave_their_rows_out_and_say_so() {
    let folder = root().join("no-such-folder");
    let folder = format!("problem.air-disc.folder={}", folder.display());
    let arguments = ["configs/learn/measured.toml", "learn.problems=air-disc", QUICK_BASELINES, &folder];
    let (code, result, _) = result(&arguments);
    assert_eq!(code, 0, "{result}");
    assert!(result["problems"][0]["absent"].as_str().unwrap().contains("its rows are left out"));
    assert_eq!(result["results"].as_array().unwrap().len(), 0);
}

/// Rows of two files train, validate and test as the configuration states them, with the columns that each part names.
#[test]
fn stated_parts_are_learned_from_and_scored_apart() {
    let scratch = tempfile::tempdir().unwrap();
    let force = |at: usize| (0.07 * at as f64).sin() + (0.31 * at as f64).sin();
    let mut state = [0.0_f64, 0.0];
    let mut text = "u_v,y_v,other_v\n".to_owned();
    for at in 0..1200 {
        text.push_str(&format!("{},{},{}\n", force(at), state[0], 2.0 * state[0]));
        for _ in 0..100 {
            let rate = force(at) - 0.4 * state[1] - 9.0 * state[0];
            state[1] += 1e-3 * rate;
            state[0] += 1e-3 * state[1];
        }
    }
    std::fs::write(scratch.path().join("record.csv"), text).unwrap();
    let part = |name: &str, usage: &str, rows: [usize; 2], more: &str| {
        let [from, to] = rows;
        format!(
            "[problem.made.part.{name}]\nuse = \"{usage}\"\nfile = \"record.csv\"\nfrom_row = {from}\nto_row = {to}\n{more}\n"
        )
    };
    let head = "task = \"learn\"\n[learn]\nlearners = [\"sindy\"]\nbaselines = [\"persistence\"]\nablations = false\n[sindy]\n\
                library = [\"theta\", \"theta_dot\", \"u\"]\n[problem.made]\nfolder = \".\"\nvalue = \"y_v\"\ninput = \"u_v\"\n\
                unit = \"V\"\nsample_rate_hz = 10.0\ninit = 20\norigin = \"simulated\"\nsource = \"the study's own page\"\n";
    let config = |end: usize| {
        let published = "published = [\"others = 0.25\"]";
        let parts = [
            part("training", "training", [0, 600], ""),
            part("choice", "validation", [600, 800], ""),
            part("last", "test", [800, end], published),
            part("twice", "test", [800, 1000], "value = \"other_v\""),
        ];
        let file = scratch.path().join(format!("study-{end}.toml"));
        std::fs::write(&file, format!("{head}{}", parts.concat())).unwrap();
        file.display().to_string()
    };
    let (code, result, _) = result(&[&config(1200)]);
    assert_eq!(code, 0, "{result}");
    let sindy = row(&result, "sindy");
    let error = |part: usize| number(sindy, &format!("/test/parts/{part}/free_run_rmse"));
    assert!(error(0) < 1e-2 && error(1) > 0.05, "{sindy}");
    assert_eq!(result["problems"][0]["parts"][0]["published"][0]["name"], "others");
    assert_eq!(result["problems"][0]["parts"][1]["samples"], 200);

    let refused = trainer(&[&config(1300)]);
    let message = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{message}");
    assert!(
        message.contains("part.last: rows 800 to 1300") && message.contains("which has 1200"),
        "{message}"
    );

    let absent = trainer(&[&config(1200), "problem.made.folder=nowhere"]);
    let said =
        format!("{}{}", String::from_utf8_lossy(&absent.stdout), String::from_utf8_lossy(&absent.stderr));
    assert!(said.contains("Get it from the study's own page"), "{said}");
}
