//! Tests of `trainer diagnose`: its files, the contract for scripts, and refusals of bad input with one
//! message and no named effect.

use crate::support::{self, NOMINAL, number, result, trainer};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// Configuration of a short decay with dry friction, which the nominal simulator lacks.
const FRICTION: &str = r#"
name = "friction"
[record]
rate_hz = 130.0
seconds = 8.0
[start]
position = 0.7
[sensor]
noise = 5e-4
[[effects]]
id = "coulomb_friction"
parameters.torque = 2.0
"#;

pub(crate) fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Simulates a record with its nominal simulator in a scratch folder.
fn simulated(overrides: &[&str]) -> (TempDir, String, String) {
    let scratch = tempfile::tempdir().unwrap();
    let file = support::simulated(scratch.path(), FRICTION, overrides);
    (scratch, file("record-000.csv"), file("nominal.toml"))
}

fn is_interval(value: &Value) -> bool {
    value.as_array().is_some_and(|ends| {
        ends.len() == 2 && ends[0].as_f64().unwrap_or(f64::NAN) <= ends[1].as_f64().unwrap_or(f64::NAN)
    })
}

/// Checks the keys and types of the contract; additional keys are allowed.
fn check_contract(found: &Value) {
    assert_eq!(found["schema"], "ringdown.diagnosis/1");
    let verdict = &found["verdict"];
    assert!(["none", "calibration", "effect", "unknown"].contains(&verdict["status"].as_str().unwrap()));
    assert!(verdict["effects"].as_array().unwrap().iter().all(Value::is_string));
    assert!((0.0..=1.0).contains(&number(found, "/verdict/confidence")));
    assert!((0.0..=1.0).contains(&number(found, "/verdict/left_over")));
    for class in verdict["equivalent"].as_array().unwrap() {
        assert!(class.as_array().unwrap().len() > 1 && class[0].is_string());
    }
    let summary = verdict["summary"].as_str().unwrap();
    assert!(summary.ends_with('.') && !summary.contains('\n') && !summary.contains("e-"), "{summary}");
    let ids: Vec<&str> =
        found["effects"].as_array().unwrap().iter().map(|effect| effect["id"].as_str().unwrap()).collect();
    for id in ["none", "calibration", "unknown"] {
        assert!(ids.contains(&id), "{ids:?}");
    }
    // Every named effect has a probability.
    for id in verdict["effects"].as_array().unwrap() {
        assert!(ids.contains(&id.as_str().unwrap()), "{id} {ids:?}");
    }
    let mut last = 1.0;
    for effect in found["effects"].as_array().unwrap() {
        let probability = effect["probability"].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&probability) && probability <= last, "best first: {ids:?}");
        last = probability;
        for parameter in effect["parameters"].as_object().unwrap().values() {
            assert!(parameter["value"].is_number() && parameter["unit"].is_string());
            assert!(is_interval(&parameter["interval_95"]), "{parameter}");
        }
        let share = &effect["gap_share"];
        assert!(share.is_null() || share["value"].is_number() && is_interval(&share["interval_95"]));
    }
    for key in ["nominal", "recalibrated", "repaired", "ceiling", "noise_floor", "ratio_to_floor"] {
        assert!(number(found, &format!("/gap/{key}")) >= 0.0, "{key}");
    }
    assert!(found["gap"]["unit"].is_string() && found["gap"]["held_out"].is_string());
    assert!(found["gap"]["closure"]["value"].is_number());
    assert!(is_interval(&found["gap"]["closure"]["interval_95"]));
    let budget: f64 = ["dissipative", "conservative", "time_dependent", "sensor", "clock"]
        .iter()
        .map(|class| number(found, &format!("/where/budget/{class}")))
        .sum();
    assert!(budget == 0.0 || (budget - 1.0).abs() < 1e-9, "{budget}");
    for (map, axes) in [("time", 1), ("amplitude", 1), ("phase", 2), ("frequency", 1)] {
        for cell in found["where"][map].as_array().unwrap() {
            let bounds = cell["bounds"].as_array().unwrap();
            assert!(bounds.len() == axes && bounds.iter().all(is_interval), "{map}: {cell}");
            assert!(cell["value"].is_number() && cell["band"].is_number(), "{map}: {cell}");
            assert_eq!(
                cell["significant"].as_bool().unwrap(),
                cell["value"].as_f64() > cell["band"].as_f64(),
                "{map}: {cell}"
            );
        }
    }
    let chain = &found["measuring_chain"];
    assert!(["host", "uniform-index", "index-with-gaps"].contains(&chain["clock"].as_str().unwrap()));
    assert!(chain["sample_rate_hz"].is_number() && chain["noise"].is_number());
    assert!(chain["resolution"].is_number() || chain["resolution"].is_null());
    assert!(chain["findings"].is_array());
    for key in ["inertia", "damping", "stiffness", "rest_angle"] {
        assert!(found["calibration"][key]["nominal"].is_number(), "{key}");
    }
    assert!(found["next_experiment"]["text"].is_string());
    assert!(found["next_experiment"]["separates"].is_array());
    assert!(number(found, "/seconds") > 0.0);
}

