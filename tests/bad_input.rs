//! Tests of bad input: exit code 2, one clear message, and no panic.

use crate::support::{root, trainer};
use std::path::Path;

/// Runs the PINN on a file with the given content and expects a refusal with these words.
fn refused(content: &[u8], arguments: &[&str], expected: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("record.csv");
    std::fs::write(&file, content).unwrap();
    let path = format!("data.path={}", file.display());
    let mut all = vec!["configs/pinn.toml", &path];
    all.extend(arguments);
    let message = refusal(&all);
    for words in expected {
        assert!(message.contains(words), "no `{words}` in: {message}");
    }
}

/// Runs the program; expects exit code 2, one line on standard error and nothing on standard output.
fn refusal(arguments: &[&str]) -> String {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    let mut all = arguments.to_vec();
    all.extend(["--out", out.to_str().unwrap()]);
    let output = trainer(&all);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty(), "{:?}", output.stdout);
    assert_eq!(message.trim_end().lines().count(), 1, "{message}");
    assert!(message.starts_with("error: "), "{message}");
    assert!(!message.contains("panicked"), "{message}");
    message
}

/// Runs a simulation with these overrides and expects a refusal with these words.
fn not_simulated(arguments: &[&str], expected: &str) {
    let message = refusal(&[&["simulate", "configs/default-record.toml"], arguments].concat());
    assert!(message.contains(expected), "no `{expected}` in: {message}");
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    not_simulated(&["effects.1.id=columb_friction"], "did you mean `coulomb_friction`?");
    not_simulated(&["nominal.inertia=-1"], "`nominal.inertia` is -1; expected a finite number above 0 (");
    not_simulated(&["nominal.damping.from=1e-4"], "expected a number, or a prior");
    not_simulated(&["sensor.noise=-1"], "`sensor.noise` is -1; expected a finite number from 0 up (rad)");
    not_simulated(&["effects.4.parameters.step=3"], "`step` is 3, but must be at most");
    not_simulated(&["effects.5.parameters.interval=0.001"], "a shorter burst holds zero samples");
    not_simulated(&["effects.9.id=sensor_lag"], "`effects.9.parameters.time_constant` is missing");
    not_simulated(&["record.seconds=0.03"], "default-record.toml: system 0, record 0: ");
    not_simulated(&["record.decimals=3"], "unknown key `record.decimals`");
    let message = refusal(&["simulate", "configs/no-such.toml"]);
    assert!(message.contains("configs/no-such.toml: cannot be read"), "{message}");
    for command in ["simulate", "trials"] {
        let message = refusal(&[command, "configs/pinn.toml"]);
        let told =
            "this is a configuration for the task \"estimate\", which `trainer configs/pinn.toml` runs";
        assert!(message.contains("configs/pinn.toml:23:1: ") && message.contains(told), "{message}");
    }
}

#[test]
fn a_name_that_is_nearly_right_is_answered_with_the_right_one() {
    let record = "experiments/default-record/record.csv";
    let refused = trainer(&["diagnose", record, "--nominal", "nominal.toml", "--without", "coulomb"]);
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(message.contains("did you mean coulomb_friction?"), "{message}");
    let message = refusal(&["no-such-configuration.toml"]);
    assert!(message.contains("(looked for in "), "{message}");
    let scratch = tempfile::tempdir().unwrap();
    let guess = scratch.path().join("nominal.toml");
    std::fs::write(&guess, "natural_frequency = 3.5\ndamping_ratio = 0.01\n").unwrap();
    let message = refusal(&["simulate", guess.to_str().unwrap()]);
    assert!(message.contains("describes a nominal simulator by its frequency"), "{message}");
}

/// Returns a record of a decaying oscillation, one sample per line.
fn decay(samples: usize) -> String {
    let mut text = "time_s,angle_rad\n".to_owned();
    for i in 0..samples {
        let t = i as f64 * 0.01;
        text.push_str(&format!("{t:.3},{:.6}\n", (-0.2 * t).exp() * (6.0 * t).cos()));
    }
    text
}

