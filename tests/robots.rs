//! Tests of `trainer diagnose LOG… --nominal ARM.urdf`: a robot of several joints.

use crate::support::{measured, number, result, skipped, trainer};
use dynamics::Active;
use dynamics::tree::{Acting, State, rollout};
use robot::Urdf;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// Two links on parallel axes, as URDF.
const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 -0.25"/><mass value="0.8"/><inertia ixx="0.006" iyy="0.006" izz="0.001"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 -0.2"/><mass value="0.5"/><inertia ixx="0.004" iyy="0.004" izz="0.001"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/></joint>
</robot>
"#;

/// Dry friction of the elbow in N m.
const FRICTION: f64 = 0.12;

/// Writes the arm and a recording of 10 s at 200 Hz, with dry friction in the elbow, steps of the encoder and noise of the torque
/// sensor. Returns the paths of the recording and of the model.
fn recorded(folder: &Path) -> [String; 2] {
    let arm = Urdf::parse("arm.urdf", ARM).unwrap();
    let friction = Active::named("coulomb_friction", &[("torque", FRICTION)]).unwrap();
    let damped = Acting { damping: 0.2, ..Acting::default() };
    let acting = [damped.clone(), Acting { effects: vec![friction], damping: 0.0, ..damped }];
    let times: Vec<f64> = (0..2000).map(|at| f64::from(at) * 5e-3).collect();
    let torques: Vec<Vec<f64>> = times
        .iter()
        .map(|t| {
            vec![
                0.9 * (3.0 * t).sin() + 0.8 * (7.3 * t).sin(),
                0.35 * (5.5 * t + 1.0).sin() + 0.25 * (2.1 * t).cos(),
            ]
        })
        .collect();
    let start = State { position: vec![0.3, -0.2], velocity: vec![0.0; 2] };
    let path = rollout(arm.tree(), &acting, &start, &times, &torques).unwrap();
    let mut state = 5_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
    };
    let step = std::f64::consts::TAU / 8192.0;
    let mut text =
        "# origin: simulated\ntime_s,shoulder_position,elbow_position,shoulder_torque,elbow_torque\n"
            .to_owned();
    for ((time, position), torque) in times.iter().zip(&path).zip(&torques) {
        let [first, second] = [position[0], position[1]].map(|own| ((own / step) + uniform()).round() * step);
        let (shoulder, elbow) = (torque[0] + 0.1 * uniform(), torque[1] + 0.06 * uniform());
        writeln!(text, "{time:.3},{first:.6},{second:.6},{shoulder:.5},{elbow:.5}").unwrap();
    }
    let [log, model] = ["log.csv", "arm.urdf"].map(|name| folder.join(name));
    std::fs::write(&log, text).unwrap();
    std::fs::write(&model, ARM).unwrap();
    [log, model].map(|path| path.to_str().unwrap().to_owned())
}

