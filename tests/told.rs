//! Tests on effects of which a part is not told by the record: what is told is named all the same.

use crate::support::{number, trainer};
use serde_json::Value;
use std::io::Write;
use std::process::Command;
use tempfile::TempDir;

/// Diagnoses a log of one column with a linear nominal simulator of 2 rad/s².
fn diagnosed(column: &str, values: impl Fn(f64) -> f64) -> Value {
    diagnosed_in(&tempfile::tempdir().unwrap(), column, values)
}

/// Does the same in a folder, and leaves the answer in `out` there.
fn diagnosed_in(scratch: &TempDir, column: &str, values: impl Fn(f64) -> f64) -> Value {
    let path = |name: &str| scratch.path().join(name).to_str().unwrap().to_owned();
    let noise = |at: u32| (f64::from(at) * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0) - 0.5;
    let rows = (0..4000)
        .map(|at| format!("{},{}\n", 0.01 * f64::from(at), values(0.01 * f64::from(at)) + 0.03 * noise(at)));
    std::fs::write(path("log.csv"), format!("time_s,{column}\n{}", rows.collect::<String>())).unwrap();
    let nominal = "inertia = 1.0\ndamping = 0.08\nstiffness = 14.0\nrest_angle = 0.0\n";
    std::fs::write(path("nominal.toml"), nominal).unwrap();
    let [log, nominal, out] = ["log.csv", "nominal.toml", "out"].map(path);
    let output = trainer(&["diagnose", &log, "--nominal", &nominal, "--json", "--out", &out]);
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Regression: a gyroscope does not see where down is, and gravity was unknown at 30 times the noise.
#[test]
fn gravity_is_named_though_its_direction_is_not_seen() {
    let (mut x, mut v) = (1.0_f64, 0.0);
    let step = 1e-3;
    let rates: Vec<f64> = (0..40_000)
        .map(|_| {
            let seen = v;
            let half = v - 0.5 * step * (14.0 * x.sin() + 0.08 * v);
            x += step * half;
            v = half - 0.5 * step * (14.0 * x.sin() + 0.08 * half);
            seen
        })
        .collect();
    let found = diagnosed("velocity_rad_s", |time| rates[(time * 1000.0).round() as usize]);
    assert_eq!(found["verdict"]["effects"], serde_json::json!(["gravity"]), "{}", found["verdict"]);
    assert!(number(&found, "/gap/ratio_to_floor") < 1.2, "{}", found["gap"]);
}

/// Regression: the center of a sensor's range near zero was taken for a clipping of no size.
#[test]
fn a_clipping_is_named_though_its_center_is_zero() {
    let omega = (14.0_f64 - 0.0016).sqrt();
    let found =
        diagnosed("angle_rad", |time| (2.0 * (-0.04 * time).exp() * (omega * time).cos()).clamp(-1.4, 1.4));
    assert_eq!(found["verdict"]["effects"], serde_json::json!(["sensor_saturation"]), "{}", found["verdict"]);
    assert!(number(&found, "/gap/ratio_to_floor") < 1.2, "{}", found["gap"]);
}

/// Regression: the second body of the repaired simulator started relaxed, so that its motion did not beat.
#[test]
fn a_repaired_simulator_shows_both_modes_from_the_start() {
    let mode = |time: f64, size: f64, rate: f64, omega: f64, phase: f64| {
        size * (-rate * time).exp() * (omega * time + phase).cos()
    };
    let both = |time: f64| mode(time, 0.9, 0.02, 3.6, 0.3) + mode(time, 0.6, 0.05, 4.9, -1.0);
    let scratch = tempfile::tempdir().unwrap();
    let found = diagnosed_in(&scratch, "angle_rad", both);
    assert_eq!(found["verdict"]["effects"], serde_json::json!(["flexible_coupling"]), "{}", found["verdict"]);
    if !Command::new("python3").args(["-c", "import scipy"]).output().is_ok_and(|run| run.status.success()) {
        let line = b"SKIPPED: SciPy is not installed, so the repaired simulator was not run\n";
        std::io::stderr().write_all(line).unwrap();
        return;
    }
    let run = Command::new("python3").arg(scratch.path().join("out/repaired.py")).output().unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert!(rows.len() >= 3999, "{}", String::from_utf8_lossy(&run.stderr));
    let squares: f64 = rows.iter().map(|row| (row[1] - both(row[0])).powi(2)).sum();
    // The noise of a sample is 0.0087, and either mode alone leaves more than 0.1.
    assert!((squares / rows.len() as f64).sqrt() < 3e-3, "{}", (squares / rows.len() as f64).sqrt());
}
