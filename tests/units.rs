//! Tests of mistaken units: the factor between them is recognized and reported.

use crate::gaps::driven;
use crate::reading::write;
use crate::support::{number, trainer};
use serde_json::Value;

/// Runs the program and returns its standard output as JSON.
fn answer(arguments: &[&str]) -> Value {
    let output = trainer(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {message}"))
}

/// Returns the text with every input times a factor, under another header.
fn scaled(text: &str, header: &str, factor: f64) -> String {
    text.lines().skip(1).fold(format!("{header}\n"), |scaled, line| {
        let (rest, input) = line.rsplit_once(',').unwrap();
        scaled + &format!("{rest},{:.9e}\n", input.parse::<f64>().unwrap() * factor)
    })
}

/// An input in kgf m, of degrees, in mN m or in turns, that was read as SI units.
#[test]
fn a_driven_record_names_the_factor_that_its_input_is_off_by() {
    let scratch = tempfile::tempdir().unwrap();
    let nominal = "inertia = 0.3333333\ndamping = 0.2666667\nstiffness = 21.333333\nrest_angle = 0.0\n\
                   input_gain = 1.0\n";
    let nominal = write(scratch.path(), "nominal.toml", nominal);
    let text = driven(16, false);
    for (at, (factor, words)) in [
        (1.0 / 9.806_65, "9.81 times smaller than the simulator states: is a force or a torque in kgf"),
        (180.0 / std::f64::consts::PI, "57.3 times larger than the simulator states: is an angle in degrees"),
        (1e3, "times larger than the simulator states: are mm, ms or mN m"),
        (1e-3, "times smaller than the simulator states: are mm, ms or mN m"),
        (std::f64::consts::TAU, "6.28 times larger than the simulator states: are turns, or Hz,"),
    ]
    .into_iter()
    .enumerate()
    {
        let log = write(scratch.path(), &format!("{at}.csv"), &scaled(&text, "time_s,angle_rad,u", factor));
        let out = scratch.path().join(format!("answer-{at}"));
        let arguments = ["diagnose", &log, "--input", "u", "--nominal", &nominal, "--json", "--out"];
        let found = answer(&arguments.into_iter().chain([out.to_str().unwrap()]).collect::<Vec<_>>());
        assert_eq!(found["verdict"]["status"], "calibration", "{factor}: {}", found["verdict"]);
        let said = found["verdict"]["summary"].as_str().unwrap();
        assert!(said.contains(words), "{factor}: {said}");
    }
    // With the right unit stated there is no factor.
    let log =
        write(scratch.path(), "kgf.csv", &scaled(&text, "time_s,angle_rad,torque [kgf m]", 1.0 / 9.806_65));
    let out = scratch.path().join("answer-kgf");
    let found = answer(&["diagnose", &log, "--nominal", &nominal, "--json", "--out", out.to_str().unwrap()]);
    let said = found["verdict"]["summary"].as_str().unwrap();
    assert!(!said.contains("times smaller"), "{said}");
    assert_eq!(found["verdict"]["status"], "none", "{said}");
}

/// The period of a free swing gives the square root of the factor.
#[test]
fn a_period_tells_the_factor_that_its_stiffness_is_off_by() {
    let scratch = tempfile::tempdir().unwrap();
    let (_, text, _, _) = crate::reading::files().swap_remove(0);
    let log = write(scratch.path(), "log.csv", &text);
    for (factor, words) in [
        (9.806_65, "Its square is near 9.81: is the inertia or the stiffness stated with kgf in place of N?"),
        (180.0 / std::f64::consts::PI, "Its square is near 57.3: is the stiffness stated per degree"),
        (1e3, "Its square is near 1000: is the inertia or the stiffness stated with g, mm or mN"),
        (std::f64::consts::TAU.powi(2), "The factor is near 2 pi: is a frequency stated in Hz"),
    ] {
        let stiffness = 484.0 / factor;
        let text = format!("inertia = 1.0\ndamping = 0.3\nstiffness = {stiffness}\nrest_angle = 0.0\n");
        let nominal = write(scratch.path(), "nominal.toml", &text);
        let output = trainer(&["diagnose", &log, "--nominal", &nominal]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(words), "{factor}: {message}");
    }
}

/// Tests a gyroscope with a bias and an accelerometer that measures gravity. The rate of a swing has no mean;
/// a mean once led to a reported effect.
#[test]
fn a_mean_that_no_swing_has_is_told_and_taken_away_as_printed() {
    let scratch = tempfile::tempdir().unwrap();
    let log = (0..4000).fold("time_s,gyro [deg/s]\n".to_owned(), |text, index| {
        let time = f64::from(index) / 200.0;
        let noise = (f64::from(index) * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0) - 0.5;
        let rate = 275.0 * (-0.13 * time).exp() * (8.0 * time).sin() + noise;
        text + &format!("{time:.3},{:.4}\n", rate + 3.0)
    });
    write(scratch.path(), "gyro.csv", &log);
    let run = |arguments: &[&str]| {
        let program = std::process::Command::new(env!("CARGO_BIN_EXE_trainer"))
            .args(arguments)
            .current_dir(scratch.path())
            .output()
            .unwrap();
        (String::from_utf8(program.stdout).unwrap(), String::from_utf8(program.stderr).unwrap())
    };
    let (shown, _) = run(&["init", "gyro.csv"]);
    assert!(shown.contains("but the velocity of what swings averages about zero"), "{shown}");
    assert!(shown.contains("--nominal gyro/nominal.toml --remove-mean"), "{shown}");
    let nominal = ["--nominal", "gyro/nominal.toml", "--json", "--out"];
    let call = |more: &[&str], out: &str| -> Value {
        let start = ["diagnose", "gyro.csv"].iter().chain(more).chain(&nominal);
        let (found, message) = run(&start.copied().chain([out]).collect::<Vec<_>>());
        serde_json::from_str(&found).unwrap_or_else(|error| panic!("{error}: {message}"))
    };
    let (with, without) = (call(&[], "with"), call(&["--remove-mean"], "without"));
    let findings = |found: &Value| found["records"][0]["findings"].to_string();
    assert!(findings(&with).contains("subtract it with --remove-mean"), "{}", findings(&with));
    assert!(!findings(&without).contains("--remove-mean"), "{}", findings(&without));
    assert_eq!(without["verdict"]["effects"], serde_json::json!([]), "{}", without["verdict"]);
    assert!(number(&without, "/gap/ratio_to_floor") < 1.1, "{}", without["gap"]);
}