#[test]
fn friction_in_one_joint_is_named_there_and_written_back() {
    let scratch = tempfile::tempdir().unwrap();
    let [log, model] = recorded(scratch.path());
    let (code, found, folder) = result(&["diagnose", &log, "--nominal", &model]);
    assert_eq!((code, found["schema"].as_str()), (0, Some("ringdown.joints/1")));
    let joint =
        |name: &str| found["joints"].as_array().unwrap().iter().find(|own| own["name"] == name).unwrap();
    let named = |name: &str| -> Vec<String> {
        let classes = joint(name)["diagnosis"]["classes"].as_array().unwrap();
        let of_motion = classes.iter().filter(|own| own["id"] != "sensor" && own["id"] != "stamps");
        let likely = of_motion.filter(|own| own["probability"].as_f64().unwrap() > 0.5);
        likely.map(|own| own["id"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(named("elbow"), ["friction"]);
    assert!(named("shoulder").is_empty(), "{:?}", named("shoulder"));
    let repaired = std::fs::read_to_string(folder.path().join("repaired.urdf")).unwrap();
    let robot = Urdf::parse("repaired.urdf", &repaired).unwrap();
    let joints = robot::Model::joints(&robot);
    assert!((joints[1].friction / FRICTION - 1.0).abs() < 0.1, "{repaired}");
    assert!((joints[0].damping / 0.2 - 1.0).abs() < 0.3, "{repaired}");
    let errors =
        |name: &str| ["nominal", "repaired"].map(|of| number(joint(name), &format!("/closed_loop/{of}")));
    for name in ["shoulder", "elbow"] {
        let [nominal, repaired] = errors(name);
        assert!(repaired < 0.2 * nominal, "{name}: {nominal} {repaired}");
        for file in ["report.html", "repaired.toml", "diagnosis.json"] {
            assert!(folder.path().join(name).join(file).is_file(), "{name}/{file}");
        }
    }
    assert_eq!(found["recordings"][0]["agrees"], true);
    let told = found["identifiable"].as_array().unwrap().iter();
    let told: Vec<&str> =
        told.filter(|own| own["told"] == true).map(|own| own["quantity"].as_str().unwrap()).collect();
    assert_eq!(told.iter().filter(|own| **own == "dry_friction").count(), 2, "{told:?}");
    assert!(found["closed_loop"]["held_out"].as_str().unwrap().contains("last third"));
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("href=\"elbow/report.html\"") && page.contains("The whole model"), "{page}");
}

#[test]
fn what_cannot_be_a_robots_recording_is_refused_with_one_message() {
    let scratch = tempfile::tempdir().unwrap();
    let [log, model] = recorded(scratch.path());
    let text = std::fs::read_to_string(&log).unwrap();
    let file = |name: &str, text: &str| {
        let path = scratch.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let refused = |log: &str, model: &str, more: &[&str], expected: &str| {
        let output = trainer(&[&["diagnose", log, "--nominal", model], more].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    };
    refused(
        &file("names.csv", &text.replace("shoulder", "a").replace("elbow", "b")),
        &model,
        &[],
        "whose joints are shoulder, elbow",
    );
    refused(
        &file("one.csv", &text.replace("elbow_position", "x")),
        &model,
        &[],
        "no column for the position of joint `elbow`",
    );
    let degrees: String = text
        .lines()
        .map(|line| {
            let cells: Vec<String> = line
                .split(',')
                .enumerate()
                .map(|(at, cell)| match cell.parse::<f64>() {
                    Ok(angle) if at == 1 || at == 2 => (angle.to_degrees()).to_string(),
                    _ => cell.to_owned(),
                })
                .collect();
            cells.join(",") + "\n"
        })
        .collect();
    refused(&file("degrees.csv", &degrees), &model, &[], "--unit deg");
    let short: String = text.lines().take(150).map(|line| format!("{line}\n")).collect();
    let short = file("short.csv", &short);
    refused(
        &log,
        &file(
            "empty.urdf",
            &ARM.replace("<mass value=\"0.5\"/>", "<mass value=\"0\"/>")
                .replace("ixx=\"0.004\" iyy=\"0.004\" izz=\"0.001\"", "ixx=\"0\" iyy=\"0\" izz=\"0\""),
        ),
        &[],
        "joint `elbow` moves no inertia",
    );
    let link =
        "<joint name=\"again\" type=\"fixed\"><parent link=\"base\"/><child link=\"lower\"/></joint></robot>";
    refused(&log, &file("loop.urdf", &ARM.replace("</robot>", link)), &[], "hangs on two joints, a loop");
    refused(&log, &file("mjcf.urdf", "<mujoco/>"), &[], "name its file with the ending .xml");
    refused(
        &file("no-torque.csv", &text.replace("elbow_torque", "x")),
        &model,
        &[],
        "no column for the torque of joint `elbow`",
    );
    refused(
        &log,
        &model,
        &["--joint", "wrist"],
        "`wrist` is no joint of the model; known are shoulder, elbow",
    );
    refused(&log, &model, &["--columns", "elbow"], "shoulder=q1,tau1");
    refused(&log, &model, &["--armature", "elbow=heavy"], "elbow=0.0028");
    refused(&log, &model, &["--check", &log], "are the same record");
    refused(&short, &model, &[], "lasts 0.7");
}

/// A second recording of the arm with twice the friction differs in nothing else.
#[test]
fn recordings_that_disagree_are_named_with_what_differs() {
    let scratch = tempfile::tempdir().unwrap();
    let [log, model] = recorded(scratch.path());
    let text = std::fs::read_to_string(&log).unwrap();
    // A torque of 0.1 N m against the motion of the elbow that the drive adds acts as friction less.
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(2)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let mut changed: String = text.lines().take(2).map(|line| format!("{line}\n")).collect();
    for (at, row) in rows.iter().enumerate() {
        let [before, after] = [at.saturating_sub(10), (at + 10).min(rows.len() - 1)].map(|at| rows[at][2]);
        let torque = row[4] + 0.1 * (after - before).signum();
        writeln!(changed, "{},{},{},{},{torque}", row[0], row[1], row[2], row[3]).unwrap();
    }
    let other = scratch.path().join("other.csv");
    std::fs::write(&other, changed).unwrap();
    let other = other.to_str().unwrap();
    let (_, found, _folder) = result(&["diagnose", &log, other, "--nominal", &model, "--joint", "elbow"]);
    for recording in found["recordings"].as_array().unwrap() {
        assert_eq!(recording["agrees"], false, "{recording}");
        assert!(
            recording["differs_in"].as_array().unwrap().contains(&"elbow: dry_friction".into()),
            "{recording}"
        );
    }
}

/// The arm as MJCF.
const MJCF: &str = r#"<mujoco><worldbody>
<body><joint name="shoulder" axis="0 1 0"/><inertial pos="0 0 -0.25" mass="0.8" diaginertia="0.006 0.006 0.001"/>
<body pos="0 0 -0.3"><joint name="elbow" axis="0 1 0"/><inertial pos="0 0 -0.2" mass="0.5" diaginertia="0.004 0.004 0.001"/></body></body>
</worldbody></mujoco>
"#;

#[test]
fn an_mjcf_is_read_through_python_and_written_back() {
    let mujoco = Command::new("python3").args(["-c", "import mujoco"]).output();
    if !mujoco.is_ok_and(|own| own.status.success()) {
        skipped("there is no python3 with mujoco on the PATH");
        return;
    }
    let scratch = tempfile::tempdir().unwrap();
    let [log, _] = recorded(scratch.path());
    let model = scratch.path().join("arm.xml");
    std::fs::write(&model, MJCF).unwrap();
    let (code, found, folder) =
        result(&["diagnose", &log, "--nominal", model.to_str().unwrap(), "--joint", "elbow"]);
    assert_eq!(code, 0);
    let effects = found.pointer("/joints/0/diagnosis/effects").unwrap().as_array().unwrap();
    let torque = effects.iter().find(|own| own["id"] == "coulomb_friction").unwrap();
    assert!((number(torque, "/parameters/torque/value") / FRICTION - 1.0).abs() < 0.1, "{torque}");
    let repaired = std::fs::read_to_string(folder.path().join("repaired.xml")).unwrap();
    assert!(repaired.contains("<joint name=\"elbow\" axis=\"0 1 0\" damping="), "{repaired}");
    assert!(repaired.contains("frictionloss=\"0.1"), "{repaired}");
}

/// Messages of the interpreter reach the user as one line, and so does its absence.
#[cfg(unix)]
#[test]
fn an_mjcf_without_python_or_its_mujoco_is_refused_with_one_message() {
    use std::os::unix::fs::PermissionsExt as _;
    let scratch = tempfile::tempdir().unwrap();
    let model = scratch.path().join("arm.xml");
    std::fs::write(&model, MJCF).unwrap();
    let empty = scratch.path().join("bin");
    std::fs::create_dir(&empty).unwrap();
    let refused = |expected: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trainer"));
        command.args(["diagnose", "log.csv", "--nominal"]).arg(&model).env("PATH", &empty);
        let output = command.output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected) && message.lines().count() == 1, "{message}");
    };
    refused("there is no python3 on the PATH");
    let python = empty.join("python3");
    let said = "MJCF models are read by mujoco, which is not installed: pip install mujoco";
    std::fs::write(&python, format!("#!/bin/sh\necho '{{\"refused\": \"{said}\"}}'\n")).unwrap();
    std::fs::set_permissions(&python, std::fs::Permissions::from_mode(0o755)).unwrap();
    refused(said);
    std::fs::write(&python, "#!/bin/sh\n").unwrap();
    refused("ended without an answer");
}

/// The laboratory publishes 0.123 N m for the elbow.
#[test]
fn the_double_pendulum_lacks_dry_friction_in_its_elbow() {
    let (Some(log), Some(model)) =
        (measured("double-pendulum/excited-b.csv"), measured("double-pendulum/arm.urdf"))
    else {
        return;
    };
    let (_, found, _folder) = result(&["diagnose", &log, "--nominal", &model, "--joint", "elbow"]);
    let classes = found.pointer("/joints/0/diagnosis/classes").unwrap().as_array().unwrap();
    let friction = classes.iter().find(|own| own["id"] == "friction").unwrap();
    assert!(number(friction, "/probability") > 0.9, "{friction}");
    let effects = found.pointer("/joints/0/diagnosis/effects").unwrap().as_array().unwrap();
    let torque = number(
        effects.iter().find(|own| own["id"] == "coulomb_friction").unwrap(),
        "/parameters/torque/value",
    );
    assert!((torque / 0.123 - 1.0).abs() < 0.3, "{torque}");
}