#[test]
fn empty_file() {
    refused(b"", &[], &["record.csv: is empty"]);
    refused(b"\n  \n", &[], &["record.csv: is empty"]);
    refused(b"", &["data.format=host-log"], &["record.csv: is empty"]);
}

#[test]
fn header_alone_or_one_sample() {
    refused(b"time_s,angle_rad\n", &[], &["has 0 samples", "needs at least 8"]);
    refused(b"time_s,angle_rad\n0,1\n", &[], &["has 1 sample;", "needs at least 8"]);
}

#[test]
fn not_a_number() {
    let text = decay(50).replace("0.030,", "0.030,nan #");
    refused(text.as_bytes(), &[], &["record.csv:5: ", "is not a number"]);
    let mut lines: Vec<String> = decay(50).lines().map(str::to_owned).collect();
    lines[4] = "0.030,NaN".to_owned();
    let refuse = ["data.missing=refuse"];
    refused(lines.join("\n").as_bytes(), &refuse, &["record.csv:5: 1 missing cell", "data.missing"]);
    lines[4] = "0.030,inf".to_owned();
    refused(lines.join("\n").as_bytes(), &refuse, &["record.csv:5: 1 missing cell", "`angle_rad`"]);
}

#[test]
fn text_in_a_number() {
    let text = decay(50).replacen("0.060,", "0.060,about ", 1);
    refused(text.as_bytes(), &[], &["record.csv:8: ", "`about ", "`angle_rad` is not a number"]);
}

#[test]
fn decreasing_time() {
    let text = decay(50).replacen("0.060,", "0.035,", 1);
    refused(text.as_bytes(), &[], &["record.csv:8: ", "from 0.05 s to 0.035 s"]);
}

#[test]
fn missing_column() {
    let text = decay(50).replacen("angle_rad", "torque_nm", 1);
    let words =
        ["record.csv:1: ", "no column `angle`, `displacement` or `position`", "`torque_nm`", "data.value"];
    refused(text.as_bytes(), &[], &words);
    refused(decay(50).as_bytes(), &["data.value=q"], &["no column `q`"]);
    refused(decay(50).as_bytes(), &["data.angle=q"], &["no column `q`"]);
    refused(decay(50).as_bytes(), &["data.time=clock"], &["no column `clock`"]);
}

#[test]
fn a_line_cut_short() {
    let text = decay(50) + "0.500\n";
    refused(text.as_bytes(), &[], &["record.csv:52: ", "has 1 field; expected 2"]);
}

#[test]
fn a_file_of_another_kind() {
    let commas = decay(50).replace('.', ",");
    refused(commas.as_bytes(), &[], &["record.csv:2: 4 fields under a header of 2", "decimal points"]);
    let headless: Vec<String> = decay(50).lines().skip(1).map(str::to_owned).collect();
    let alone: Vec<&str> = headless.iter().filter_map(|line| line.split(',').nth(1)).collect();
    refused(alone.join("\n").as_bytes(), &[], &["record.csv: no column is a time", "data.sample_rate_hz"]);
    let log = decay(50);
    refused(log.as_bytes(), &["data.format=host-log"], &["record.csv:1: ", "set data.format = \"csv\""]);
}

#[test]
fn a_folder_for_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = format!("data.path={}", folder.path().display());
    assert!(refusal(&["configs/pinn.toml", &path]).contains("is a folder"));
}

#[test]
fn a_file_that_is_not_there() {
    assert!(refusal(&["configs/pinn.toml", "data.path=nowhere.csv"]).contains("nowhere.csv: cannot be read"));
    assert!(refusal(&["configs/nowhere.toml"]).contains("configs/nowhere.toml: cannot be read"));
    assert!(refusal(&["configs"]).contains("configs: cannot be read: it is a folder"));
}

