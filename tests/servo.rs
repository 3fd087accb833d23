//! Servo joints: position commands, an inner loop of about known gain, an angle read back.

use crate::support::{number, trainer};
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::Path;
use tempfile::TempDir;

/// Inertia, gains and rate of the simulated joint.
const INERTIA: f64 = 0.02;
const GAIN: f64 = 3.0;
const DERIVATIVE: f64 = 0.12;
const RATE: f64 = 100.0;

/// A joint whose loop differentiates its error, under a sum of sines; `friction` in N m, `delay` in s.
struct Joint {
    friction: f64,
    delay: f64,
    /// Factor on the command; 0 for one that stands still.
    size: f64,
}

impl Joint {
    fn command(&self, time: f64) -> [f64; 2] {
        let lines = [(0.12, 0.4, 0.3), (0.1, 0.9, 1.9), (0.06, 2.1, 4.0), (0.05, 3.3, 0.8)];
        let of = |(size, hertz, phase): (f64, f64, f64)| {
            let angle = TAU * hertz * time + phase;
            [size * angle.sin(), size * TAU * hertz * angle.cos()]
        };
        lines
            .map(of)
            .iter()
            .fold([0.0; 2], |[u, rate], own| [u + self.size * own[0], rate + self.size * own[1]])
    }

    /// Simulates the joint in steps of a twentieth of a millisecond, and writes its log.
    fn write(&self, path: &Path, seconds: f64) {
        let step = 5e-5;
        let between = (1.0 / RATE / step).round() as usize;
        let (mut position, mut velocity) = (0.0_f64, 0.0_f64);
        let mut text = "time_s,command_rad,angle_rad\n".to_owned();
        let mut noise = 1_u64;
        for at in 0..(seconds / step) as usize {
            let time = step * at as f64;
            if at % between == 0 {
                let mut draw = || {
                    noise =
                        noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (noise >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
                };
                let scatter: f64 = 4e-4 * (0..6).map(|_| draw()).sum::<f64>();
                let [command, _] = self.command(time);
                text.push_str(&format!("{time:.4},{command:.7},{:.7}\n", position + scatter));
            }
            let [command, rate] = self.command(time - self.delay);
            let loops = GAIN * (command - position) + DERIVATIVE * (rate - velocity);
            let torque = loops - self.friction * (velocity / 1e-4).tanh();
            velocity += step * torque / INERTIA;
            position += step * velocity;
        }
        std::fs::write(path, text).unwrap();
    }
}

/// Diagnoses joints with a nominal simulator. Returns the exit code, the answer, and what was said.
fn diagnosed(joints: &[Joint], nominal: &str) -> (Option<i32>, Value, String) {
    let scratch: TempDir = tempfile::tempdir().unwrap();
    let path = |name: &str| scratch.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("nominal.toml"), nominal).unwrap();
    let logs: Vec<String> = (0..joints.len()).map(|at| path(&format!("log-{at}.csv"))).collect();
    for (joint, log) in joints.iter().zip(&logs) {
        joint.write(Path::new(log), 16.0);
    }
    let (file, out) = (path("nominal.toml"), path("out"));
    let mut arguments = vec!["diagnose"];
    arguments.extend(logs.iter().map(String::as_str));
    arguments.extend(["--nominal", &file, "--json", "--out", &out]);
    let output = trainer(&arguments);
    let answer = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (output.status.code(), answer, String::from_utf8_lossy(&output.stderr).into_owned())
}

/// The loop as it is, with the given ways of stating the gains.
fn servo(proportional: &str, derivative: &str) -> String {
    format!(
        "inertia = {INERTIA}\n[actuator]\nkind = \"position\"\nproportional = {proportional}\nderivative = {derivative}\n\
         derivative_on = \"error\"\n"
    )
}

const FREE: Joint = Joint { friction: 0.0, delay: 0.0, size: 1.0 };

