//! Tests of `trainer diagnose --rigs`: classes that rigs of one build share, and the agreement of their
//! coefficients.

use crate::support::{number, simulated, trainer};
use serde_json::Value;
use std::path::Path;

/// Rig with dry friction and the weight of a pendulum, which the nominal simulator lacks.
const RIG: &str = r#"
name = "rig"
[record]
rate_hz = 130.0
seconds = 8.0
[start]
position = 1.4
[sensor]
noise = 5e-4
[[effects]]
id = "coulomb_friction"
parameters.torque = 2.0
[[effects]]
id = "gravity"
parameters.torque = 40.0
parameters.angle = 1.0
"#;

/// Creates folders of rigs `A`, `B`, … whose weights exert these torques.
pub(crate) fn rigs(scratch: &Path, torques: &[f64]) -> Vec<String> {
    let rig = |(index, (name, torque)): (usize, (&&str, &f64))| {
        let folder = scratch.join(name);
        std::fs::create_dir(&folder).unwrap();
        let (torque, seed) = (format!("effects.2.parameters.torque={torque}"), format!("seed={index}"));
        let made = tempfile::tempdir().unwrap();
        let from = simulated(made.path(), RIG, &[&torque, &seed]);
        for file in ["record-000.csv", "nominal.toml"] {
            std::fs::copy(from(file), folder.join(file)).unwrap();
        }
        folder.to_str().unwrap().to_owned()
    };
    ["A", "B", "C"].iter().zip(torques).enumerate().map(rig).collect()
}

fn class<'a>(found: &'a Value, id: &str) -> &'a Value {
    let classes = found["classes"].as_array().unwrap();
    classes.iter().find(|class| class["id"] == id).unwrap_or_else(|| panic!("no {id} in {found}"))
}

fn coefficient<'a>(found: &'a Value, class_id: &str, effect: &str) -> &'a Value {
    let rows = class(found, class_id)["coefficients"].as_array().unwrap();
    let row = rows.iter().find(|row| row["effect"] == effect && row["parameter"] == "torque");
    row.unwrap_or_else(|| panic!("no torque of {effect} in {found}"))
}

#[test]
fn equal_friction_agrees_and_unequal_weights_do_not() {
    let scratch = tempfile::tempdir().unwrap();
    let folders = rigs(scratch.path(), &[40.0, 40.0, 60.0]);
    let out = scratch.path().join("out");
    let mut arguments = vec!["diagnose", "--rigs"];
    arguments.extend(folders.iter().map(String::as_str));
    arguments.extend(["--json", "--out", out.to_str().unwrap()]);
    let output = trainer(&arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{message}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["schema"], "ringdown.rigs/1");
    assert_eq!(found["rigs"].as_array().unwrap().len(), 3);

    for id in ["friction", "restoring"] {
        let own = class(&found, id);
        assert_eq!(own["present_in"].as_array().unwrap().len(), 3, "{own}");
        // Three rigs together are more certain than each of them alone.
        let most =
            found["rigs"].as_array().unwrap().iter().flat_map(|rig| rig["classes"].as_array().unwrap());
        let most = most.filter(|class| class["id"] == id).map(|class| number(class, "/probability"));
        assert!(number(own, "/probability") > most.fold(0.0, f64::max), "{own}");
    }
    // For every named kind of dry friction, the torque is that of all three rigs.
    let friction = class(&found, "friction")["coefficients"].as_array().unwrap();
    assert!(friction.iter().all(|row| row["agree"] == true), "{friction:?}");
    let torque = friction.iter().find(|row| row["parameter"] == "torque").unwrap();
    assert!((number(torque, "/mean/value") - 2.0).abs() < 0.1, "{torque}");
    let weight = coefficient(&found, "restoring", "gravity");
    assert_eq!(weight["agree"], false, "{weight}");
    assert_eq!(weight["farthest"]["rigs"].as_array().unwrap().last().unwrap(), "C", "{weight}");
    let told = found["sentences"].as_array().unwrap().iter().map(|text| text.as_str().unwrap());
    let told: String = told.collect::<Vec<_>>().join(" ");
    assert!(told.contains("in all three") && told.contains("the same within errors"), "{told}");
    assert!(told.contains("differ by"), "{told}");

    // The folder has the printed answer, a page, and each rig's own run.
    let written = std::fs::read_to_string(out.join("rigs.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&written).unwrap(), found);
    for file in ["A/diagnosis.json", "B/report.html", "C/repaired.toml"] {
        assert!(out.join(file).exists(), "{file}");
    }
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("the same within errors") && page.contains("not the same"));
    let output = trainer(&["report", out.to_str().unwrap(), "--quiet"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(std::fs::read_to_string(out.join("report.html")).unwrap(), page);
    let listed = trainer(&["list", "runs", scratch.path().to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&listed.stdout).contains("3 rigs: "), "{listed:?}");
}

#[test]
fn a_rig_that_fails_is_one_failure_and_is_made_up_for_when_resumed() {
    let scratch = tempfile::tempdir().unwrap();
    let folders = rigs(scratch.path(), &[40.0, 40.0]);
    let nominal = Path::new(&folders[1]).join("nominal.toml");
    let kept = std::fs::read_to_string(&nominal).unwrap();
    std::fs::remove_file(&nominal).unwrap();
    let out = scratch.path().join("out");
    let run = |more: &[&str]| {
        let mut arguments = vec!["diagnose", "--rigs", &folders[0], &folders[1]];
        arguments.extend(["--out", out.to_str().unwrap()]);
        arguments.extend(more);
        let output = trainer(&arguments);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (code, shown, message) = run(&[]);
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("B: ") && message.contains("nominal.toml: cannot be used"), "{message}");
    assert!(shown.contains("1 rig of one build: 1 FAILED"), "{shown}");
    let (code, _, message) = run(&[]);
    assert!(code == Some(2) && message.contains("is not empty"), "{message}");
    std::fs::write(&nominal, kept).unwrap();
    let answer = out.join("A/diagnosis.json");
    let first = std::fs::metadata(&answer).unwrap().modified().unwrap();
    let (code, shown, message) = run(&["--resume"]);
    assert_eq!(code, Some(0), "{message}");
    assert!(shown.contains("2 rigs of one build"), "{shown}");
    assert_eq!(std::fs::metadata(&answer).unwrap().modified().unwrap(), first, "a finished answer is kept");
}

#[test]
fn rigs_that_cannot_be_compared_are_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().to_str().unwrap();
    let refusal = |arguments: &[&str], expected: &str| {
        let output = trainer(&[&["diagnose", "--rigs"], arguments].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    };
    refusal(&[folder], "a single rig has nothing to be compared with");
    refusal(&[folder, "no-such-rig"], "no-such-rig: No such file");
    refusal(&[folder, folder], "again");
    refusal(&[folder, folder, "--nominal", "nominal.toml"], "cannot be used with");
}