#[test]
fn a_missing_effect_is_named_and_the_answer_has_the_contracts_form() {
    let (_scratch, record, nominal) = simulated(&[]);
    let (code, found, folder) = result(&["diagnose", &record, "--nominal", &nominal]);
    assert_eq!(code, 0, "{found}");
    check_contract(&found);
    assert_eq!(found["verdict"]["status"], "effect");
    assert_eq!(found["verdict"]["effects"][0], "coulomb_friction");
    let torque = &found["effects"][0]["parameters"]["torque"];
    let ends = torque["interval_95"].as_array().unwrap();
    assert!(ends[0].as_f64() < Some(2.0) && ends[1].as_f64() > Some(2.0), "{torque}");
    assert_eq!(torque["unit"], "rad/s^2");
    assert!(number(&found, "/gap/ratio_to_floor") < 1.1);

    let written = std::fs::read_to_string(folder.path().join("diagnosis.json")).unwrap();
    let written: Value = serde_json::from_str(&written).unwrap();
    assert_eq!(written, found);
    let series = std::fs::read_to_string(folder.path().join("series.csv")).unwrap();
    assert_eq!(series.lines().count(), 1 + 1040);

    the_repaired_simulator_runs(folder.path(), &record);
    the_report_is_derived(folder.path());
}

