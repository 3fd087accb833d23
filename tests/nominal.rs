//! Tests of nominal simulators with effects, and of coefficients that a record does not determine.

use crate::support::{measured, result, simulated, trainer};
use serde_json::Value;
use std::path::Path;

/// Configuration of a decay with drag, and an encoder of 4096 steps per turn.
const CONFIG: &str = r#"
name = "drag"
[record]
rate_hz = 130.0
seconds = 12.0
[start]
position = 0.7
[sensor]
noise = 1e-4
[[effects]]
id = "quadratic_drag"
parameters.coefficient = 0.03
[[effects]]
id = "sensor_quantization"
parameters.step = 1.5339807878856412e-3
"#;

fn text(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn a_repaired_simulator_is_a_nominal_one_that_lacks_nothing() {
    let scratch = tempfile::tempdir().unwrap();
    let file = simulated(scratch.path(), CONFIG, &[]);
    let record = file("record-000.csv");
    let (code, first, folder) = result(&["diagnose", &record, "--nominal", &file("nominal.toml")]);
    assert_eq!(code, 0, "{first}");
    assert_eq!(first["verdict"]["effects"], serde_json::json!(["quadratic_drag", "sensor_quantization"]));
    let repaired = folder.path().join("repaired.toml");
    let stated = text(folder.path(), "repaired.toml");
    // The stated digits: those that the error leaves, and two more.
    assert!(stated.contains("parameters.step = 0.00153398 "), "{stated}");
    let values = stated.lines().filter_map(|line| line.split_once('=')?.1.split('#').next());
    let numbers: Vec<&str> = values.map(str::trim).filter(|value| value.parse::<f64>().is_ok()).collect();
    assert!(numbers.len() > 10 && numbers.iter().all(|number| number.len() <= 12), "{numbers:?}");
    let (code, again, second) = result(&["diagnose", &record, "--nominal", repaired.to_str().unwrap()]);
    assert_eq!(code, 0, "{again}");
    assert_eq!(again["verdict"]["status"], "none", "{again}");
    let known = &again["calibration"]["effects"][0];
    assert_eq!((&known["id"], &known["recalibrate"]), (&Value::from("quadratic_drag"), &Value::from(true)));
    let coefficient = &known["parameters"]["coefficient"];
    assert_eq!(coefficient["determined"], true);
    assert_eq!(coefficient["unit"], "1/rad");
    assert!((coefficient["repaired"]["value"].as_f64().unwrap() / 0.03 - 1.0).abs() < 0.05, "{known}");
    // The folder has the nominal simulator of the diagnosis, and its copy gives the same diagnosis.
    let kept = text(second.path(), "nominal.toml");
    assert!(kept.contains("id = \"quadratic_drag\"\nrecalibrate = true\n"), "{kept}");
    let nominal = second.path().join("nominal.toml");
    let (_, third, _) = result(&["diagnose", &record, "--nominal", nominal.to_str().unwrap()]);
    assert_eq!(third["nominal_digest"], again["nominal_digest"]);
    assert_ne!(first["nominal_digest"], again["nominal_digest"]);
    assert!(text(second.path(), "repaired.toml").contains("id = \"quadratic_drag\""));
}

/// A carriage without a spring, whose nominal simulator has one.
#[test]
fn a_spring_where_there_is_none_is_not_determined() {
    let Some(record) = measured("positioning-drive/record.csv") else { return };
    let Some(nominal) = measured("positioning-drive/nominal.toml") else { return };
    let scratch = tempfile::tempdir().unwrap();
    let sprung = std::fs::read_to_string(crate::support::root().join(nominal)).unwrap();
    let sprung = sprung.replace("stiffness = 0.0", "stiffness = 0.5");
    let sprung = sprung.replace("rest_angle = 0.0", "rest_angle = 0.125");
    // A part of the record and sets of two effects are as informative, in a small part of the time.
    let record = std::fs::read_to_string(crate::support::root().join(record)).unwrap();
    let part: Vec<&str> = record.lines().take(record.lines().count() / 8).collect();
    let log = scratch.path().join("record.csv");
    std::fs::write(&log, part.join("\n")).unwrap();
    let path = scratch.path().join("sprung.toml");
    std::fs::write(&path, sprung).unwrap();
    let nominal = path.to_str().unwrap();
    let options = ["--time", "t", "--angle", "qm_m", "--input", "vir_V", "--most-effects", "2"];
    let (code, found, folder) =
        result(&[&["diagnose", log.to_str().unwrap(), "--nominal", nominal][..], &options].concat());
    assert_eq!(code, 0, "{found}");
    let row = &found["calibration"]["rest_angle"];
    assert_eq!(row["determined"], false, "{row}");
    assert!(row["repaired"]["value"].is_number(), "{row}");
    assert_eq!(found["calibration"]["damping"]["determined"], true);
    assert_eq!(found["calibration"]["stiffness"]["determined"], false);
    // A negligible stiffness keeps its nominal value; the rest angle beside it preloads the drive.
    let said = "a value of stiffness that these data determine; the value in this file is the nominal \
                simulator's";
    for (name, number) in [
        ("repaired.toml", "stiffness = 0.5 "),
        ("repaired.mjcf.xml", "stiffness=\"0.5\""),
        ("repaired.py", "stiffness = 0.5 "),
        ("repaired.mo", "stiffness = 0.5;"),
    ] {
        let text = text(folder.path(), name);
        assert!(text.contains(said) && text.contains(number), "{name}: {text}");
    }
    assert!(text(folder.path(), "repaired.urdf.xml").contains(said));
    assert!(text(folder.path(), "report.html").contains("not determined by these data"));
}

#[test]
fn an_effect_whose_id_is_no_text_is_refused_with_what_stands_there() {
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("drag.toml");
    std::fs::write(&path, CONFIG.replace("id = \"quadratic_drag\"", "id = 3")).unwrap();
    let simulated = trainer(&["simulate", path.to_str().unwrap(), "--quiet"]);
    let message = String::from_utf8(simulated.stderr).unwrap();
    assert_eq!(simulated.status.code(), Some(2), "{message}");
    assert!(message.contains("unknown effect \"3\""), "{message}");
}