#[test]
fn a_loop_that_is_stated_lacks_nothing() {
    let (code, found, said) = diagnosed(&[FREE], &servo("3.0", "0.12"));
    assert_eq!(code, Some(0), "{said}");
    let status = found["verdict"]["status"].as_str().unwrap();
    assert!(["none", "calibration"].contains(&status), "{}", found["verdict"]);
    assert!(number(&found, "/gap/ratio_to_floor") < 1.1, "{}", found["gap"]);
}

/// Regression: a line of the command was named as a forcing.
#[test]
fn a_loop_on_the_error_is_no_forcing() {
    let plain = format!(
        "inertia = {INERTIA}\ndamping = {DERIVATIVE}\nstiffness = {GAIN}\nrest_angle = 0.0\ninput_gain = {GAIN}\n"
    );
    let (_, found, _) = diagnosed(&[FREE], &plain);
    assert!(found["verdict"]["effects"].to_string().contains("command_derivative"), "{}", found["verdict"]);
    let forcing = found["classes"].as_array().unwrap().iter().find(|class| class["id"] == "forcing");
    assert!(forcing.is_none_or(|class| class["probability"].as_f64().unwrap() < 0.2), "{forcing:?}");
}

#[test]
fn friction_and_a_delay_are_told_beside_an_unknown_gain_as_ratios() {
    let joint = Joint { friction: 0.04, delay: 0.02, size: 1.0 };
    let (_, found, said) = diagnosed(&[joint], &servo("{ value = 3.6, tolerance = 1.2 }", "\"unknown\""));
    let effects = found["verdict"]["effects"].to_string();
    assert!(
        effects.contains("coulomb_friction") && effects.contains("input_delay"),
        "{said} {}",
        found["verdict"]
    );
    let ratio = number(&found, "/actuator/ratios/coulomb_friction.torque/value");
    assert!((ratio * GAIN / 0.04 - 1.0).abs() < 0.05, "{ratio}");
    assert_eq!(found["actuator"]["gain"]["stated"], "about");
    // The torque itself is as uncertain as the gain: 1.2 of 3.6.
    let rows = found["effects"].as_array().unwrap();
    let friction = rows.iter().find(|row| row["id"] == "coulomb_friction").unwrap();
    let ends = &friction["parameters"]["torque"]["interval_95"];
    let [low, high] = [0, 1].map(|at| ends[at].as_f64().unwrap());
    assert!(low < 0.04 && 0.04 < high && (high - low) / (high + low) > 0.3, "{ends}");
}

#[test]
fn a_recording_in_which_the_joint_stands_still_is_left_out_and_named() {
    let still = || Joint { friction: 0.0, delay: 0.0, size: 0.0 };
    let (code, found, said) = diagnosed(&[FREE, still()], &servo("3.0", "0.12"));
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(found["records"].as_array().unwrap().len(), 1);
    let findings = found["records"][0]["findings"].to_string();
    assert!(findings.contains("log-1.csv is left out"), "{findings}");
    let (code, _, said) = diagnosed(&[still(), Joint { size: 1e-9, ..still() }], &servo("3.0", "0.12"));
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("in every recording") && said.lines().count() == 1, "{said}");
}

#[test]
fn a_command_that_follows_the_angle_is_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let [log, nominal, out] = ["log.csv", "nominal.toml", "out"].map(|name| scratch.path().join(name));
    std::fs::write(&nominal, servo("3.0", "0.12")).unwrap();
    Joint { friction: 0.04, delay: 0.02, size: 1.0 }.write(&log, 16.0);
    let text = std::fs::read_to_string(&log).unwrap();
    let exchanged = text.replacen("command_rad,angle_rad", "angle_rad,command_rad", 1);
    std::fs::write(&log, exchanged).unwrap();
    let [log, nominal, out] = [&log, &nominal, &out].map(|path| path.to_str().unwrap());
    let output = trainer(&["diagnose", log, "--nominal", nominal, "--out", out, "--quiet"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("--input angle_rad --value command_rad") && said.lines().count() == 1, "{said}");
}
