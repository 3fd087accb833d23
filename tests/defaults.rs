//! Tests of the default settings on records with known truth, and of the answers to a new user's first
//! commands.

use crate::support::{number, result, root, trainer};
use seed::Seed;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::Command;

/// Free decay of a linear oscillator: damping ratio, undamped frequency in rad/s, samples per second,
/// seconds, noise and step of the sensor in initial amplitudes.
struct Decay(f64, f64, f64, f64, f64, f64);

const DECAYS: [Decay; 20] = [
    Decay(0.002, 21.75, 260.0, 60.0, 0.002, 0.0),
    Decay(0.002, 90.0, 1000.0, 20.0, 0.001, 0.0),
    Decay(0.003, 6.0, 50.0, 120.0, 0.005, 0.002),
    Decay(0.004, 45.0, 400.0, 15.0, 0.01, 0.0),
    Decay(0.005, 12.0, 60.0, 60.0, 0.0005, 0.0),
    Decay(0.006, 3.0, 25.0, 150.0, 0.003, 0.01),
    Decay(0.008, 21.75, 260.0, 20.0, 0.001, 0.0025),
    Decay(0.01, 150.0, 2000.0, 3.0, 0.002, 0.0),
    Decay(0.012, 8.0, 100.0, 40.0, 0.01, 0.0),
    Decay(0.015, 30.0, 120.0, 8.0, 0.004, 0.0),
    Decay(0.02, 60.0, 500.0, 4.0, 0.001, 0.001),
    Decay(0.025, 5.0, 40.0, 30.0, 0.002, 0.0),
    Decay(0.033_33, 21.0, 300.0, 6.0, 0.001, 0.0),
    Decay(0.04, 10.0, 100.0, 10.0, 0.005, 0.0),
    Decay(0.05, 25.0, 200.0, 4.0, 0.002, 0.005),
    Decay(0.06, 100.0, 3000.0, 0.8, 0.001, 0.0),
    Decay(0.07, 4.0, 50.0, 15.0, 0.003, 0.0),
    Decay(0.08, 15.0, 150.0, 4.0, 0.001, 0.0),
    Decay(0.09, 40.0, 800.0, 1.2, 0.002, 0.0),
    Decay(0.1, 6.0, 100.0, 8.0, 0.001, 0.0),
];

/// Returns the record as the text of a CSV file.
fn record(number: usize, &Decay(zeta, omega, rate, seconds, noise, step): &Decay) -> String {
    use rand::RngExt;
    let mut generator = Seed::new(7).child(&format!("decay {number}")).generator();
    let mut text = "time_s,angle_rad\n".to_owned();
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    for index in 0..(rate * seconds) as usize {
        let time = index as f64 / rate;
        let (one, other): (f64, f64) = (generator.random(), generator.random());
        let normal = (-2.0 * (1.0 - one).ln()).sqrt() * (TAU * other).cos();
        let seen = 0.2 + (-zeta * omega * time).exp() * (damped * time + 0.3).cos() + noise * normal;
        let seen = if step > 0.0 { (seen / step).round() * step } else { seen };
        text += &format!("{time:.6},{seen:.7}\n");
    }
    text
}

#[test]
fn twenty_exponentials_have_their_true_damping_ratio_within_two_standard_errors() {
    let folder = tempfile::tempdir().unwrap();
    let mut off = Vec::new();
    for (index, decay) in DECAYS.iter().enumerate() {
        let file = folder.path().join(format!("{index}.csv"));
        std::fs::write(&file, record(index, decay)).unwrap();
        let path = format!("data.path={}", file.display());
        let (_, result, _) = result(&["configs/ols.toml", &path]);
        off.push((number(&result, "/estimate/zeta") - decay.0) / number(&result, "/estimate/zeta_std_error"));
    }
    let held = off.iter().filter(|off| off.abs() <= 2.0).count();
    assert!(held >= 18, "{held} of 20: {off:.1?}");
}

#[test]
fn the_shipped_record_gives_its_true_frequency_and_damping_beside_the_answer() {
    let (code, result, _) = result(&["configs/pinn.toml"]);
    assert_eq!(code, 0);
    assert_eq!(result["envelope"]["pipeline"], "recommended");
    assert_eq!(result["data"]["clock"], "uniform-index");
    let omega = number(&result, "/envelope/omega_rad_s");
    let truth = (0.236_53_f64 / 5.0e-4).sqrt();
    assert!((omega / truth - 1.0).abs() < 0.003, "{omega}");
    assert!((number(&result, "/truth/omega_rad_s") / truth - 1.0).abs() < 1e-12);
    assert!(number(&result, "/truth/zeta_off_percent").abs() < 1.0, "{}", result["truth"]);
    assert!(number(&result, "/truth/zeta_off_std_errors").abs() < 2.0, "{}", result["truth"]);
    let said = result["disagreement"].as_str().unwrap();
    assert!(
        said.contains("the paper’s way on the times in the file gives ω = 20.94 rad/s")
            && said.contains("by the recommended way on evenly spaced times, has ω = 21.75 rad/s. Keep it"),
        "{said}"
    );
}