/// Checks that the repaired simulator can be loaded and reproduces the record down to its noise.
fn the_repaired_simulator_runs(folder: &Path, record: &str) {
    let again = tempfile::tempdir().unwrap();
    let repaired = folder.join("repaired.toml");
    let output = trainer(&[
        "simulate",
        repaired.to_str().unwrap(),
        "sensor.noise=0",
        "--quiet",
        "--out",
        again.path().to_str().unwrap(),
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let values = |path: &Path| -> Vec<f64> {
        let text = std::fs::read_to_string(path).unwrap();
        let rows = text.lines().filter(|line| !line.starts_with(['#', 't']));
        rows.map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect()
    };
    let (made, measured) = (values(&again.path().join("records/record-000.csv")), values(Path::new(record)));
    assert!(made.len().abs_diff(measured.len()) <= 1, "{} {}", made.len(), measured.len());
    let count = made.len().min(measured.len()) as f64;
    let squares: f64 = made.iter().zip(&measured).map(|(a, b)| (a - b).powi(2)).sum();
    // The noise is 5e-4; a free run over the whole record adds the error of the coefficients.
    let rms = (squares / count).sqrt();
    assert!(rms < 1.5e-3, "{rms}");
    for (name, words) in [
        ("repaired.py", "def rhs(time, state"),
        ("repaired.mo", "model Repaired"),
        ("repaired.mjcf.xml", "frictionloss="),
        ("repaired.urdf.xml", "<dynamics damping="),
        ("equation.txt", "Coulomb friction: -τ_c sign(θ′)"),
        ("equation.tex", r"-\tau_c\,\operatorname{sign}\dot\theta"),
    ] {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(text.contains(words), "{name}: {text}");
    }
}

/// Checks that the report can be made from the folder's other files.
fn the_report_is_derived(folder: &Path) {
    let report = folder.join("report.html");
    let first = std::fs::read_to_string(&report).unwrap();
    for part in [
        "Missing effect",
        "How far the gap shrinks",
        "Gap budget:",
        "id=\"worst-stretch\"",
        "id=\"gap-in-the-phase-plane\"",
        "id=\"backbone-frequency\"",
        "id=\"restoring-force\"",
        "Simulated record",
    ] {
        assert!(first.contains(part), "{part}");
    }
    assert!(
        !first.contains("http://")
            || first.replace("http://www.w3.org/2000/svg", "").find("http://").is_none()
    );
    let output = trainer(&["report", folder.to_str().unwrap(), "--quiet"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(std::fs::read_to_string(&report).unwrap(), first);
}

#[test]
fn the_terminal_has_one_screen_and_the_threads_change_nothing() {
    let (_scratch, record, nominal) = simulated(&["effects.1.probability=0"]);
    let run = |threads: &str| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().unwrap();
        let output =
            trainer(&["diagnose", &record, "--nominal", &nominal, "--threads", threads, "--out", out]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(folder.path().join("diagnosis.json")).unwrap();
        let mut found: Value = serde_json::from_str(&text).unwrap();
        for timed in ["seconds", "stages"] {
            found.as_object_mut().unwrap().remove(timed);
        }
        (String::from_utf8(output.stdout).unwrap(), found)
    };
    let (text, found) = run("1");
    assert!(["none", "calibration"].contains(&found["verdict"]["status"].as_str().unwrap()), "{text}");
    assert!(text.lines().count() < 50, "{text}");
    for part in ["noise floor", "probabilit", "next experiment:", "measurement chain:", "took:", "report:"] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    assert_eq!(found, run("2").1);
}

#[test]
fn one_bad_case_of_a_batch_is_one_failure_and_the_others_go_on() {
    let (scratch, record, nominal) = simulated(&[]);
    let cases = scratch.path().join("cases");
    let copy = |from: &str, to: &str| {
        write(&cases, to, &std::fs::read_to_string(from).unwrap());
    };
    copy(&record, "good/record-000.csv");
    copy(&nominal, "good/nominal.toml");
    copy(&record, "without-nominal/record-000.csv");
    write(&cases, "garbled/record-000.csv", "time_s,angle_rad\n0,zero\n");
    copy(&nominal, "garbled/nominal.toml");
    copy(&nominal, "empty/nominal.toml");
    let answers = scratch.path().join("answers");
    let batch = || {
        let output = trainer(&[
            "diagnose",
            "--batch",
            cases.to_str().unwrap(),
            "--out",
            answers.to_str().unwrap(),
            "--threads",
            "2",
            "--json",
        ]);
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), found, String::from_utf8(output.stderr).unwrap())
    };
    let (code, found, message) = batch();
    assert_eq!(code, Some(1), "{message}");
    assert_eq!((&found["cases"], &found["diagnosed"]), (&4.into(), &1.into()));
    assert_eq!(found["failed"].as_array().unwrap().len(), 3);
    assert_eq!(message.lines().count(), 3, "{message}");
    assert!(message.contains("garbled: ") && message.contains("`zero` in column `angle_rad`"), "{message}");
    assert!(message.contains("without-nominal: ") && message.contains("nominal.toml"), "{message}");
    let path = answers.join("good/diagnosis.json");
    let first = std::fs::read_to_string(&path).unwrap();
    check_contract(&serde_json::from_str(&first).unwrap());
    assert!(!answers.join("garbled/diagnosis.json").exists());
    let failed: Value =
        serde_json::from_slice(&std::fs::read(answers.join("garbled/failed.json")).unwrap()).unwrap();
    assert!(failed["message"].as_str().unwrap().contains("`zero` in column `angle_rad`"));

    let (code, found, _) = batch();
    assert_eq!((code, &found["skipped"], &found["diagnosed"]), (Some(1), &1.into(), &0.into()));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), first, "an answer is left alone");

    // The case now has another record: its old answer is neither accepted for that record nor overwritten.
    write(&cases, "good/record-000.csv", &decay(800, 0.7));
    let (code, found, message) = batch();
    assert_eq!((code, &found["skipped"], &found["diagnosed"]), (Some(1), &0.into(), &0.into()));
    let changed = message.lines().find(|line| line.contains("good: ")).unwrap();
    assert!(changed.contains("record-000.csv: is not the record that was diagnosed"), "{changed}");
    assert_eq!(changed.matches("sha256:").count(), 2, "{changed}");
    assert!(changed.contains("name another folder with --out"), "{changed}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), first, "an answer is left alone");

    // The answer is not accepted for another simulator either.
    let nominal = cases.join("good/nominal.toml");
    let text = std::fs::read_to_string(&nominal).unwrap();
    std::fs::write(&nominal, text.replacen("damping = ", "damping = 1", 1)).unwrap();
    let (_, found, message) = batch();
    assert_eq!(found["skipped"], 0);
    assert!(message.contains("nominal.toml: is not the simulator that was diagnosed"), "{message}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), first, "an answer is left alone");

    let nothing = tempfile::tempdir().unwrap();
    let folder = nothing.path().to_str().unwrap();
    let message = refusal(&["diagnose", "--batch", folder, "--out", answers.to_str().unwrap()]);
    assert!(message.contains("there is no case in it"), "{message}");
}

/// Runs the program; expects exit code 2, one line on standard error and nothing on standard output.
pub(crate) fn refusal(arguments: &[&str]) -> String {
    let output = trainer(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty(), "{:?}", String::from_utf8_lossy(&output.stdout));
    assert_eq!(message.trim_end().lines().count(), 1, "{message}");
    assert!(message.starts_with("error: ") && !message.contains("panicked"), "{message}");
    message
}

/// Expects a refusal of a record and a nominal simulator with these words.
fn refused(record: &str, nominal: &str, options: &[&str], expected: &str) {
    let scratch = tempfile::tempdir().unwrap();
    let record = write(scratch.path(), "record.csv", record);
    let nominal = write(scratch.path(), "nominal.toml", nominal);
    let out = scratch.path().join("out");
    let mut arguments = vec!["diagnose", &record, "--nominal", &nominal, "--out", out.to_str().unwrap()];
    arguments.extend(options);
    let message = refusal(&arguments);
    assert!(message.contains(expected), "no `{expected}` in: {message}");
    assert!(!out.exists(), "a refusal leaves nothing behind");
}

/// Returns a decay of 22 rad/s with 130 samples per second.
pub(crate) fn decay(samples: usize, amplitude: f64) -> String {
    let rows = (0..samples).map(|index| {
        let t = index as f64 / 130.0;
        format!("{t:.6},{:.6}\n", amplitude * (-0.15 * t).exp() * (22.0 * t).cos())
    });
    "time_s,angle_rad\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn records_that_say_nothing_are_refused() {
    refused(&decay(40, 0.7), NOMINAL, &[], "40 samples; a diagnosis needs at least 50");
    refused(&decay(80, 0.7), NOMINAL, &[], "a diagnosis needs at least 3. Record longer");
    refused(&decay(800, 0.0), NOMINAL, &[], "does not move");
    let noise = (0..800)
        .map(|index| format!("{},{}\n", index as f64 / 130.0, if index % 7 == 0 { 1e-3 } else { 0.0 }));
    let noise = "time_s,angle_rad\n".to_owned() + &noise.collect::<String>();
    let coarse = format!("{NOMINAL}sensor_resolution = 1e-3\n");
    refused(&noise, &coarse, &[], "does not move");
}

#[test]
fn another_system_and_other_units_are_refused() {
    let other = NOMINAL.replace("484.0", "36.0");
    refused(&decay(800, 0.7), &other, &[], "this is not the same system, or the units are wrong");
    refused(&decay(800, 0.7), NOMINAL, &["--time-unit", "ms"], "this is not the same system");
    let hertz = NOMINAL.replace("484.0", "12.26");
    refused(&decay(800, 0.7), &hertz, &[], "near 2 pi: is a frequency stated in Hz");
    refused(
        &decay(800, 0.7).replace("time_s,angle_rad", "foo,angle_rad"),
        NOMINAL,
        &[],
        "or --sample-rate where",
    );
    refused(&decay(800, 40.0), NOMINAL, &[], "look like degrees. Set --unit deg");
    let drive = format!("coordinate = \"displacement\"\n{NOMINAL}");
    refused(
        &decay(800, 0.7),
        &drive,
        &[],
        "the record is in rad, the nominal simulator's coordinate asks for m",
    );
}

#[test]
fn a_driven_system_needs_its_input() {
    let driven = format!("{NOMINAL}input_gain = 2.0\n");
    refused(&decay(800, 0.7), &driven, &[], "no input column; name it with --input");
    let free = NOMINAL.replace("484.0", "0.0");
    refused(&decay(800, 0.7), &free, &[], "no input column");
    refused(&decay(800, 0.7), &driven, &["--input", "volts"], "there is no column `volts`");
}

#[test]
fn files_that_cannot_be_used_are_refused_with_their_place() {
    refused("time_s,angle_rad\n0,0.5\n0.01,x\n", NOMINAL, &[], "record.csv:3: `x` in column `angle_rad`");
    refused("t,foo,bar\n0,0.5,1\n", NOMINAL, &[], "set --value to the name of one");
    refused("", NOMINAL, &[], "record.csv: is empty");
    refused(&decay(800, 0.7), &format!("{NOMINAL}mass = 2\n"), &[], "nominal.toml:5:1: unknown key `mass`");
    refused(&decay(800, 0.7), "inertia = 1.0\n", &[], "`damping` is missing");
    refused(&decay(800, 0.7), &NOMINAL.replace("0.3", "-0.3"), &[], "`damping` is -0.3");
    let weightless = NOMINAL.replace("1.0", "0");
    refused(&decay(800, 0.7), &weightless, &[], "`inertia` is 0; expected a finite number above 0 (SI");
    let scratch = tempfile::tempdir().unwrap();
    let record = write(scratch.path(), "record.csv", &decay(800, 0.7));
    let message = refusal(&["diagnose", &record, "--nominal", "no-such.toml"]);
    assert!(message.contains("no-such.toml: cannot be used"), "{message}");
    let nominal = write(scratch.path(), "nominal.toml", NOMINAL);
    let message = refusal(&["diagnose", "no-such.csv", "--nominal", &nominal]);
    assert!(message.contains("no-such.csv: cannot be read"), "{message}");
    // The folder of another answer is not overwritten.
    let full = scratch.path().to_str().unwrap();
    let message = refusal(&["diagnose", &record, "--nominal", &nominal, "--out", full]);
    assert!(message.contains("is not empty"), "{message}");
}

#[test]
fn a_record_counts_once() {
    let scratch = tempfile::tempdir().unwrap();
    let first = write(scratch.path(), "one.csv", &decay(800, 0.7));
    let second = write(scratch.path(), "two.csv", &decay(800, 0.7));
    let nominal = write(scratch.path(), "nominal.toml", NOMINAL);
    for pair in [[&first, &second], [&first, &first]] {
        let message = refusal(&["diagnose", pair[0], pair[1], "--nominal", &nominal]);
        assert!(message.contains(&format!("{} and {} are the same record (sha256:", pair[0], pair[1])));
    }
}

#[test]
fn resumed_it_goes_on_or_gives_its_answer_again() {
    let scratch = tempfile::tempdir().unwrap();
    let record = write(scratch.path(), "record.csv", &decay(800, 0.7));
    let nominal = write(scratch.path(), "nominal.toml", NOMINAL);
    let out = scratch.path().join("answer");
    let shown = out.to_str().unwrap();
    let arguments = ["diagnose", &record, "--nominal", &nominal, "--out", shown, "--resume", "--json"];
    let answer = |more: &[&str]| trainer(&[&arguments[..], more].concat());
    let first = answer(&[]);
    assert_eq!(first.status.code(), Some(0), "{}", String::from_utf8_lossy(&first.stderr));
    let page = std::fs::metadata(out.join("report.html")).unwrap().modified().unwrap();
    let again = answer(&["--threads", "1"]);
    assert_eq!((again.status.code(), &again.stdout), (Some(0), &first.stdout), "given again");
    assert_eq!(std::fs::metadata(out.join("report.html")).unwrap().modified().unwrap(), page);
    let message = refusal(&[&arguments[..], &["--seed", "1"]].concat());
    assert!(message.contains("was started with another seed: 0, now 1"), "{message}");
    assert!(refusal(&arguments[..6]).contains("is not empty"), "only --resume goes into it");

    // Files of an interrupted diagnosis.
    let log = std::fs::read_to_string(out.join("events.jsonl")).unwrap();
    std::fs::write(out.join("events.jsonl"), log.lines().next().unwrap().to_owned() + "\n").unwrap();
    std::fs::remove_file(out.join("diagnosis.json")).unwrap();
    std::fs::remove_file(out.join("report.html")).unwrap();
    assert_eq!(answer(&[]).status.code(), Some(0));
    assert!(out.join("diagnosis.json").exists() && out.join("report.html").exists());

    let other = scratch.path().join("other");
    write(&other, "mine.txt", "mine");
    let into = ["diagnose", &record, "--nominal", &nominal, "--resume", "--out", other.to_str().unwrap()];
    assert!(refusal(&into).contains("is not empty"));
}

#[test]
fn names_are_escaped_in_the_report() {
    let scratch = tempfile::tempdir().unwrap();
    let record = write(scratch.path(), "<script>alert(1)<script>.csv", &decay(800, 0.7));
    let nominal = write(scratch.path(), "nominal.toml", NOMINAL);
    let (code, found, folder) = result(&["diagnose", &record, "--nominal", &nominal]);
    assert_eq!(code, 0, "{found}");
    let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(!html.contains("<script>alert"), "a name came through");
    assert!(html.contains("&#60;script&#62;alert(1)"));
}

#[test]
fn help_shows_examples_and_how_columns_are_found() {
    let output = trainer(&["diagnose", "--help"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for part in
        ["trainer diagnose record.csv --nominal", "--batch", "--quantity", "velocity_rad_s", "Exit codes"]
    {
        assert!(text.contains(part), "{part}");
    }
}

#[test]
fn an_effect_that_is_not_considered_is_not_named() {
    let (_scratch, record, nominal) = simulated(&["record.seconds=4"]);
    let arguments = ["diagnose", &record, "--nominal", &nominal, "--json", "--quiet"];
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("answer");
    let without = ["--without", "coulomb_friction,stribeck_friction", "--out", out.to_str().unwrap()];
    let output = trainer(&[&arguments[..], &without[..]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    for effect in found["effects"].as_array().unwrap() {
        let id = effect["id"].as_str().unwrap();
        assert!(!["coulomb_friction", "stribeck_friction"].contains(&id), "{id}");
    }
    let refused = trainer(&[&arguments[..], &["--without", "friction"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("trainer list effects"));
}