#[test]
fn no_text_at_all() {
    refused(&[0x74, 0xff, 0xfe, 0x00], &[], &["is no text (byte 1)"]);
}

#[test]
fn a_record_without_peaks() {
    let mut text = "time_s,angle_rad\n".to_owned();
    for i in 0..500 {
        text.push_str(&format!("{:.2},{:.6}\n", i as f64 * 0.01, (-0.5 * i as f64 * 0.01).exp()));
    }
    for pipeline in ["paper", "recommended"] {
        let choice = format!("envelope.pipeline={pipeline}");
        let name = format!("the {pipeline} pipeline finds 0 peaks; a decay rate needs at least 3");
        refused(text.as_bytes(), &[&choice], &["record.csv: ", &name]);
    }
}

#[test]
fn every_stamp_the_same() {
    let text = "time_s,angle_rad\n".to_owned() + &"1.5,0.2\n".repeat(20);
    refused(text.as_bytes(), &[], &["every stamp is 1.5 s"]);
}

#[test]
fn a_host_log_that_is_none() {
    refused(
        decay(50).as_bytes(),
        &["data.format=host-log"],
        &["record.csv:1: ", "the header is `time_s,angle_rad`", "Time_Elapsed"],
    );
    let log = "Timestamp, Time_Elapsed(s), Angle(deg)\n----\n16:04:31.2, 1.0\n";
    refused(log.as_bytes(), &["data.format=host-log"], &["record.csv:3: ", "2 fields; expected 3"]);
    let log = "Timestamp, Time_Elapsed(s), Angle(deg)\n----\n16:64:31.2, 1.0, 2.0\n";
    refused(log.as_bytes(), &["data.format=host-log"], &["record.csv:3: ", "HH:MM:SS"]);
}

#[test]
fn unknown_key() {
    let message = refusal(&["configs/pinn.toml", "estimator.hiden=[3]"]);
    assert!(message.contains("unknown key `estimator.hiden`; did you mean `estimator.hidden`?"));
    let message = with_config("seed = 1\n[data]\nclok = \"host\"\n[estimator]\nname = \"pinn\"\n");
    assert!(message.contains(":3:1: unknown key `data.clok`; did you mean `data.clock`?"), "{message}");
}

#[test]
fn an_estimator_chosen_by_name_alone_beside_the_files_keys() {
    let message = refusal(&["configs/pinn.toml", "estimator.name=lstm"]);
    assert!(
        message.contains("`estimator.hidden` is no key of `lstm`; choose with estimator=lstm"),
        "{message}"
    );
}