#[test]
fn a_truth_of_another_record_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.csv");
    std::fs::write(&file, record(12, &DECAYS[12])).unwrap();
    let beside = folder.path().join("a.truth.toml");
    std::fs::write(&beside, "record = \"sha256:0\"\ndamping_ratio = 0.03333\n").unwrap();
    let path = format!("data.path={}", file.display());
    let out = folder.path().join("out");
    let output = trainer(&["configs/ols.toml", &path, "--out", out.to_str().unwrap()]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("states the truth of a record sha256:0"), "{message}");
    let digest = runs::digest(&std::fs::read(&file).unwrap());
    std::fs::write(&beside, format!("record = \"{digest}\"\ndamping_ratio = 0.03333\n")).unwrap();
    let (_, result, _) = result(&["configs/ols.toml", &path]);
    assert!(number(&result, "/truth/zeta_off_std_errors").abs() < 3.0, "{}", result["truth"]);
}

/// Runs the program in another working directory.
fn elsewhere(folder: &Path, arguments: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_trainer")).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn a_configuration_runs_from_any_folder_and_its_copy_is_verified_there() {
    let folder = tempfile::tempdir().unwrap();
    let config = root().join("configs/ols.toml");
    let output = elsewhere(folder.path(), &[config.to_str().unwrap(), "--out", "run", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let verified = elsewhere(folder.path(), &["verify", "run"]);
    assert_eq!(String::from_utf8(verified.stdout).unwrap(), "run: identical\n");
    // On the command line a path starts from the working directory; in a file, including base files, from the
    // file's folder.
    std::fs::create_dir(folder.path().join("rig")).unwrap();
    std::fs::write(folder.path().join("rig/log.csv"), record(12, &DECAYS[12])).unwrap();
    std::fs::write(folder.path().join("rig/rig.toml"), "[data]\npath = \"log.csv\"\n").unwrap();
    std::fs::write(folder.path().join("mine.toml"), "base = \"rig/rig.toml\"\n[estimator]\nname = \"ols\"\n")
        .unwrap();
    for (number, arguments) in
        [&["mine.toml"][..], &[config.to_str().unwrap(), "data.path=rig/log.csv"]].into_iter().enumerate()
    {
        let out = format!("own-{number}");
        let output = elsewhere(folder.path(), &[arguments, &["--out", &out, "--json"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(result["data"]["path"], "rig/log.csv");
    }
}

#[test]
fn what_is_given_in_the_wrong_place_is_answered_with_the_right_call() {
    let (_, _, run) = result(&["configs/ols.toml"]);
    let run = run.path().to_str().unwrap();
    let nominal = "experiments/default-record/nominal.toml";
    let log = "experiments/default-record/record.csv";
    for (arguments, expected) in [
        (&[log][..], format!("is a record, not a configuration; look at it with `trainer init {log}`")),
        (&["diagose", log, "--nominal", nominal], "did you mean `trainer diagnose`?".to_owned()),
        (&["dianose"], "did you mean `trainer diagnose`?".to_owned()),
        (&[nominal], format!("`trainer diagnose RECORD --nominal {nominal}`")),
        (&["diagnose", nominal], format!("`trainer diagnose RECORD --nominal {nominal}`")),
        (&["diagnose", "configs/pinn.toml"], "`trainer configs/pinn.toml` runs it".to_owned()),
        (&[run], format!("`trainer report {run}`")),
    ] {
        let output = trainer(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(&expected) && message.trim_end().lines().count() == 1, "{message}");
    }
}

#[test]
fn an_absent_record_is_told_with_the_place_where_it_can_be_had() {
    let output = trainer(&["configs/paper.toml", "data.path=nowhere.txt"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains("Alqahtani921893/Damping-Parameter-Estimation, file 80P.txt"), "{message}");
}

#[test]
fn a_comparison_on_ones_own_log_has_no_inertia_and_rebukes_nobody() {
    let (_, own, _) = result(&["configs/compare.toml", "compare.methods=ols"]);
    assert_eq!(own["derived"]["per_unit_of_inertia"], true);
    assert!(own["cautions"].as_array().unwrap().is_empty());
    let (_, known, _) =
        result(&["configs/compare.toml", "compare.methods=ols", "compare.inertia_kg_m2=5e-4"]);
    let stiffness = |result: &serde_json::Value| number(result, "/derived/stiffness_n_m_per_rad");
    assert!((stiffness(&known) / stiffness(&own) / 5e-4 - 1.0).abs() < 1e-12);
}
