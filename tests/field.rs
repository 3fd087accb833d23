//! Tests on logs of the kinds that people have, in their folder beside the project; skipped with a notice if
//! they are absent. Each is looked at by `trainer init` without knowing more than a new user.

use crate::support::{number, root, trainer};
use serde_json::Value;
use std::io::Write;
use std::path::PathBuf;

/// Log with the options a user gives, and the frequency in hertz and damping ratio that it has, each with the
/// largest relative deviation.
pub(crate) type Log = (&'static str, &'static [&'static str], [f64; 2], [f64; 2]);

/// Published or made values, from the notes beside the logs; least squares on the samples where those state
/// none.
pub(crate) const LOGS: &[Log] = &[
    ("tracker-xy/tracker.txt", &[], [0.413, 0.01], [0.0023, 0.3]),
    ("phyphox-gyro-axis/Raw Data.csv", &[], [0.773, 0.01], [0.0083, 0.4]),
    ("handled-start-and-stop/gyro.csv", &[], [0.773, 0.01], [0.0083, 0.4]),
    ("handled-start-and-stop/handled.csv", &[], [0.770, 1e-3], [0.0080, 0.02]),
    ("multi-run-own-time/pasco2.csv", &[], [1.1, 1e-3], [0.012, 0.02]),
    ("multi-run-own-time/pasco2.csv", &["--run", "2"], [1.1, 1e-3], [0.012, 0.02]),
    ("multi-run-own-time/pasco2.csv", &["--value", "Position (m) Run #2"], [1.1, 1e-3], [0.012, 0.02]),
    ("multi-run-own-time/vernier2.csv", &["--value", "Latest: Position (m)"], [1.1, 1e-3], [0.012, 0.02]),
    ("sparse-command-column/joint.csv", &[], [2.135, 0.03], [0.5217, 0.15]),
    ("encoder-wrap-and-counts/deg-wrap180.csv", &[], [1.1005, 1e-3], [0.030, 0.01]),
    ("encoder-wrap-and-counts/ticks-plain.csv", &[], [1.1005, 1e-3], [0.030, 0.01]),
    ("encoder-wrap-and-counts/ticks-signmag.csv", &[], [1.1005, 1e-3], [0.030, 0.01]),
    (
        "encoder-wrap-and-counts/ticks-wrap4096.csv",
        &["--counts-per-turn", "4096"],
        [1.1005, 1e-3],
        [0.030, 0.01],
    ),
    ("torsion-many-turns/torsion-deg.csv", &[], [0.21, 1e-3], [0.006, 0.01]),
    ("labview-lvm/no-time-column-decimal-comma.lvm", &["--input", "none"], [18.0, 5e-3], [0.01, 0.1]),
    ("labview-lvm/one-time-column.lvm", &[], [12.4, 1e-3], [0.011, 0.02]),
    ("no-header/two-columns.txt", &[], [0.5615, 5e-3], [0.0083, 0.1]),
    (
        "no-header/one-column-1kHz.txt",
        &["--sample-rate", "1000", "--unit", "deg"],
        [1.25, 1e-3],
        [0.01, 0.01],
    ),
    ("no-header/serial-monitor.txt", &[], [1.3, 1e-3], [0.02, 0.01]),
    ("units-row-in-blanks/free-decay.out", &[], [0.00934, 5e-3], [0.062, 0.2]),
    ("units-row-in-blanks/short.txt", &[], [1.2733, 1e-3], [0.0125, 0.01]),
    ("step-response/step.csv", &[], [0.0747, 0.01], [0.611, 0.01]),
    ("differenced-encoder-velocity/velocity.csv", &[], [1.2, 2e-3], [0.02, 0.1]),
];

pub(crate) fn field(name: &str) -> Option<PathBuf> {
    let path = root().join("../shared/field").join(name);
    if !path.exists() {
        let line = format!("SKIPPED: the log {} is not there\n", path.display());
        std::io::stderr().write_all(line.as_bytes()).unwrap();
        return None;
    }
    Some(path)
}

/// Looks at a log; returns the answer, or the message of a refusal.
pub(crate) fn look(path: &std::path::Path, options: &[&str]) -> Result<Value, String> {
    let scratch = tempfile::tempdir().unwrap();
    look_into(&scratch.path().join("out"), path, options)
}

/// Looks at a log and writes the files into a folder.
fn look_into(out: &std::path::Path, path: &std::path::Path, options: &[&str]) -> Result<Value, String> {
    let mut arguments = vec!["init", path.to_str().unwrap(), "--json", "--out", out.to_str().unwrap()];
    arguments.extend(options);
    let output = trainer(&arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    serde_json::from_slice(&output.stdout).map_err(|_| message)
}

#[test]
fn every_log_has_its_frequency_and_its_damping() {
    for (name, options, [frequency, frequency_part], [ratio, ratio_part]) in LOGS {
        let Some(path) = field(name) else { continue };
        let found = look(&path, options).unwrap_or_else(|message| panic!("{name}: {message}"));
        let near = |found: f64, expected: f64, part: f64| {
            assert!((found / expected - 1.0).abs() < part, "{name} {options:?}: {found} for {expected}");
        };
        near(number(&found, "/oscillator/natural_frequency_hz/value"), *frequency, *frequency_part);
        near(number(&found, "/oscillator/damping_ratio/value"), *ratio, *ratio_part);
    }
}

/// Regression: on 14 of 46 public logs the commands that were printed failed.
#[test]
fn an_estimate_that_is_printed_works_and_agrees() {
    for (name, options, _, [ratio, part]) in LOGS {
        let Some(path) = field(name) else { continue };
        let scratch = tempfile::tempdir().unwrap();
        let out = scratch.path().join("out");
        let found = look_into(&out, &path, options).unwrap();
        let configuration = out.join("estimate.toml");
        let is_printed = found["next"].to_string().contains("estimate.toml");
        assert_eq!(is_printed, configuration.exists(), "{name}");
        if !is_printed {
            continue;
        }
        let run = scratch.path().join("run");
        let [configuration, run] = [&configuration, &run].map(|path| path.to_str().unwrap());
        let output = trainer(&[configuration, "--json", "--out", run]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let result: Value = serde_json::from_slice(&output.stdout).unwrap();
        let zeta = number(&result, "/estimate/zeta");
        assert!((zeta / ratio - 1.0).abs() < *part, "{name} {options:?}: {zeta} for {ratio}");
    }
}

/// Few peaks, noise and other modes leave the damping to the samples, and that is said.
#[test]
fn samples_serve_where_peaks_do_not() {
    for (name, because, zeta, part) in [
        ("step-response/step.csv", "peaks", 0.611, 0.01),
        ("coupled-pendulums/pendulum.csv", "the record holds 2 modes", 0.0016, 0.2),
    ] {
        let Some(path) = field(name) else { continue };
        let scratch = tempfile::tempdir().unwrap();
        let out = scratch.path().join("out");
        look_into(&out, &path, &[]).unwrap();
        let configuration = out.join("estimate.toml");
        let run = |options: &[&str]| {
            let run = scratch.path().join(format!("run{}", options.len()));
            let mut arguments =
                vec![configuration.to_str().unwrap(), "--json", "--out", run.to_str().unwrap()];
            arguments.extend(options);
            trainer(&arguments)
        };
        let result: Value = serde_json::from_slice(&run(&[]).stdout).unwrap();
        assert_eq!(result["envelope"]["pipeline"], "samples", "{name}");
        assert!(result["envelope"]["pipeline_because"].to_string().contains(because), "{name}: {result}");
        let modes = result["modes"].as_array().map_or(1, Vec::len);
        assert_eq!(modes, if because.contains("2 modes") { 2 } else { 1 }, "{name}");
        let found = number(&result, "/estimate/zeta");
        assert!((found / zeta - 1.0).abs() < part, "{name}: {found}");
        let peaks = run(&["envelope.pipeline=recommended"]);
        let is_right = serde_json::from_slice::<Value>(&peaks.stdout)
            .is_ok_and(|result| (number(&result, "/estimate/zeta") / zeta - 1.0).abs() < part);
        assert!(!is_right, "{name}: the peaks serve as well");
    }
}

/// Regression: a lift by hand was fitted as dynamics.
#[test]
fn a_lift_by_hand_is_left_out_and_said() {
    let Some(path) = field("rest-lift-hold-release/free_oscillation.csv") else { return };
    let found = look(&path, &[]).unwrap();
    let part = &found["record"]["reading"]["part_s"];
    let from = part[0].as_f64().unwrap();
    assert!((from - 4.8).abs() < 0.05, "{part}");
    let outline = found["record"]["reading"]["whole"]["outline"].as_array().unwrap();
    assert!(outline.len() > 400 && outline[0][0].as_f64().unwrap() < 0.1, "{}", outline.len());
    assert!(found["record"]["findings"].to_string().contains("swings freely from 4.8"), "{found}");
    let whole = look(&path, &["--from", "0"]).unwrap();
    assert_eq!(whole["record"]["samples"], 3398);
    let message = look(&path, &["--from", "1", "--to", "1.01"]).unwrap_err();
    assert!(message.contains("set --from and --to to times between them"), "{message}");
}

#[test]
fn without_a_swing_no_command_is_printed_that_fails() {
    for name in ["critically-damped/seismometer.txt", "critically-damped/overdamped.csv"] {
        let Some(path) = field(name) else { continue };
        let found = look(&path, &[]).unwrap();
        let next: Vec<&str> =
            found["next"].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
        assert!(!next.iter().any(|line| line.contains("estimate.toml")), "{name}: {next:?}");
        assert!(!found["record"]["findings"].as_array().unwrap().is_empty(), "{name}");
    }
}

/// Regression: one frequency between two modes was printed, which neither of them has.
#[test]
fn two_modes_are_both_shown() {
    let Some(path) = field("coupled-pendulums/pendulum.csv") else { return };
    let found = look(&path, &[]).unwrap();
    let modes = found["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 2, "{modes:?}");
    let of = |at: usize, key: &str| number(&found, &format!("/modes/{at}/{key}/value"));
    assert!((of(0, "frequency_hz") - 0.509).abs() < 1e-3 && (of(0, "damping_ratio") - 0.0015).abs() < 3e-4);
    assert!((of(1, "frequency_hz") - 0.538).abs() < 1.5e-3 && of(1, "damping_ratio").abs() < 8e-4);
    assert_eq!(number(&found, "/oscillator/natural_frequency_hz/value"), of(0, "frequency_hz"));
    let one = look(&field("tracker-xy/tracker.txt").unwrap(), &[]).unwrap();
    assert!(one["modes"].as_array().unwrap().is_empty());
}

/// Regression: without a gain in the nominal simulator, the command of a driven joint was left out in silence.
#[test]
fn a_gain_that_is_not_stated_is_taken_from_the_record() {
    let Some(path) = field("well-damped-driven-joint/right-nominal-zeta052.csv") else { return };
    let scratch = tempfile::tempdir().unwrap();
    let nominal = scratch.path().join("nominal.toml");
    std::fs::write(&nominal, "inertia = 1.0\ndamping = 14.0\nstiffness = 180.0\nrest_angle = 0.0\n").unwrap();
    let diagnose = |more: &[&str]| {
        let out = scratch.path().join(format!("out{}", more.len()));
        let [record, nominal, out] = [&path, &nominal, &out].map(|path| path.to_str().unwrap());
        let mut arguments = vec!["diagnose", record, "--nominal", nominal, "--json", "--out", out];
        arguments.extend(more);
        serde_json::from_slice::<Value>(&trainer(&arguments).stdout).unwrap()
    };
    let found = diagnose(&[]);
    assert!(
        number(&found, "/gap/recalibrated") < 1.2 * number(&found, "/gap/noise_floor"),
        "{}",
        found["gap"]
    );
    assert!(
        found["records"][0]["findings"].to_string().contains("states no input_gain"),
        "{}",
        found["records"]
    );
    let alone = diagnose(&["--input", "none"]);
    assert!(number(&alone, "/gap/nominal") > 100.0 * number(&alone, "/gap/noise_floor"), "{}", alone["gap"]);
}