#[test]
fn networks_that_no_memory_holds() {
    for name in ["pinn", "neural-ode"] {
        let estimator = format!("estimator={name}");
        let message = refusal(&["configs/pinn.toml", &estimator, "estimator.hidden=[256,256,256,256]"]);
        assert!(
            message.contains("`estimator.hidden` is [256, 256, 256, 256]; expected fewer or"),
            "{message}"
        );
        assert!(message.contains("GiB of memory; the limit is 16 GiB"), "{message}");
    }
    let output = trainer(&["check", "configs/pinn.toml", "estimator.hidden=[256,256,256,256]"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn unknown_estimator() {
    let message = with_config("[estimator]\nname = \"pin\"\n");
    assert!(message.contains(":2:1: unknown estimator \"pin\"; did you mean `pinn`?"), "{message}");
    let message = with_config("seed = 1\n");
    assert!(message.contains("`estimator.name` is missing"), "{message}");
}

#[test]
fn values_out_of_range() {
    for (argument, expected) in [
        ("seed=-1", "expected a whole number from 0 up"),
        ("seed=1.5", "expected a whole number from 0 up"),
        ("data.clock=sun", "expected one of \"host\", \"uniform-index\", \"auto\""),
        ("estimator.hidden=[]", "expected a list of 1 to 6 whole numbers, each from 1 to 256"),
        ("estimator.hidden=16", "expected a list of 1 to 6 whole numbers"),
        ("estimator.physics_weight=nan", "expected a finite number"),
        ("envelope.paper.interpolation_step_s=0", "expected a finite number"),
        ("fit.seeds=0", "expected a whole number from 1"),
    ] {
        let message = refusal(&["configs/pinn.toml", argument]);
        assert!(message.contains(expected), "{argument}: {message}");
    }
}

#[test]
fn broken_toml() {
    let message = with_config("seed = 1\n[data\n");
    assert!(message.contains(":2:"), "{message}");
}

#[test]
fn a_folder_with_something_in_it_is_not_written_into() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.txt");
    std::fs::write(&file, "mine").unwrap();
    let out = folder.path().to_str().unwrap();
    let output = trainer(&["configs/pinn.toml", "--out", out]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("never written over"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(std::fs::read_to_string(file).unwrap(), "mine");
}

#[test]
fn a_refusal_leaves_no_run_folder() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    let output = trainer(&["configs/pinn.toml", "data.path=nowhere.csv", "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!out.exists());
}

#[test]
fn bad_usage() {
    for arguments in [&["--nonsense"][..], &["configs/pinn.toml", "--threads", "0"]] {
        let output = trainer(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    }
    assert!(refusal(&["configs/pinn.toml", "seed"]).contains("`seed` is no override"));
}

fn with_config(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("config.toml");
    std::fs::write(&file, text).unwrap();
    assert!(Path::new(&root()).exists());
    refusal(&[file.to_str().unwrap()])
}

#[test]
fn a_classical_method_takes_no_cap_on_its_steps() {
    let message = refusal(&["configs/ols.toml", "fit.max_steps=3"]);
    assert!(message.contains("`fit.max_steps` is 3; expected to be left out"), "{message}");
}

#[test]
fn studies_of_prediction() {
    let quick = ["configs/beyond.toml", "predict.methods=ols", "predict.problems=dry-friction"];
    for (argument, expected) in [
        ("predict.methods=olz", "unknown method \"olz\"; did you mean `ols`?"),
        ("predict.problems=dry", "unknown problem \"dry\"; "),
        ("predict.draws=0", "expected a whole number from 1"),
        ("predict.last_share=1", "expected a finite number from 0.05 to 0.8"),
        ("problem.dry-friction.kind=dry", "expected one of \"exponential\", \"coulomb-viscous\""),
        ("problem.dry-friction.deadzone=1", "did you mean `problem.dry-friction.dead_zone`?"),
        ("problem.dry-friction.dead_zone=0.01", "dry friction ends the motion at turning point "),
        ("problem.dry-friction.scatter_size=0.1", "standard deviations of the scatter"),
        ("predict.block_peaks=60", "72 peaks cannot be split: interpolation needs three blocks"),
        ("problem.new.kind=record", "`problem.new.path` is missing"),
    ] {
        let message = refusal(&[&quick[..], &[argument]].concat());
        assert!(message.contains(expected), "{argument}: {message}");
    }
    let message = with_config("task = \"predict\"\n");
    assert!(message.contains("`problem.NAME` is missing: A study needs problems."), "{message}");
    let message = with_config("task = \"predict\"\n[problem.a]\n");
    assert!(message.contains("`problem.a.kind` is missing"), "{message}");
    let message = with_config("task = \"predict\"\n[problem.a]\nkind = \"exponential\"\ndead_zone = 1\n");
    assert!(message.contains(":4:1: unknown key `problem.a.dead_zone`"), "{message}");
    // A record that exists but cannot be used does not count as absent.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("record.csv");
    std::fs::write(&file, "time_s,angle_rad\n0,1\n").unwrap();
    let path = format!("problem.shipped-record.path={}", file.display());
    let message = refusal(&["configs/beyond.toml", "predict.problems=shipped-record", &path]);
    assert!(message.contains("record.csv: has 1 sample;"), "{message}");
}
